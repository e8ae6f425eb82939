"""An inspection that is handed in as a file says on the operator's page how its run came out, as a gauge's does."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from datetime import UTC, datetime
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.parameter import Parameter

from doormill_interfaces.msg import DoorInspection, RunResult
from doormill_interfaces.srv import HandInInspection
from doormill_ros.measurements.inspections.inspection_writer import write_inspection
from doormill_ros.nodes.base import topics
from doormill_ros.nodes.base.managed_node import ManagedNode
from doormill_ros.nodes.model_monitor import ModelMonitor
from doormill_ros.nodes.operator_page import OperatorPage
from doormill_ros.operator.history.history import load_history
from doormill_ros.report.run_record import read_run
from support.source_tree import ROOT

BAG = ROOT / "bags" / "thesis_190_0deg"
BEYOND, WITHIN = "milled, out of tolerance", "milled"


class Cell:
    """Monitor, page and whoever hands in, in one thread."""

    def __init__(self, context: rclpy.Context, folder: Path) -> None:
        self.folder = folder
        self._executor = SingleThreadedExecutor(context=context)
        self._context = context
        self._started: list[ManagedNode] = []
        self.client = Node("client", context=context)
        self._executor.add_node(self.client)
        folders = {"bags": ROOT / "bags", "inspections": folder / "kept", "models": folder / "models"}
        self.monitor = self._start(ModelMonitor, folders)
        self._ask = self.client.create_client(HandInInspection, "model/inspect")

    def start_page(self) -> OperatorPage:
        """A page that keeps the history in the folder."""
        page: OperatorPage = self._start(
            OperatorPage, {name: self.folder / name for name in ("history", "audit")}, port=0
        )
        return page

    def leave(self) -> None:
        self._executor.shutdown()
        for node in self._started:
            node.close()
            node.destroy_node()
        self.client.destroy_node()

    def until(self, condition: Callable[[], object]) -> None:
        """Turn until a condition holds, for as long as the test is given."""
        while not condition():
            self._executor.spin_once(0.05)

    def hand_in(self, path: Path) -> HandInInspection.Response:
        """The monitor's answer."""
        self.until(self._ask.service_is_ready)
        future = self._ask.call_async(HandInInspection.Request(path=str(path)))
        self.until(future.done)
        return future.result()

    def _start(self, kind: type[ManagedNode], folders: dict[str, Path], **more: int) -> Any:
        values = {**{name: str(path) for name, path in folders.items()}, **more}
        node = kind(
            parameter_overrides=[Parameter(name, value=value) for name, value in values.items()],
            context=self._context,
        )
        node.bring_up()
        self._executor.add_node(node)
        self._started.append(node)
        return node


@pytest.fixture
def cell(context: rclpy.Context, tmp_path: Path) -> Iterator[Cell]:
    cell = Cell(context, tmp_path)
    yield cell
    cell.leave()


@pytest.fixture
def run_id() -> str:
    run: str = read_run(BAG).get("run/result").run_id
    return run


def inspection_in(folder: Path, run_id: str, deviation: float) -> Path:
    points = SimpleNamespace(
        feature=["hinge_1", "hinge_2"],
        surface=["wall", "floor"],
        point=np.zeros((2, 3)),
        normal=np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]),
        deviation=np.array([deviation, 1e-5]),
    )
    write_inspection(folder, BAG, run_id, datetime(2026, 11, 22, 8, tzinfo=UTC), 1e-5, points, "part")
    return folder


@pytest.mark.parametrize("late", [False, True], ids=["page is there", "page starts later"])
@pytest.mark.parametrize(("deviation", "outcome"), [(-1.6e-3, BEYOND), (3e-4, WITHIN)])
def test_the_page_says_what_a_file_found(
    cell: Cell, tmp_path: Path, run_id: str, late: bool, deviation: float, outcome: str
) -> None:
    told: list[DoorInspection] = []
    topic = topics.MODEL_INSPECTED
    cell.client.create_subscription(topic.type, topic.name, told.append, topic.requested)
    page = None if late else cell.start_page()
    cell.until(lambda: cell.monitor.count_subscribers(topic.name) == (1 if late else 2))
    answer = cell.hand_in(inspection_in(tmp_path / "inspected", run_id, deviation))
    assert (answer.success, list(answer.run_ids)) == (True, [run_id]), answer.message
    cell.until(lambda: told)
    assert (told[0].run_id, told[0].datum, told[0].header.stamp.sec) == (run_id, "part", 1795334400)
    assert list(told[0].wall) == [True, False]
    page = page or cell.start_page()
    page._take_result(RunResult(run_id=run_id, door_id="oak", success=True, message="door oak; not measured"))
    cell.until(lambda: page.store.view.history[0].measured)
    (run,) = page.store.view.history
    assert run.outcome == outcome
    assert f"hinge_1 is {abs(deviation) * 1e3:.2f} mm off where 0.50 mm are allowed" in run.message
    assert load_history(tmp_path / "history") == (run,)


def test_nothing_is_told_of_what_was_not_kept(cell: Cell, tmp_path: Path, run_id: str) -> None:
    told: list[DoorInspection] = []
    topic = topics.MODEL_INSPECTED
    cell.client.create_subscription(topic.type, topic.name, told.append, topic.requested)
    cell.until(lambda: cell.monitor.count_subscribers(topic.name) == 1)
    spoiled = inspection_in(tmp_path / "spoiled", run_id, 1e-3)
    table = spoiled / "points.csv"
    table.write_text(table.read_text().replace("wall", "roof"))
    assert not cell.hand_in(spoiled).success
    waiting = inspection_in(tmp_path / "waiting", "20200101T000000000000Z", 1e-3)
    answer = cell.hand_in(waiting)
    assert (answer.success, answer.error_code) == (False, 840)  # it waits for its bag, and is told
    cell.until(lambda: told)
    assert [found.run_id for found in told] == ["20200101T000000000000Z"]
