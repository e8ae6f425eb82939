"""The clock that stamps are taken from is set forwards and back by an hour in the middle of a run."""

from __future__ import annotations

import threading
from pathlib import Path
from typing import Any

from diagnostic_msgs.msg import DiagnosticStatus

from doormill_interfaces.action import MillDoor
from doormill_interfaces.msg import DoorRecipe
from doormill_ros.cell.errors import StageTimeoutError
from doormill_ros.nodes.base import topics
from support.cell_processes import NODES, CellProcesses
from support.clock_to_set import ClockToSet

DOOR, OTHER_DOOR = "thesis_190_0deg", "thesis_1350_0deg"
HOUR = 3600.0


def mill_while_set(
    cell: CellProcesses, recipes: list[DoorRecipe], clock: ClockToSet, step: float
) -> MillDoor.Result:
    """The result of a run in which the clock was set once its recipe was known."""
    before = {recipe.run_id for recipe in recipes}
    answered: list[MillDoor.Result] = []
    run = threading.Thread(target=lambda: answered.append(cell.mill(OTHER_DOOR)[0]))
    run.start()
    # What is latched may be delivered twice.
    cell.wait(lambda: {r.run_id for r in list(recipes) if r.door_id == OTHER_DOOR} - before)
    clock.shift += step
    run.join()
    return answered[0]


def test_a_run_ends_and_the_next_door_is_milled_when_the_clock_is_set(tmp_path: Path) -> None:
    nodes = NODES[1:]
    parameters: dict[str, dict[str, Any]] = {name: {"use_sim_time": True} for name in nodes}
    with CellProcesses(tmp_path, parameters, nodes) as cell, ClockToSet(cell.node).running() as clock:
        recipes, diagnostics = cell.subscribe(topics.DOOR_RECIPE), cell.subscribe(topics.DIAGNOSTICS)

        def said(words: str) -> bool:
            told = [status for array in list(diagnostics) for status in array.status]
            return any(words in s.message and s.level == DiagnosticStatus.WARN for s in told)

        cell.wait(lambda: cell.mill(DOOR)[0].success)
        for step, words in ((HOUR, "the clock was set forwards by"), (-HOUR, "the clock was set back by")):
            result = mill_while_set(cell, recipes, clock, step)
            # A picture of before may be refused; nobody waits in vain for a stage that takes one for another's.
            assert result.success or result.error_code not in (0, StageTimeoutError.code), result.message
            cell.wait(lambda words=words: said(words))
            cell.wait(lambda: cell.mill(DOOR)[0].success)
