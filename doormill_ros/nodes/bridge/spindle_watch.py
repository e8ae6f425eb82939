"""Part of /abb_bridge: the load of the spindle while a door is milled, on a topic."""

from __future__ import annotations

import threading

from std_msgs.msg import Header

from doormill_interfaces.msg import SpindleLoad
from doormill_ros.abb.handshake.spindle_load import LoadSample, SpindleLoadMeter
from doormill_ros.abb.link_errors import LinkError, UnknownSignalError
from doormill_ros.nodes.base import topics
from doormill_ros.nodes.base.looking_thread import LookingThread
from doormill_ros.nodes.base.managed_node import ManagedNode
from doormill_ros.nodes.base.node_parameter import NodeParameter

SPINDLE_PARAMETER = NodeParameter(
    "spindle_load_period",
    0.25,
    "from one look at the spindle's load to the next while a door is milled; 0: never [s]",
    0.0,
    60.0,
)


class SpindleWatch:
    """Looks at the spindle from a thread of its own, so that neither handshake nor event log wait for each other."""

    def __init__(self, node: ManagedNode, meter: SpindleLoadMeter) -> None:
        """Create the publisher.

        Args:
            node: The bridge; its parameter says how often.
            meter: Asks the controller.
        """
        self._node = node
        self._meter = meter
        self._period = float(node.value(SPINDLE_PARAMETER.name))
        self._load = node.publisher(topics.SPINDLE_LOAD)
        self._thread = LookingThread(self._run, "spindle-watch")
        self._said = ""

    def start(self) -> None:
        """Begin to look."""
        if self._period > 0.0 and self._meter.able:
            self._thread.start()

    def stop(self) -> None:
        """Cease to look."""
        self._thread.stop()

    def look(self) -> None:
        """Tell the load once, if a door is being milled; what hinders that harms nothing and is said once."""
        try:
            sample = self._meter.sample()
        except UnknownSignalError as error:
            self._say(f"nobody records the spindle's load: {error.message}")
        except LinkError as error:
            self._say(f"the spindle's load cannot be read: {error.message}")
        else:
            if sample is not None:
                self._publish(sample)

    def _run(self, ended: threading.Event) -> None:
        look = self._node.guarded(self.look)
        while not ended.wait(self._period) and self._meter.able:
            look()

    def _publish(self, sample: LoadSample) -> None:
        if self._node.context.ok():
            header = Header(stamp=self._node.get_clock().now().to_msg())
            self._load.publish(SpindleLoad(header=header, run_id=sample.run_id, load=sample.load))

    def _say(self, words: str) -> None:
        if words != self._said:
            self._said = words
            self._node.get_logger().info(words)
