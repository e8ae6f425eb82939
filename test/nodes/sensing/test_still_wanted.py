"""A reading that took a while is not sent into a run that has ended or to the next one."""

from __future__ import annotations

import rclpy
from std_msgs.msg import Bool

from doormill_interfaces.msg import RunResult
from doormill_ros.nodes.sensing.requested_sensor import RequestedSensor


class Slow(RequestedSensor):
    """Says of each reading whether it is still wanted when it is there; `meanwhile` something happens."""

    def setup(self) -> None:
        self.sent: list[tuple[str, bool]] = []
        self.meanwhile = lambda: None
        self.open_sensor(3600.0)

    def send(self, run_id: str) -> None:
        self.meanwhile()
        self.sent.append((run_id, self.still_wanted(run_id)))


def test_what_happens_meanwhile_counts(context: rclpy.Context) -> None:
    node = Slow("slow", context=context)
    node.trigger_configure()
    node._take_request(Bool(data=True))
    node.want("first")
    node.meanwhile = lambda: node._take_result(RunResult(run_id="first"))
    node.expose()
    node.meanwhile = lambda: None
    node.want("second")
    node.meanwhile = lambda: setattr(node, "_run_id", "third")
    node.expose()
    node.meanwhile = lambda: node._take_request(Bool(data=False))
    node.want("fourth")
    node.destroy_node()
    assert node.sent == [
        ("first", True),
        ("first", False),
        ("second", True),
        ("second", False),
        ("fourth", False),
    ]
