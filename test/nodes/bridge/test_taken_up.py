"""A bridge that is killed while the robot mills: the next one takes the run up and tells its end."""

from __future__ import annotations

import signal
from pathlib import Path

from doormill_interfaces.action import MillDoor
from doormill_ros.nodes.base import topics
from support.cell_processes import CellProcesses

DOOR = "thesis_190_0deg"


def test_a_good_door_is_not_called_failed_because_its_bridge_died(tmp_path: Path) -> None:
    with CellProcesses(tmp_path) as cell:
        status, results = cell.subscribe(topics.ABB_STATUS), cell.subscribe(topics.RUN_RESULT)
        cell._action.send_goal_async(MillDoor.Goal(door_id=DOOR))
        cell.wait(lambda: status and status[-1].state == "milling", pause=0.001)
        run_id = status[-1].run_id
        cell.stop("abb_bridge", signal.SIGKILL)
        assert not results
        cell.start("abb_bridge")
        cell.wait(lambda: results)
        assert results[0].run_id == run_id
        assert (results[0].success, results[0].error_code) == (True, 0), results[0].message
        assert (tmp_path / "HOME" / "Hei2.end").read_text() == f"{run_id}\n"
        cell.wait_until_up()
        result, _ = cell.mill(DOOR)
        assert result.success, result.message
