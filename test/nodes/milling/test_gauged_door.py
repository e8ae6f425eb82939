"""Where a gauge measures every door, a run ends with what it found, and without one as before."""

from __future__ import annotations

from pathlib import Path

from doormill_interfaces.msg import AbbStatus, DoorInspection
from doormill_ros.abb.handshake.state import HandshakeState
from doormill_ros.cell.errors import OutOfToleranceError
from doormill_ros.nodes.base import topics
from support.cell_processes import NODES, CellProcesses

DOOR = "thesis_190_0deg"
MEASURES = (topics.MILLED_DOOR.name, topics.DOOR_INSPECTION.name)
#: The simulated robot measures for nobody.
ALONE = [word for name in MEASURES for word in ("-r", f"{name}:=nobody/hears/{name}")]


class Gauge:
    """Measures each door once the robot is done with it, and finds one feature off by so much [m]."""

    def __init__(self, cell: CellProcesses) -> None:
        self.off = 0.0
        self.told: list[str] = []
        self._hears = False
        self._cell = cell
        topic = topics.DOOR_INSPECTION
        self._publisher = cell.node.create_publisher(topic.type, topic.name, topic.offered)
        status = topics.ABB_STATUS
        self._status = cell.node.create_subscription(status.type, status.name, self._look, status.requested)
        # The bridge's last status is handed to whoever comes later.
        cell.wait(lambda: self._hears and self._publisher.get_subscription_count())

    def leave(self) -> None:
        self._cell.node.destroy_subscription(self._status)
        self._cell.node.destroy_publisher(self._publisher)
        self._cell.wait(lambda: not self._cell.node.count_publishers(topics.DOOR_INSPECTION.name))

    def _look(self, status: AbbStatus) -> None:
        self._hears = True
        if status.state == HandshakeState.DONE.value and status.run_id not in self.told:
            self.told.append(status.run_id)
            found = DoorInspection(
                run_id=status.run_id, feature=["hinge_2"], wall=[True], deviation=[self.off]
            )
            self._publisher.publish(found)


def test_the_result_says_what_the_gauge_found(tmp_path: Path) -> None:
    nodes = [name for name in NODES if name not in ("bag_recorder", "cell_simulator")]
    with CellProcesses(tmp_path, {"abb_bridge": {"gauge": True}}, nodes) as cell:
        cell.start("cell_simulator", *ALONE)
        for name in ("camera_simulator", "controller_simulator"):
            cell.wait_until_active(name)
        gauge = Gauge(cell)
        for off, success in ((2e-4, True), (1.6e-3, False), (-1.6e-3, False)):
            gauge.off = off
            result, _ = cell.mill(DOOR)
            assert gauge.told[-1] == result.run_id
            assert (result.success, result.measured) == (success, True), result.message
            assert result.error_code == (0 if success else OutOfToleranceError.code)
            assert f"hinge_2 is {1000 * abs(off):.2f} mm off" in result.message
        gauge.leave()
        result, _ = cell.mill(DOOR)
        assert (result.success, result.measured) == (True, False), result.message
        assert "not measured" in result.message
