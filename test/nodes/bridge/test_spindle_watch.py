"""What the bridge says of the spindle's load: a message a look, and one word of a controller that cannot tell."""

from __future__ import annotations

import threading

import pytest
import rclpy

from doormill_interfaces.msg import SpindleLoad
from doormill_ros.abb.handshake.spindle_load import SpindleLoadMeter
from doormill_ros.abb.handshake.state import HandshakeSnapshot, HandshakeState
from doormill_ros.abb.link_errors import LinkError, ReadTimeoutError, UnknownSignalError
from doormill_ros.nodes.base import topics
from doormill_ros.nodes.base.managed_node import ManagedNode
from doormill_ros.nodes.bridge.spindle_watch import SPINDLE_PARAMETER, SpindleWatch
from doormill_ros.nodes.process.spinning import SteadyExecutor
from support.memory_transport import MemoryTransport
from support.waiting import LIMIT

MILLING = HandshakeSnapshot(HandshakeState.MILLING, "", 0.0, run_id="one")


class Turning(MemoryTransport):
    """A controller whose spindle gives a quarter of its power, or that cannot say so."""

    def __init__(self, *errors: LinkError) -> None:
        super().__init__()
        self.errors = list(errors)
        self.asked = threading.Event()

    def read_analog(self, name: str) -> float:
        self.asked.set()
        if self.errors:
            raise self.errors.pop(0)
        return 25.0


class Bridge(ManagedNode):
    PARAMETERS = (SPINDLE_PARAMETER,)


def bridge(context: rclpy.Context, period: float) -> Bridge:
    override = rclpy.Parameter(SPINDLE_PARAMETER.name, value=period)
    return Bridge("bridge", context=context, parameter_overrides=[override])


def meter(transport: Turning) -> SpindleLoadMeter:
    return SpindleLoadMeter(transport, lambda: MILLING)


def test_the_load_is_told_again_and_again_while_a_door_is_milled(context: rclpy.Context) -> None:
    node, heard, enough = bridge(context, 0.01), [], threading.Event()

    def hear(message: SpindleLoad) -> None:
        heard.append(message)
        if len(heard) == 3:
            enough.set()

    executor = SteadyExecutor(2, context=context)
    executor.add_node(node)
    spinning = threading.Thread(target=executor.spin, daemon=True)
    spinning.start()
    topic = topics.SPINDLE_LOAD
    node.create_subscription(topic.type, topic.name, hear, topic.requested)
    watch = SpindleWatch(node, meter(Turning()))
    watch.start()
    try:
        assert enough.wait(LIMIT)
        assert {(message.run_id, message.load) for message in heard} == {("one", 0.25)}
        assert heard[0].header.stamp.sec > 0
    finally:
        watch.stop()
        executor.shutdown()
        spinning.join(LIMIT)
        node.destroy_node()


@pytest.fixture
def said(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """What the node's log got, whatever its level."""
    words: list[str] = []
    monkeypatch.setattr(
        "doormill_ros.nodes.base.managed_node.ManagedNode.get_logger",
        lambda _: type("Log", (), {"info": staticmethod(words.append)})(),
    )
    return words


def test_a_controller_without_the_signal_is_told_of_once(context: rclpy.Context, said: list[str]) -> None:
    node = bridge(context, 0.25)
    before = node._health
    watch = SpindleWatch(node, meter(Turning(UnknownSignalError("the controller has no signal x"))))
    for _ in range(5):
        watch.look()
    assert said == ["nobody records the spindle's load: the controller has no signal x"]
    assert node._health == before
    node.destroy_node()


def test_a_link_that_is_lost_for_long_is_told_of_once(context: rclpy.Context, said: list[str]) -> None:
    node = bridge(context, 0.25)
    watch = SpindleWatch(node, meter(Turning(*(ReadTimeoutError("no answer") for _ in range(4)))))
    for _ in range(6):
        watch.look()
    assert said == ["the spindle's load cannot be read: no answer"]
    node.destroy_node()


def test_a_period_of_0_starts_nothing(context: rclpy.Context) -> None:
    node, transport = bridge(context, 0.0), Turning()
    watch = SpindleWatch(node, meter(transport))
    watch.start()
    assert not [one for one in threading.enumerate() if one.name == "spindle-watch"]
    watch.stop()
    assert not transport.asked.is_set()
    node.destroy_node()
