"""The machine's own clock is set forwards and back by an hour, between runs and in the middle of one."""

from __future__ import annotations

import json
import threading
import urllib.request
from pathlib import Path
from typing import Any

import pytest

from doormill_interfaces.action import MillDoor
from doormill_interfaces.msg import RunResult, StageTimes
from doormill_ros.cell.errors import StageTimeoutError
from doormill_ros.nodes.base import topics
from doormill_ros.recording.bag_reader import read_bag
from support.cell_processes import NODES, CellProcesses, free_port
from support.waiting import LIMIT
from support.wall_clock import WallClock

DOOR, OTHER_DOOR = "thesis_190_0deg", "thesis_1350_0deg"
HOUR = 3600.0


def mill_while_set(cell: CellProcesses, clock: WallClock, step: float) -> MillDoor.Result:
    """The result of a run in which the clock was set once its recipe was known."""
    recipes = cell.subscribe(topics.DOOR_RECIPE)
    answered: list[MillDoor.Result] = []
    run = threading.Thread(target=lambda: answered.append(cell.mill(OTHER_DOOR)[0]))
    run.start()
    cell.wait(lambda: any(recipe.door_id == OTHER_DOOR for recipe in list(recipes)))
    clock.step(step)
    run.join()
    return answered[0]


def shown(port: int) -> dict[str, Any]:
    """What the operator's page says now."""
    with urllib.request.urlopen(f"http://127.0.0.1:{port}/state", timeout=LIMIT) as answer:
        return dict(json.load(answer))


@pytest.mark.timeout(900)
def test_runs_end_and_are_told_in_order_when_the_machine_s_clock_is_set(tmp_path: Path) -> None:
    clock, port = WallClock(tmp_path), free_port()
    parameters = {"operator_page": {"port": port, "history": tmp_path / "history"}}
    folder = tmp_path / "cell"
    results: list[MillDoor.Result] = []
    with CellProcesses(folder, parameters, (*NODES, "operator_page"), clock.environment) as cell:
        cell.wait_until_active("operator_page")
        told: list[RunResult] = cell.subscribe(topics.RUN_RESULT)

        def milled() -> bool:
            results.append(cell.mill(DOOR)[0])
            return bool(results[-1].success)

        cell.wait(milled)
        for step in (HOUR, -HOUR):
            results.append(mill_while_set(cell, clock, step))
            # A picture of before may be refused; nobody waits in vain for a stage that takes one for another's.
            refused = results[-1]
            assert refused.success or refused.error_code not in (0, StageTimeoutError.code), refused.message
            cell.wait(milled)
        for step in (-HOUR, HOUR):
            clock.step(step)
            assert 0.0 <= shown(port)["state_age"] < HOUR / 2, shown(port)
            assert milled(), results[-1].message
        runs = [result.run_id for result in results]
        cell.wait(lambda: runs[-1] in [result.run_id for result in list(told)])

        def history() -> list[str]:
            return [run["run_id"] for run in shown(port)["history"]]

        # The page hears of the last run on its own.
        cell.wait(lambda: runs[-1] in history())
        kept = history()
        for name in list(cell.processes):
            assert cell.stop(name) == 0, cell.log(name)
            assert "Traceback" not in cell.log(name), cell.log(name)
    assert len(set(runs)) == len(runs)
    assert kept == runs[::-1]
    messages = list(read_bag(folder / "bag"))
    times = [message.stamp_ns for message in messages]
    assert times == sorted(times)
    recorded = [m.message for m in messages if m.topic == "/run/result"]
    assert list(dict.fromkeys(result.run_id for result in recorded)) == runs
    durations = [
        getattr(result.times, name) for result in recorded for name in StageTimes.get_fields_and_field_types()
    ]
    assert durations
    assert [duration for duration in durations if not 0.0 <= duration < HOUR / 2] == []
