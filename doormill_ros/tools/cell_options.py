"""The options of the tool `cell`, and which of them exclude each other."""

from __future__ import annotations

import argparse
from pathlib import Path

from doormill_ros.enumeration import enumerated
from doormill_ros.simulation.sensors.registry import SIMULATED_SENSORS
from doormill_ros.tools.one_line_parser import OneLineParser, namespace

DESCRIPTION = (
    "Run the whole cell in one process on simulated hardware and mill one door, or a shift of doors."
)


def parse(arguments: list[str] | None) -> argparse.Namespace:
    """Read the command line; a wrong one ends the process with status 2."""
    parser = _parser()
    options = parser.parse_args(arguments)
    if not options.door:
        if options.doors is None:
            parser.error(
                "the following arguments are required: --door (with --doors N: the shipped recipes in turn)"
            )
        options.door = _shipped()
    if options.doors is None and (options.world or len(options.door) > 1):
        options.doors = len(options.door)
    _check(parser, options)
    return options


def _parser() -> argparse.ArgumentParser:
    parser = OneLineParser(prog="cell", description=DESCRIPTION)
    parser.add_argument(
        "--door",
        action="append",
        default=[],
        metavar="ID",
        help="door to mill, for example standard_door; for a shift again and again, taken in turn; with --doors it may "
        "be left out for the shipped recipes in turn",
    )
    parser.add_argument(
        "--doors", type=int, metavar="N", help="mill a shift of N doors, each with bag and inspection"
    )
    parser.add_argument(
        "--world", type=Path, metavar="FILE", help="how the simulated cell really is, see docs/world.md"
    )
    parser.add_argument(
        "--monitor",
        action="store_true",
        help="run /model_monitor beside a shift: it questions doors, proposes models, stops milling at its limit",
    )
    parser.add_argument(
        "--out", type=Path, metavar="DIR", help="where the run's files go; default: out/latest"
    )
    parser.add_argument("--seed", type=int, default=0, help="of the door's placement and the picture's noise")
    parser.add_argument(
        "--offset",
        nargs=3,
        type=float,
        metavar=("Y", "Z", "DEG"),
        help="place the door this far off: mm, mm, degrees",
    )
    parser.add_argument(
        "--robots",
        type=int,
        choices=(1, 2),
        default=1,
        help="2: one on either side of the door, each mills its share, see docs/two-robots.md",
    )
    parser.add_argument(
        "--namespace",
        type=namespace,
        default="",
        metavar="NS",
        help="ROS namespace, for example /cell1, beside another cell",
    )
    parser.add_argument("--robot-model", metavar="YAML", help="model.yaml of a diagnosis for the correction")
    parser.add_argument(
        "--effects", metavar="YAML", help="what the simulated robot hides, see docs/diagnosis.md"
    )
    parser.add_argument(
        "--sensor",
        action="append",
        default=[],
        metavar="NAME",
        help="what finds the door instead of what config/cell.yaml names: camera, "
        f"{enumerated(SIMULATED_SENSORS, 'or')}; several are held against each other, "
        "the first one's pose is used for milling",
    )
    parser.add_argument("--no-pictures", action="store_true", help="simulate a broken camera")
    parser.add_argument(
        "--ui",
        nargs="?",
        type=int,
        const=8080,
        metavar="PORT",
        help="serve the operator's page and keep the cell up after the door; default port: 8080, 0: any",
    )
    parser.add_argument("--ui-host", metavar="HOST", help="address of that page; default: 127.0.0.1")
    parser.add_argument(
        "--control", action="store_true", help="print a token with which that page starts and cancels runs"
    )
    parser.add_argument(
        "--engineer",
        action="store_true",
        help="print a second token, with which models are put in use and the audit log is read as well",
    )
    return parser


def _shipped() -> list[str]:
    """Doors whose recipes ship, in the order of their ids."""
    from doormill_ros.recipes.documents import shipped_recipes

    return sorted(shipped_recipes())


def _check(parser: argparse.ArgumentParser, options: argparse.Namespace) -> None:
    if options.ui is None and (options.control or options.engineer or options.ui_host):
        parser.error("--control, --engineer and --ui-host belong to the operator's page: add --ui")
    if options.monitor and options.doors is None:
        parser.error("--monitor belongs to a shift: add --doors (the page of --ui has a monitor without it)")
    if options.doors is not None:
        if options.doors < 1:
            parser.error(f"--doors is {options.doors}, allowed is a positive whole number")
        if options.ui is not None:
            parser.error("--ui shows one door: leave it out, or --doors and --world")
        if options.world and options.effects:
            parser.error("--effects and --world both say what the robot hides: leave one out")
    _check_sensors(parser, options.sensor)
    if options.robots > 1 and options.doors is not None:
        parser.error("--robots 2 mills one door: leave out --doors, --world and --monitor")


def _check_sensors(parser: argparse.ArgumentParser, sensors: list[str]) -> None:
    if not sensors:
        return
    from doormill_ros.cell.places.layout import CAMERA

    allowed = (CAMERA, *SIMULATED_SENSORS)
    if any(name not in allowed for name in sensors) or len(set(sensors)) < len(sensors):
        parser.error(f"--sensor is {' '.join(sensors)}, allowed are {', '.join(allowed)}, each once")
