"""Ended runs are still there after a restart of the page."""

from __future__ import annotations

import json
import time
from dataclasses import asdict
from pathlib import Path
from threading import Thread

import pytest
import rclpy
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st
from rclpy.node import Node
from rclpy.parameter import Parameter

from doormill_interfaces.msg import RunResult
from doormill_ros.cell.output.inspection import MeasuredDoor
from doormill_ros.cell.output.summary import RunSummary
from doormill_ros.nodes.base import topics
from doormill_ros.nodes.operator_page import OperatorPage
from doormill_ros.nodes.process.spinning import SteadyExecutor
from doormill_ros.operator.history.history import FILE, append_history, load_history
from doormill_ros.operator.views.ended_run import EndedRun
from doormill_ros.operator.views.state import HISTORY
from support.waiting import LIMIT


def run(number: int) -> EndedRun:
    return EndedRun(f"r{number}", "oak", number % 2 == 0, 204 * (number % 2), f"no. {number}", float(number))


def test_the_newest_come_first_and_the_list_is_bounded(tmp_path: Path) -> None:
    for number in range(HISTORY + 5):
        append_history(tmp_path / "new", run(number))
    assert load_history(tmp_path / "new") == tuple(run(n) for n in range(HISTORY + 4, 4, -1))


def test_runs_that_were_measured_later_take_no_other_one_s_place(tmp_path: Path) -> None:
    late = MeasuredDoor("hinge_1", 1e-4, 5e-4)
    for number in range(HISTORY):
        append_history(tmp_path, run(number))
    half = HISTORY // 2
    ended = [*map(run, range(half)), *(run(number).found(late) for number in range(half, HISTORY))]
    for one in ended[half:]:
        append_history(tmp_path, one)
    assert load_history(tmp_path) == tuple(reversed(ended))


def test_a_folder_that_is_not_there_has_no_history(tmp_path: Path) -> None:
    assert load_history(tmp_path / "nowhere") == ()


def test_runs_made_without_the_page_are_read_from_their_summaries(tmp_path: Path) -> None:
    for name in ("a", "b"):
        (tmp_path / name).mkdir()
        RunSummary("oak", False, "no edge", 201, run_id=f"run {name}").write(tmp_path / name / "summary.json")
    append_history(tmp_path, EndedRun("run a", "oak", False, 201, "no edge", 5.0))
    found = {r.run_id: r for r in load_history(tmp_path)}
    assert found.keys() == {"run a", "run b"}
    assert found["run a"].ended == 5.0  # the line says when, the summary only how
    assert abs(found["run b"].ended - time.time()) < 3600.0
    assert (found["run b"].door_id, found["run b"].error_code, found["run b"].message) == (
        "oak",
        201,
        "no edge",
    )


ENDLESS = json.dumps(asdict(run(3))).replace("204", "1e999")
DAMAGE = ["{}", "[]", "null", '{"run_id": 3}', json.dumps([1]), ENDLESS, "[" * 100_000]


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@example(damage=ENDLESS)
@example(damage="[" * 100_000)
@given(damage=st.one_of(st.text(), st.sampled_from(DAMAGE)))
def test_damaged_lines_cost_nothing_but_themselves(tmp_path: Path, damage: str) -> None:
    path = tmp_path / FILE
    path.unlink(missing_ok=True)
    append_history(tmp_path, run(1))
    with path.open("a", encoding="utf-8", errors="replace") as stream:
        stream.write(damage.replace("\n", " ") + "\n")
    append_history(tmp_path, run(2))
    assert load_history(tmp_path) == (run(2), run(1))


class Page:
    """The node, and one beside it that tells it how a run ended."""

    def __init__(self, folder: Path) -> None:
        rclpy.init()
        parameters = [Parameter("port", value=0), Parameter("history", value=str(folder))]
        self.page = OperatorPage(parameter_overrides=parameters)
        self.node = Node("beside")
        self.executor = SteadyExecutor(2)
        for node in (self.page, self.node):
            self.executor.add_node(node)
        self.thread = Thread(target=self.executor.spin, daemon=True)
        self.thread.start()
        self.page.bring_up()

    def __enter__(self) -> Page:
        return self

    def __exit__(self, *_: object) -> None:
        self.page.close()
        self.executor.shutdown(timeout_sec=2.0)
        self.thread.join(2.0)
        self.page.destroy_node()
        self.node.destroy_node()
        rclpy.try_shutdown()

    def history(self) -> list[str]:
        return [run.run_id for run in self.page.store.view.history]

    def end(self, run_id: str) -> None:
        topic = topics.RUN_RESULT
        publisher = self.node.create_publisher(topic.type, topic.name, topic.offered)
        publisher.publish(RunResult(run_id=run_id, door_id="oak", success=True, message="milled"))
        deadline = time.monotonic() + LIMIT
        while run_id not in self.history():
            assert time.monotonic() < deadline, "the page never heard of the run"
            time.sleep(0.02)


def test_a_restarted_page_knows_the_runs_before(tmp_path: Path) -> None:
    with Page(tmp_path) as first:
        assert first.history() == []
        first.end("r1")
    with Page(tmp_path) as second:
        assert second.history() == ["r1"]
        second.end("r1")  # latched, so it comes again
        second.end("r2")
    assert len((tmp_path / FILE).read_text().splitlines()) == 2
    assert {r.run_id for r in load_history(tmp_path)} == {"r1", "r2"}


@pytest.mark.parametrize("content", ["", "3", '{"run_id": ""}', "{"])
def test_other_json_files_are_no_runs(tmp_path: Path, content: str) -> None:
    (tmp_path / "summary.json").write_text(content)
    assert load_history(tmp_path) == ()
