"""Maps over joints 2 and 3 and the region of operation, as pictures and numbers."""

from __future__ import annotations

import argparse
import json
import sys
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console
from rich.progress import Progress

from doormill_ros.cell.places.layout import CellLayout, load_layout
from doormill_ros.errors import DoormillError
from doormill_ros.files import write_atomically
from doormill_ros.interrupts import interruptible
from doormill_ros.recipes.documents import load_recipe
from doormill_ros.robot.description import Robot, load_robot
from doormill_ros.toolpath.settings import load_settings
from doormill_ros.tools.one_line_parser import OneLineParser
from doormill_ros.units import MM, deg_to_rad, m_to_mm, n_per_m_to_n_per_um, rad_to_deg
from doormill_ros.workspace.advice import (
    PlannedDoors,
    best_place,
    layout_at,
    plan_doors,
    plan_shares,
    sample_doors,
    second_at,
)
from doormill_ros.workspace.doors import LARGEST, DoorRange, thesis_box
from doormill_ros.workspace.grid import THESIS_STEP, thesis_grid
from doormill_ros.workspace.maps import WRENCH_SCRIPT, WRENCH_TEXT, Maps, compute_maps, save_arrays, save_maps
from doormill_ros.workspace.pictures import draw_conditioning, draw_influence, draw_region, draw_stiffness
from doormill_ros.workspace.posture import POSTURES
from doormill_ros.workspace.region import ELBOW, BoxPlacement, RegionRules, RegionSearch, assess, survey

SCHEMA = "doormill/workspace/1"
TEMPLATE = "standard_door"  #: whose features the planned doors have
CANDIDATES = 3  #: places whose programs are looked at
THESIS_ROBOT = "irb6600_175_255"
# Table 4.6 of the thesis, degrees: where its region of operation lies on the maps.
TABLE_4_6 = (
    (-13.58, 69.54, 34.97, -14.01, -104.10, -93.48),
    (13.58, 69.54, 34.97, 14.01, -104.10, -86.52),
    (-13.58, 6.89, -44.31, 21.68, 39.46, -107.06),
    (13.58, 6.89, -44.31, -21.68, 39.46, -72.94),
)


@interruptible
def main(argv: list[str] | None = None) -> int:
    """Run the tool; 0 when everything was written, 2 for bad input."""
    arguments = _parser().parse_args(argv)
    try:
        robot = load_robot(arguments.robot)
        doors = DoorRange(
            thickness=tuple(value * MM for value in arguments.thickness),
            width=tuple(value * MM for value in arguments.width),
            height=arguments.height * MM,
            hinge_end=arguments.hinge_end * MM,
        )
        if not abs(arguments.clamp_height * MM) <= LARGEST:
            raise ValueError(
                f"--clamp-height is {arguments.clamp_height:g} mm, allowed are {-LARGEST / MM:g} to {LARGEST / MM:g}"
            )
        grids = [thesis_grid(robot, arguments.step, along) for along in (False, True)]
        arguments.out.mkdir(parents=True, exist_ok=True)
    except (DoormillError, ValueError, OSError) as error:
        print(_refusal(error, arguments.out), file=sys.stderr)
        return 2
    with Progress(console=Console(stderr=True), transient=False) as progress:
        try:
            document = _maps(robot, grids, arguments.out, progress)
            document |= _region(robot, doors, arguments, progress)
            write_atomically(
                arguments.out / "workspace.json",
                json.dumps({"schema": SCHEMA, "robot": robot.name, **document}, indent=2) + "\n",
            )
        except (DoormillError, ValueError, OSError) as error:
            print(_refusal(error, arguments.out), file=sys.stderr)
            return 2
    _report(robot, document, arguments.clamp_height * MM + doors.hinge_end)
    print(arguments.out)
    return 0


def _refusal(error: Exception, out: Path) -> str:
    """What is said of bad input, or of a folder that cannot be written to."""
    if not isinstance(error, OSError):
        return f"workspace: {error}"
    reason = "a file is in the way" if isinstance(error, FileExistsError) else error.strerror or error
    return f"workspace: {error.filename or out} cannot be used, {reason}; name another --out"


def _parser() -> argparse.ArgumentParser:
    parser = OneLineParser(prog="workspace", description=__doc__)
    parser.add_argument("--out", type=Path, default=Path("out/workspace"), help="folder to write to")
    parser.add_argument(
        "--robot", default=THESIS_ROBOT, help="name in config/robots, or a folder of one's own"
    )
    parser.add_argument(
        "--step", type=float, default=THESIS_STEP, metavar="RAD", help="grid step of joints 2 and 3"
    )
    parser.add_argument(
        "--thickness", type=float, nargs=2, default=(0, 100), metavar=("MIN", "MAX"), help="mm"
    )
    parser.add_argument(
        "--width", type=float, nargs=2, default=(190, 1350), metavar=("MIN", "MAX"), help="mm"
    )
    parser.add_argument("--height", type=float, default=3000, metavar="MAX", help="mm")
    parser.add_argument(
        "--hinge-end", type=float, default=150, metavar="MM", help="lowest hinge above the bottom"
    )
    parser.add_argument(
        "--clamp-height", type=float, default=0, metavar="MM", help="door's bottom edge above the floor"
    )
    return parser


def _maps(robot: Robot, grids: list[Any], out: Path, progress: Progress) -> dict[str, Any]:
    """Compute, draw and save the maps; numbers for the summary."""
    marks = deg_to_rad(np.array(TABLE_4_6)) if robot.name == THESIS_ROBOT else None
    runs = [
        ("maps", grids[0], WRENCH_TEXT, "joints 4, 5, 6 at 45 deg"),
        ("maps_script_wrench", grids[0], WRENCH_SCRIPT, "joints 4, 5, 6 at 45 deg"),
        ("maps_tool_along_x", grids[1], WRENCH_TEXT, "tool along base x"),
    ]
    summary: dict[str, Any] = {}
    for name, grid, wrench, posture in runs:
        task = progress.add_task(f"{name}", total=1.0)
        maps = compute_maps(robot, grid, wrench, progress=_bar(progress, task, 0.5))
        save_maps(maps, out / f"{name}.npz")
        heading = f"{robot.label}, {posture}"
        load = f"{wrench[2]:.0f} N, {wrench[3]:.0f} N m"
        draw_influence(maps, f"Influence of K_c: {heading}, {load}", out / f"{name}_influence.png", marks)
        if wrench is WRENCH_TEXT:
            draw_conditioning(maps, f"Conditioning: {heading}", out / f"{name}_conditioning.png", marks)
            draw_stiffness(maps, f"Stiffness: {heading}", out / f"{name}_stiffness.png", marks)
        progress.update(task, completed=1.0)
        summary[name] = _numbers(maps)
    return {"maps": summary}


def _numbers(maps: Maps) -> dict[str, Any]:
    row, column = np.unravel_index(int(np.nanargmax(maps.conditioning)), maps.conditioning.shape)
    return {
        "configurations": int(maps.conditioning.size),
        "wrench": maps.wrench.tolist(),
        "characteristic_length": maps.length,
        "nu_p_max": float(np.nanmax(maps.position_influence)),
        "nu_r_max_deg": float(rad_to_deg(np.nanmax(maps.rotation_influence))),
        "inverse_condition_number_max": float(np.nanmax(maps.conditioning)),
        "inverse_condition_number_max_at_deg": [
            float(rad_to_deg(maps.grid.q2[column])),
            float(rad_to_deg(maps.grid.q3[row])),
        ],
        "stiffness_median": {name: float(np.nanmedian(values)) for name, values in maps.stiffness.items()},
    }


def _region(
    robot: Robot, doors: DoorRange, arguments: argparse.Namespace, progress: Progress
) -> dict[str, Any]:
    lowest = arguments.clamp_height * MM + doors.hinge_end
    reference = assess(robot, thesis_box())
    region: dict[str, Any] = {
        "travel": doors.travel().tolist(),
        "thesis": _placement(reference, lowest),
    }
    task = progress.add_task("region of operation", total=1.0)
    everywhere = survey(robot, doors, RegionRules(clearance=ELBOW), progress=_bar(progress, task, 0.5))
    layout, settings = load_layout(), load_settings()
    hinged = sample_doors(load_recipe(TEMPLATE), doors, everything=False)
    alone = sample_doors(load_recipe(TEMPLATE), doors, everything=True)
    thick = [door for door in alone if door.thickness == doors.thickness[1]]  # both reach deepest into these

    def judged(place: CellLayout, hinges: PlannedDoors | None = None) -> dict[str, Any]:
        hinges = hinges or plan_doors(hinged, place, robot, settings)
        two = plan_shares(thick, place, robot, second_at(settings, layout, place))
        return {
            "hinges": asdict(hinges),
            "one_robot": asdict(plan_doors(alone, place, robot, settings)),
            "two_robots": asdict(two),
        }

    region["cell"] = {"programs": judged(layout)}
    region["thesis"]["programs"] = judged(layout_at(layout, reference.corner, doors))
    for done, objective in enumerate(("conditioning", "stiffness")):
        found = everywhere.best(objective)
        choice = everywhere.candidates(objective, CANDIDATES)
        best = best_place([place.corner for place in choice], hinged, doors, layout, robot, settings)
        region[f"best_{objective}"] = None
        if best is not None:
            number, hinges = best
            found = replace(found, best=choice[number])
            place = layout_at(layout, choice[number].corner, doors)
            region[f"best_{objective}"] = _placement(choice[number], lowest) | {
                "programs": judged(place, hinges)
            }
        draw_region(robot, found, reference, arguments.out / f"region_{objective}.png")
        _save_search(found, arguments.out / f"region_{objective}.npz")
        progress.update(task, completed=0.7 + 0.3 * done)
    return {"region": region}


def _placement(placement: BoxPlacement, lowest_hinge: float) -> dict[str, Any]:
    return {
        "flange_min": placement.corner.tolist(),
        "flange_max": (placement.corner + placement.size).tolist(),
        "sideways": placement.sideways,
        "base_above_lowest_hinge": float(-placement.corner[2]),
        "pedestal_height": placement.pedestal_height(lowest_hinge),
        "posture": POSTURES[placement.posture],
        "inverse_condition_number": placement.conditioning,
        "stiffness": placement.stiffness,
        "joint_margin_deg": rad_to_deg(placement.margin),
        "axis_5_from_straight_deg": rad_to_deg(placement.wrist),
        "elbow_behind_flange": placement.clearance,
        "refusal": placement.refusal,
    }


def _save_search(found: RegionSearch, path: Path) -> None:
    x, y, z = found.corners
    save_arrays(path, corner_x_m=x, corner_y_m=y, corner_z_m=z, allowed=found.allowed, **found.worst)


def _bar(progress: Progress, task: Any, share: float) -> Any:
    return lambda done: progress.update(task, completed=done * share)


def _report(robot: Robot, document: dict[str, Any], lowest_hinge: float) -> None:
    print(robot.label)
    for name, numbers in document["maps"].items():
        q2, q3 = numbers["inverse_condition_number_max_at_deg"]
        print(
            f"  {name}: nu_p <= {numbers['nu_p_max']:.2e}, nu_r <= {numbers['nu_r_max_deg']:.2e} deg, "
            f"best conditioning {numbers['inverse_condition_number_max']:.4f} at joint 2 {q2:.1f}, joint 3 {q3:.1f} deg"
        )
    print(f"  lowest hinge {lowest_hinge:.3f} m above the floor; worst values over the region of operation:")
    for name in ("thesis", "best_conditioning", "best_stiffness"):
        place = document["region"][name]
        if place is None:
            print(f"  {name}: no placement keeps to the rules")
            continue
        low, high = place["flange_min"], place["flange_max"]
        stiffness = n_per_m_to_n_per_um(place["stiffness"])
        print(
            f"  {name}: flange x {low[0]:.3f}..{high[0]:.3f}, y {low[1]:.3f}..{high[1]:.3f}, "
            f"z {low[2]:.3f}..{high[2]:.3f} m, pedestal {place['pedestal_height']:.3f} m; conditioning "
            f"{place['inverse_condition_number']:.4f}, stiffness {stiffness:.3f} N/um, joints "
            f"{place['joint_margin_deg']:.1f} deg from limits, axis 5 {place['axis_5_from_straight_deg']:.1f} deg "
            f"from straight, elbow {m_to_mm(place['elbow_behind_flange']):.0f} mm behind the flange"
        )
        if place["refusal"]:
            print(f"    {place['refusal']}")
        _report_programs(place["programs"])
    print("  the cell of config/cell.yaml:")
    _report_programs(document["region"]["cell"]["programs"])


def _report_programs(programs: dict[str, Any]) -> None:
    for key, what in (
        ("hinges", "hinges"),
        ("one_robot", "all features, one robot"),
        ("two_robots", "all features, two robots"),
    ):
        doors = programs[key]
        print(f"    {what}: {doors['refused']} of {doors['planned']} doors refused")
        if doors["reason"]:
            print(f"      {doors['reason']}")


if __name__ == "__main__":
    sys.exit(main())
