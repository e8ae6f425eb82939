"""A shift: doors one after the other with one controller, each run with nodes, bag and inspection of its own."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from doormill_ros.cell.graph.node_names import CAMERA_SIMULATOR, CONTROLLER_SIMULATOR, PATH_GENERATOR
from doormill_ros.cell.output.run_folder import ShiftFolder
from doormill_ros.cell.output.shift_summary import ShiftSummary
from doormill_ros.cell.output.summary import RunSummary
from doormill_ros.nodes.one_process.cell import CellOptions, run_in
from doormill_ros.nodes.simulated.controller_simulator import switch_on


def run_shift(
    doors: Sequence[str],
    folder: Path,
    options: CellOptions,
    world: Path | None = None,
    effects: Iterable[Mapping[str, Any]] = (),
    milled: Callable[[int, RunSummary], None] | None = None,
    model: Callable[[int], Path | None] | None = None,
) -> ShiftSummary:
    """Mill doors and write shift.json, anew after each of them; a refused door does not end the shift.

    The nodes of each door are new, so that nothing latched reaches the next bag; controller, camera and robot are those
    of the door before.

    Args:
        doors: Their ids, in order.
        folder: Of the shift; the caller has prepared it, see `ShiftFolder.prepare`.
        options: As for one door.
        world: How the cell really is; None as the project assumes.
        effects: What the robot hides where no world is given.
        milled: Called with each door's number and summary.
        model: Asked before each door, by its number, for the robot model that its path is to be corrected with; None
            for the one in the options.

    Raises:
        WorldFileError: The world file cannot be used.
    """
    paths = ShiftFolder(folder.resolve())
    controller, began = switch_on(paths.controller, effects), time.time()
    shift = ShiftSummary("" if world is None else str(world))
    for number, door_id in enumerate(doors):
        run_folder = paths.run(number)
        parameters = {node: dict(values) for node, values in options.parameters.items()}
        place = {"door_number": number, **({} if world is None else {"world": world.resolve()})}
        own = {"shift_began": began, "inspection": run_folder.inspection}
        parameters[CAMERA_SIMULATOR] = parameters.get(CAMERA_SIMULATOR, {}) | place
        parameters[CONTROLLER_SIMULATOR] = parameters.get(CONTROLLER_SIMULATOR, {}) | place | own
        accepted = model(number) if model is not None else None
        if accepted is not None:
            parameters[PATH_GENERATOR] = parameters.get(PATH_GENERATOR, {}) | {"robot_model": accepted}
        run = run_in(run_folder, door_id, replace(options, parameters=parameters, controller=controller))
        shift.add(number, run_folder.root.name, run)
        shift.write(paths.summary)
        if milled is not None:
            milled(number, run)
    return shift
