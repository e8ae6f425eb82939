"""Tool `cell`: run the whole cell in one process on simulated hardware and mill one door, or a shift of doors."""

from __future__ import annotations

import argparse
import itertools
import signal
import sys
from contextlib import nullcontext
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING

from doormill_ros.cell.errors import BadParameterError, RosArgumentsError
from doormill_ros.cell.graph.node_names import (
    CAMERA_SIMULATOR,
    CONTROLLER_SIMULATOR,
    OPERATOR_PAGE,
    PATH_GENERATOR,
)
from doormill_ros.cell.output.run_folder import point_latest
from doormill_ros.interrupts import die_of_interrupts, interrupt_once, interruptible
from doormill_ros.tools.cell_options import parse

if TYPE_CHECKING:
    from doormill_ros.cell.output.summary import RunSummary
    from doormill_ros.operator.access.token import Keys

OUT_OF_TOLERANCE_STATUS = 3
VERDICT_LIMIT = 3600.0  # s after the last door
ENDING = (signal.SIGINT, signal.SIGTERM)
LATEST = Path("out/latest")
#: Of nodes, by their names.
Parameters = dict[str, dict[str, object]]


@interruptible
def main(arguments: list[str] | None = None) -> int:
    """Run; 0 for a milled door, 3 for one out of tolerance, 1 for one refused or not measured, 2 for a bad option."""
    alone = arguments is None  # the process is this command
    if alone:
        die_of_interrupts()
    options = parse(arguments)
    # All that follows imports late, so that --help answers at once.
    parameters = _parameters(options)
    mill = _mill_door if options.doors is None else _mill_shift
    try:
        return mill(options, parameters, alone)
    except (BadParameterError, RosArgumentsError) as refused:  # such as of --out
        print(f"cell: {refused.message}", file=sys.stderr)
        return 2


def _parameters(options: argparse.Namespace) -> Parameters:
    """What the options say to the nodes of one door and of a shift alike."""
    from doormill_ros.units import deg_to_rad, mm_to_m

    camera: dict[str, object] = {"seed": options.seed, "pictures": not options.no_pictures}
    if options.offset is not None:
        y, z, rotation = options.offset
        camera |= {"offset_y": mm_to_m(y), "offset_z": mm_to_m(z), "offset_rotation": deg_to_rad(rotation)}
    parameters: Parameters = {CAMERA_SIMULATOR: camera}
    if options.robot_model:
        parameters[PATH_GENERATOR] = {"robot_model": Path(options.robot_model).resolve()}
    return parameters


def _mill_door(options: argparse.Namespace, parameters: Parameters, alone: bool) -> int:
    """Mill one door, write and tell of its report; the status of `main`."""
    from doormill_ros.cell.output.inspection import OUT_OF_TOLERANCE
    from doormill_ros.errors import DoormillError
    from doormill_ros.nodes.one_process.cell import CellOptions, run_once
    from doormill_ros.pages.charts import import_matplotlib
    from doormill_ros.pipeline.plan import load_setup
    from doormill_ros.recording.errors import BagError
    from doormill_ros.report.run_report import write_report
    from doormill_ros.simulation.robot_cell import load_effects

    folder = options.out or Path("out/runs") / datetime.now(UTC).strftime("%Y%m%dT%H%M%S%fZ")

    def progress(stage: str, share: float) -> None:
        # In one piece: other threads write there, too.
        sys.stderr.write(f"[{share:4.0%}] {stage}\n")

    def milled(summary: RunSummary) -> None:
        print(f"{summary.message}\nthe cell stays up for the operator's page; end it with Ctrl-C", flush=True)

    if options.effects:
        parameters[CONTROLLER_SIMULATOR] = {"effects": Path(options.effects).resolve()}
    if options.ui is not None:
        parameters[OPERATOR_PAGE] = _page(options, folder)
    cell = CellOptions(
        parameters,
        options.ui is not None,
        namespace=options.namespace,
        sensors=tuple(options.sensor),
        robots=options.robots,
    )
    try:  # what a node cannot use would be waited for until the run's limit, and the run before be gone
        if options.robot_model:
            load_setup(model=str(Path(options.robot_model).resolve()))
        if options.effects:
            load_effects(Path(options.effects))
        cell.check()
    except DoormillError as error:
        print(f"cell: {error.message}", file=sys.stderr)
        return 2
    if alone:
        import_matplotlib()
        interrupt_once(ENDING)
    cell = replace(cell, token=_keys(options))
    summary = run_once(options.door[0], folder, cell, progress, milled)
    unreported = ""
    try:
        write_report(Path(summary.bag), Path(summary.report))
    except BagError as lacking:  # such as of a goal that another cell's bridge answered
        unreported = f"none: {lacking.message}"
    if options.out is None:
        point_latest(folder, LATEST)
        folder = LATEST
    _tell(summary, folder)
    print(f"bag         {folder / 'bag'}")
    print(f"report      {unreported or folder / 'report.html'}")
    print(f"summary     {folder / 'summary.json'}")
    if summary.outcome == OUT_OF_TOLERANCE:
        return OUT_OF_TOLERANCE_STATUS
    return 0 if summary.success else 1


def _page(options: argparse.Namespace, folder: Path) -> dict[str, object]:
    """Parameters of the operator's page, which shows earlier runs where this one is kept beside them."""
    from doormill_ros.cell.output.run_folder import RunFolder

    page: dict[str, object] = {"port": options.ui}
    if options.out is None:
        runs = RunFolder(folder.parent.resolve())
        page |= {"history": runs.root, "audit": runs.audit}
    if options.ui_host:
        page["host"] = options.ui_host
    return page


def _keys(options: argparse.Namespace) -> Keys:
    """New tokens for those who were asked for, printed."""
    from doormill_ros.operator.access.token import Keys, new_token

    operate = new_token() if options.control else None
    engineer = new_token() if options.engineer else None
    for who, token in (("operator", operate), ("engineer", engineer)):
        if token is not None:
            print(f"{who}'s token  {token}", flush=True)
    return Keys(operate, engineer)


def _tell(summary: RunSummary, folder: Path) -> None:
    """Print how the door came out, and which files the robot got."""
    from doormill_ros.units import m_to_mm, rad_to_deg

    print(summary.message)
    if not summary.measured:
        return
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


def _mill_shift(options: argparse.Namespace, parameters: Parameters, alone: bool) -> int:
    """Mill doors one after the other; 0 when nothing is wrong with any, 1 otherwise, 2 when a file cannot be used."""
    from doormill_ros.cell.output.run_folder import ShiftFolder
    from doormill_ros.errors import DoormillError
    from doormill_ros.nodes.one_process.cell import CellOptions
    from doormill_ros.nodes.one_process.monitor_beside import ModelMonitorBeside
    from doormill_ros.nodes.one_process.shift import run_shift
    from doormill_ros.pages.charts import import_matplotlib
    from doormill_ros.pipeline.plan import load_setup
    from doormill_ros.report.run_report import write_report
    from doormill_ros.simulation.robot_cell import load_effects
    from doormill_ros.simulation.world.world_file import load_world

    doors = list(itertools.islice(itertools.cycle(options.door), options.doors))
    folder = options.out or Path("out/shifts") / datetime.now(UTC).strftime("%Y%m%dT%H%M%S%fZ")

    def milled(number: int, summary: RunSummary) -> None:
        write_report(Path(summary.bag), Path(summary.report))
        print(f"[{number + 1}/{len(doors)}] {summary.message}", file=sys.stderr, flush=True)

    if options.monitor:
        parameters[CONTROLLER_SIMULATOR] = {"gauged": True}
    cell = CellOptions(parameters, namespace=options.namespace, sensors=tuple(options.sensor))
    try:
        if options.robot_model:
            load_setup(model=str(Path(options.robot_model).resolve()))
        if options.world:
            world = load_world(options.world)
            for number in range(len(doors)):
                world.door(number)
        effects = load_effects(Path(options.effects)) if options.effects else ()
        cell.check()
    except DoormillError as error:
        print(f"cell: {error.message}", file=sys.stderr)
        return 2
    if alone:
        import_matplotlib()
        interrupt_once(ENDING)
    ShiftFolder(folder.resolve()).prepare(len(doors))
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
