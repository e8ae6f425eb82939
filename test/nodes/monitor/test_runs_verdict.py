"""The monitor asks the bags of runs by itself: what changed is told on a topic, in diagnostics and on the page."""

from __future__ import annotations

import json
import signal
from collections.abc import Callable, Iterator
from typing import Any
from urllib.request import urlopen

import pytest
from diagnostic_msgs.msg import DiagnosticStatus

from doormill_interfaces.msg import RunResult, RunsVerdict
from doormill_ros.monitor.runs_finding import FEW
from doormill_ros.nodes.base import topics
from doormill_ros.nodes.base.reporting_node import OK, WARN
from doormill_ros.nodes.convert.runs_verdict import changes_of_runs
from doormill_ros.recording.bag_reader import read_bag
from support.cell_processes import CellProcesses, free_port
from support.run_series import Series, draw_series
from support.run_series_bags import write_series
from support.waiting import LIMIT

MONITOR, PAGE, RECORDER = "model_monitor", "operator_page", "bag_recorder"
COUNT = 12


class Cell:
    """The running nodes, and what they told."""

    def __init__(self, nodes: CellProcesses, series: Series, port: int) -> None:
        self.nodes, self.series, self._port = nodes, series, port
        self.verdicts: list[RunsVerdict] = nodes.subscribe(topics.RUNS_VERDICT)
        self._diagnostics = nodes.subscribe(topics.DIAGNOSTICS)

    def until(self, condition: Callable[[RunsVerdict], bool], start: int = 0) -> RunsVerdict:
        """The first verdict from one on for which a condition holds."""
        found = self.nodes.wait(lambda: next((v for v in self.verdicts[start:] if condition(v)), None))
        assert isinstance(found, RunsVerdict)
        return found

    def says(self, level: bytes, words: str) -> DiagnosticStatus:
        """The monitor's word in the diagnostics, once it is of a level and holds some words."""

        def found() -> Any:
            said = [status for array in self._diagnostics[-20:] for status in array.status]
            own = [status for status in said if status.name.endswith(MONITOR)]
            return next((one for one in own if one.level == level and words in one.message), None)

        return self.nodes.wait(found)

    def page(self) -> dict[str, Any]:
        """What the page shows."""
        with urlopen(f"http://127.0.0.1:{self._port}/state", timeout=LIMIT) as answer:
            found: dict[str, Any] = json.load(answer)
        return found


@pytest.fixture(scope="module")
def cell(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Cell]:
    """Each test goes on where the one before ended; first the bags of a series lie there in which the camera moved."""
    folder, port = tmp_path_factory.mktemp("cell"), free_port()
    drawn = draw_series(
        11, ("camera_shift",), COUNT, probe=True, marks=True, repeats=3, drift=False, order="one", calm=True
    )
    write_series(drawn, folder / "bags")
    parameters = {MONITOR: {"bags": folder / "bags"}, PAGE: {"port": port, "history": folder / "runs"}}
    with CellProcesses(folder, parameters, (MONITOR, PAGE, RECORDER)) as nodes:
        for node in (MONITOR, PAGE, RECORDER):
            nodes.wait_until_active(node)
        yield Cell(nodes, drawn, port)


def test_a_hidden_change_is_told_with_its_place_its_run_and_its_size(cell: Cell) -> None:
    said = cell.until(lambda v: bool(v.changes) and not v.asking)
    (change,), (hidden,) = said.changes, cell.series.changes
    assert (said.verdict, change.cause, change.where) == ("explained", "camera_shift", "camera")
    assert change.earliest <= cell.series.run_id(hidden.first) <= change.latest
    assert list(said.runs) == [cell.series.run_id(run) for run in range(COUNT)]
    assert (said.questioned, list(said.left_aside), said.error_code) == (COUNT, [], 0)
    (told,) = changes_of_runs(said)
    assert told.words in said.sentence
    assert f"before run {change.from_run}" in said.next_measurement


def test_the_diagnostics_warn_and_the_page_shows_the_sentence(cell: Cell) -> None:
    said = cell.verdicts[-1]
    status = cell.says(WARN, said.sentence)
    assert "error_code" not in {pair.key for pair in status.values}
    shown = cell.nodes.wait(lambda: (cell.page()["runs"] or {}).get("sentence"))
    assert shown == said.sentence
    assert cell.page()["runs"]["changes"][0]["cause"] == "camera_shift"


def test_a_monitor_that_is_killed_comes_back_with_its_verdict(cell: Cell) -> None:
    before, count = cell.verdicts[-1], len(cell.verdicts)
    cell.nodes.stop(MONITOR, signal.SIGKILL)
    cell.nodes.start(MONITOR)
    cell.nodes.wait_until_active(MONITOR)
    first = cell.until(lambda v: True, count)
    assert (first.sentence, first.changes, first.asking) == (before.sentence, before.changes, False)
    cell.says(WARN, before.sentence)


def test_every_third_run_that_ends_asks_anew(cell: Cell) -> None:
    count = len(cell.verdicts)
    publisher = cell.nodes.node.create_publisher(
        RunResult, topics.RUN_RESULT.name, topics.RUN_RESULT.requested
    )
    cell.nodes.wait(lambda: publisher.get_subscription_count() >= 3)
    for number in range(3):
        publisher.publish(RunResult(run_id=f"run-{number}", door_id="standard_door", success=True))
    assert cell.until(lambda v: v.asking, count).changes == cell.verdicts[count - 1].changes
    asked = len(cell.verdicts)
    assert cell.until(lambda v: not v.asking, asked - 1).changes


def test_what_was_put_right_is_told_no_more(cell: Cell) -> None:
    count = len(cell.verdicts)
    cell.nodes.put(MONITOR, since=cell.series.run_id(COUNT - 2))
    said = cell.until(lambda v: v.verdict == FEW, count)
    assert (said.questioned, list(said.changes), said.since) == (2, [], cell.series.run_id(COUNT - 2))
    cell.says(OK, "no door was inspected yet")
    cell.nodes.wait(lambda: cell.page()["runs"]["verdict"] == FEW)
    assert cell.page()["runs"]["changes"] == []


def test_every_verdict_is_recorded(cell: Cell) -> None:
    cell.nodes.stop(RECORDER)
    told = [item.message for item in read_bag(cell.nodes.folder / "bag", ["/model/runs_verdict"])]
    assert {"explained", FEW} <= {message.verdict for message in told}
    assert {change.cause for message in told for change in message.changes} == {"camera_shift"}
    assert cell.nodes.stop(MONITOR) == 0
    assert "Traceback" not in cell.nodes.log(MONITOR)
