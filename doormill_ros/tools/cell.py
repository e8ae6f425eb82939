"""Tool `cell`: run the whole cell in one process on simulated hardware and mill one door, or a shift of doors."""

from __future__ import annotations

import argparse
import itertools
import re
import signal
import sys
from contextlib import nullcontext
from datetime import UTC, datetime
from pathlib import Path

from doormill_ros.cell.run_folder import point_latest
from doormill_ros.interrupts import die_of_interrupts, interrupt_once

OUT_OF_TOLERANCE_STATUS = 3
VERDICT_LIMIT = 3600.0  # s after the last door
ENDING = (signal.SIGINT, signal.SIGTERM)
NAMESPACE = re.compile(r"(/[A-Za-z_][A-Za-z0-9_]*)+")


def parse(arguments: list[str] | None) -> argparse.Namespace:
    """Read the command line."""
    parser = argparse.ArgumentParser(prog="cell", description=__doc__)
    parser.add_argument(
        "--door",
        required=True,
        action="append",
        metavar="ID",
        help="door to mill, for example standard_door; for a shift again and again, taken in turn",
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
        "--namespace", default="", metavar="NS", help="ROS namespace, for example /cell1, beside another cell"
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
        help="what finds the door instead of what config/cell.yaml names: camera, axis_vision, photoelectric or "
        "touch_probe; several are held against each other, milled is from the first one",
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
    options = parser.parse_args(arguments)
    if options.ui is None and (options.control or options.engineer or options.ui_host):
        parser.error("--control, --engineer and --ui-host belong to the operator's page: add --ui")
    if options.doors is None and (options.world or len(options.door) > 1):
        options.doors = len(options.door)
    if options.monitor and options.doors is None:
        parser.error("--monitor belongs to a shift: add --doors (the page of --ui has a monitor without it)")
    if options.doors is not None:
        if options.doors < 1:
            parser.error(f"--doors is {options.doors}, allowed is a positive whole number")
        if options.ui is not None:
            parser.error("--ui shows one door: leave it out, or --doors and --world")
        if options.world and options.effects:
            parser.error("--effects and --world both say what the robot hides: leave one out")
    if options.sensor:
        from doormill_ros.cell.layout import CAMERA
        from doormill_ros.simulation.sensors.registry import SIMULATED

        allowed = (CAMERA, *SIMULATED)
        if any(name not in allowed for name in options.sensor) or len(set(options.sensor)) < len(
            options.sensor
        ):
            parser.error(
                f"--sensor is {' '.join(options.sensor)}, allowed are {', '.join(allowed)}, each once"
            )
    if options.robots > 1 and options.doors is not None:
        parser.error("--robots 2 mills one door: leave out --doors, --world and --monitor")
    if options.namespace and not NAMESPACE.fullmatch(options.namespace):
        parser.error(
            f"--namespace is {options.namespace!r}, allowed are slashes with names of letters, digits and _: /cell1"
        )
    return options


def main(arguments: list[str] | None = None) -> int:
    """Run; 0 for a milled door, 3 for one out of tolerance, 1 for one refused or not measured, 2 for a bad option."""
    alone = arguments is None  # the process is this command
    if alone:
        die_of_interrupts()
    options = parse(arguments)
    # Late, so that --help answers at once.
    from doormill_ros.cell.errors import BadParameterError
    from doormill_ros.cell.inspection import OUT_OF_TOLERANCE
    from doormill_ros.cell.run_folder import RunFolder
    from doormill_ros.cell.summary import RunSummary
    from doormill_ros.nodes.cell import CellOptions, run_once
    from doormill_ros.operator.token import Keys, new_token
    from doormill_ros.pages.charts import import_matplotlib
    from doormill_ros.recording.errors import BagError
    from doormill_ros.report.run_report import write_report
    from doormill_ros.units import deg_to_rad, m_to_mm, mm_to_m, rad_to_deg

    camera: dict[str, object] = {"seed": options.seed, "pictures": not options.no_pictures}
    if options.offset is not None:
        y, z, rotation = options.offset
        camera |= {"offset_y": mm_to_m(y), "offset_z": mm_to_m(z), "offset_rotation": deg_to_rad(rotation)}
    parameters: dict[str, dict[str, object]] = {"camera_simulator": camera}
    if options.robot_model:
        parameters["path_generator"] = {"robot_model": Path(options.robot_model).resolve()}
    if options.effects and options.doors is None:
        parameters["controller_simulator"] = {"effects": Path(options.effects).resolve()}
    if options.doors is not None:
        return _mill_shift(options, parameters, alone)
    latest = Path("out/latest")
    folder = options.out or Path("out/runs") / datetime.now(UTC).strftime("%Y%m%dT%H%M%S%fZ")

    def progress(stage: str, share: float) -> None:
        # In one piece: other threads write there, too.
        sys.stderr.write(f"[{share:4.0%}] {stage}\n")

    operate = engineer = None
    if options.ui is not None:
        page: dict[str, object] = {"port": options.ui}
        if options.out is None:
            runs = RunFolder(folder.parent.resolve())
            page |= {"history": runs.root, "audit": runs.audit}
        if options.ui_host:
            page["host"] = options.ui_host
        parameters["operator_page"] = page
        if options.control:
            operate = new_token()
            print(f"operator's token  {operate}", flush=True)
        if options.engineer:
            engineer = new_token()
            print(f"engineer's token  {engineer}", flush=True)

    def milled(summary: RunSummary) -> None:
        print(f"{summary.message}\nthe cell stays up for the operator's page; end it with Ctrl-C", flush=True)

    cell = CellOptions(
        parameters,
        options.ui is not None,
        Keys(operate, engineer),
        options.namespace,
        sensors=tuple(options.sensor),
        robots=options.robots,
    )
    if alone:
        import_matplotlib()
        interrupt_once(ENDING)
    try:
        summary = run_once(options.door[0], folder, cell, progress, milled)
    except BadParameterError as refused:  # such as of --offset
        print(f"cell: {refused.message}", file=sys.stderr)
        return 2
    unreported = ""
    try:
        write_report(Path(summary.bag), Path(summary.report))
    except BagError as lacking:  # such as of a goal that another cell's bridge answered
        unreported = f"none: {lacking.message}"
    if options.out is None:
        point_latest(folder, latest)
        folder = latest
    print(summary.message)
    if summary.measured:
        error, feature = summary.localization_error, summary.feature_error
        print(
            f"localization error {m_to_mm(error.y):+.4f} mm, {m_to_mm(error.z):+.4f} mm, "
            f"{rad_to_deg(error.rotation):+.4f} degrees; feature error {m_to_mm(feature.corrected_max):.3f} mm at "
            f"{feature.feature} "
            f"(uncorrected {m_to_mm(feature.uncorrected_max):.3f}, tolerance {m_to_mm(feature.tolerance):.1f})"
        )
        print(summary.touched.message)
        for file in sorted((folder / "targets").rglob(Path(summary.target_file).name)):
            print(f"RAPID file  {file}")
    print(f"bag         {folder / 'bag'}")
    print(f"report      {unreported or folder / 'report.html'}")
    print(f"summary     {folder / 'summary.json'}")
    if summary.outcome == OUT_OF_TOLERANCE:
        return OUT_OF_TOLERANCE_STATUS
    return 0 if summary.success else 1


def _mill_shift(options: argparse.Namespace, parameters: dict[str, dict[str, object]], alone: bool) -> int:
    """Mill doors one after the other; 0 when nothing is wrong with any, 1 otherwise, 2 when a file cannot be used."""
    from doormill_ros.cell.run_folder import ShiftFolder
    from doormill_ros.cell.summary import RunSummary
    from doormill_ros.errors import DoormillError
    from doormill_ros.nodes.cell import CellOptions
    from doormill_ros.nodes.monitor_beside import ModelMonitorBeside
    from doormill_ros.nodes.shift import run_shift
    from doormill_ros.pages.charts import import_matplotlib
    from doormill_ros.report.run_report import write_report
    from doormill_ros.simulation.robot_cell import load_effects
    from doormill_ros.simulation.world.world_file import load_world

    doors = list(itertools.islice(itertools.cycle(options.door), options.doors))
    folder = options.out or Path("out/shifts") / datetime.now(UTC).strftime("%Y%m%dT%H%M%S%fZ")

    def milled(number: int, summary: RunSummary) -> None:
        write_report(Path(summary.bag), Path(summary.report))
        print(f"[{number + 1}/{len(doors)}] {summary.message}", file=sys.stderr, flush=True)

    try:
        if options.world:
            world = load_world(options.world)
            for number in range(len(doors)):
                world.door(number)
        effects = load_effects(Path(options.effects)) if options.effects else ()
    except DoormillError as error:
        print(f"cell: {error.message}", file=sys.stderr)
        return 2
    if options.monitor:
        parameters["controller_simulator"] = {"gauged": True}
    cell = CellOptions(parameters, namespace=options.namespace, sensors=tuple(options.sensor))
    if alone:
        import_matplotlib()
        interrupt_once(ENDING)
    with ModelMonitorBeside(folder, cell) if options.monitor else nullcontext() as beside:
        shift = run_shift(doors, folder, cell, options.world, effects, milled)
        state, runs = (
            (None, None)
            if beside is None
            else (beside.verdict(VERDICT_LIMIT), beside.runs_verdict(VERDICT_LIMIT))
        )
    print(shift.table())
    if state is not None and runs is not None:
        print(
            f"verdict     {state.finding.sentence if state.finding else state.message or 'no door was inspected'}"
        )
        print(f"next        {state.finding.next_measurement if state.finding else 'inspect a door'}")
        print(f"bags        {runs.finding.sentence if runs.finding else runs.message or 'were not asked'}")
        print(
            f"models      version {state.version} in use, {state.proposed or 'none'} proposed, in {folder / 'models'}"
        )
    print(f"summary     {ShiftFolder(folder).summary}")
    print(f"diagnosis   diagnose --inspections {folder} --out {folder / 'diagnosis'}")
    return 0 if shift.success else 1


if __name__ == "__main__":
    sys.exit(main())
