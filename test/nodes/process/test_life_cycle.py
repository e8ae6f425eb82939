"""Nodes come up by themselves, wait for what is not there yet, and obey an operator."""

from __future__ import annotations

import signal
import time
from collections.abc import Iterator

import pytest
from lifecycle_msgs.msg import Transition
from lifecycle_msgs.srv import ChangeState, GetState
from rcl_interfaces.srv import DescribeParameters, ListParameters

from support.cell_processes import MANAGED, NODES, CellProcesses
from support.waiting import LIMIT

GOOD_DOOR = "thesis_190_0deg"
REACHED = {
    Transition.TRANSITION_CONFIGURE: "inactive",
    Transition.TRANSITION_ACTIVATE: "active",
    Transition.TRANSITION_DEACTIVATE: "inactive",
    Transition.TRANSITION_CLEANUP: "unconfigured",
}
ALL = (*NODES, "model_monitor")


@pytest.fixture(scope="module")
def cell(tmp_path_factory: pytest.TempPathFactory) -> Iterator[CellProcesses]:
    with CellProcesses(tmp_path_factory.mktemp("cell"), nodes=ALL) as running:
        running.wait_until_active("model_monitor")
        yield running


def change(cell: CellProcesses, node: str, transition: int) -> bool:
    request = ChangeState.Request(transition=Transition(id=transition))
    if cell.ask(ChangeState, f"{node}/change_state", request).success:
        return True
    # Asked twice, as the answer got lost: the second time there is nothing left to change.
    state = cell.ask(GetState, f"{node}/get_state", GetState.Request()).current_state
    return state.label == REACHED[transition]


@pytest.mark.parametrize("node", MANAGED)
def test_every_parameter_says_what_it_means(cell: CellProcesses, node: str) -> None:
    listing = cell.ask(ListParameters, f"{node}/list_parameters", ListParameters.Request())
    names = [n for n in listing.result.names if n != "use_sim_time" and not n.startswith("start_type")]
    assert "autostart" in names
    described = cell.ask(
        DescribeParameters, f"{node}/describe_parameters", DescribeParameters.Request(names=names)
    )
    assert {d.name: bool(d.description) for d in described.descriptors} == dict.fromkeys(names, True)


def test_an_operator_stops_and_restarts_one_part(cell: CellProcesses) -> None:
    assert change(cell, "path_generator", Transition.TRANSITION_DEACTIVATE)
    assert change(cell, "path_generator", Transition.TRANSITION_CLEANUP)
    assert change(cell, "path_generator", Transition.TRANSITION_CONFIGURE)
    assert change(cell, "path_generator", Transition.TRANSITION_ACTIVATE)
    result, _ = cell.mill(GOOD_DOOR)
    assert result.success, result.message


def test_an_inactive_bridge_refuses_with_what_to_do(cell: CellProcesses) -> None:
    assert change(cell, "abb_bridge", Transition.TRANSITION_DEACTIVATE)
    result, _ = cell.mill(GOOD_DOOR)
    assert result.error_code == 804
    assert "activate" in result.message
    assert change(cell, "abb_bridge", Transition.TRANSITION_ACTIVATE)
    result, _ = cell.mill(GOOD_DOOR)
    assert result.success, result.message


def test_the_bridge_waits_for_a_folder_that_is_not_there_yet(cell: CellProcesses) -> None:
    home = cell.folder / "HOME"
    cell.stop("abb_bridge", signal.SIGINT)
    home.rename(cell.folder / "away")
    cell.start("abb_bridge")
    cell.wait(lambda: "could not configure" in cell.log("abb_bridge"))
    (cell.folder / "away").rename(home)
    cell.wait_until_active("abb_bridge")
    result, _ = cell.mill(GOOD_DOOR)
    assert result.success, result.message


def test_all_processes_are_there(cell: CellProcesses) -> None:
    assert sorted(cell.processes) == sorted(ALL)


def test_processes_interrupted_until_their_end_end_cleanly(cell: CellProcesses) -> None:
    """Worse than `ros2 launch`, which sends two, at any time. The last test of the module."""
    running = dict(cell.processes)
    deadline = time.monotonic() + LIMIT
    while running := {name: process for name, process in running.items() if process.poll() is None}:
        assert time.monotonic() < deadline, f"still running: {sorted(running)}"
        for process in running.values():
            process.send_signal(signal.SIGINT)
        time.sleep(0.002)
    ended = {name: cell.stop(name) for name in list(cell.processes)}
    assert ended == dict.fromkeys(ALL, 0), "\n".join(cell.log(name)[-1500:] for name in ALL if ended[name])
    assert not [name for name in ALL if "Traceback" in cell.log(name)]
