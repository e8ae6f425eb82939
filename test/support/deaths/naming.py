"""How long after a strike a refusal names the node that it killed."""

from __future__ import annotations

import re
import time
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.node import Node

from doormill_ros.nodes.base.alive import GRACE, LEASE, alive_topic
from support.deaths.strikes import NODES, Strike

#: Nodes that one executable runs.
HOSTED = {"cell_simulator": ("camera_simulator", "sensor_simulator", "controller_simulator")}


class Lives:
    """Hears when nodes are alive again, as anybody on the network can.

    Args:
        clock: Monotonic [s].
    """

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._counted: dict[str, list[tuple[float, int]]] = {}

    def listen(self, node: Node) -> None:
        """Hear the nodes of the cell by a node of one's own."""
        for name in (hosted for executable in NODES for hosted in HOSTED.get(executable, (executable,))):
            topic = alive_topic(name)
            events = SubscriptionEventCallbacks(liveliness=partial(self._count, name))
            node.create_subscription(
                topic.type, topic.name, lambda _: None, topic.requested, event_callbacks=events
            )

    def _count(self, name: str, event: Any) -> None:
        self.count(name, event.alive_count)

    def count(self, name: str, alive: int) -> None:
        """So many nodes of a name are alive now."""
        self._counted.setdefault(name, []).append((self._clock(), alive))

    def back(self, name: str, when: float) -> bool:
        """A node that was struck then [s] was there again before it had to be given up."""
        counted = self._counted.get(name, ())
        _, alive = max((one for one in counted if when < one[0] <= when + LEASE + GRACE), default=(when, 0))
        return alive > 0


def named_after(
    message: str, fallen: Sequence[tuple[Strike, float]], now: float, lives: Lives
) -> list[float]:
    """How long after the strike that did it a refusal named the node [s]; none where that fell on an earlier goal.

    While the bridge is stopped itself there is nobody to name it: that time does not count.

    Args:
        message: Of the refusal.
        fallen: Strikes that fell while the goal was in hand, and when.
        now: When its result came, by the same clock.
        lives: Nodes that were there again in time were never dead: a later strike killed them.
    """
    named = re.search(r"/(\w+) is dead", message)
    died = [
        when
        for strike, when in fallen
        # One that was stopped for less than a node may be silent for was never dead.
        if named
        and named[1] in HOSTED.get(strike.node, (strike.node,))
        and (strike.kill or strike.stopped > LEASE)
        and not lives.back(named[1], when)
    ]
    resumed = [when + s.stopped for s, when in fallen if s.node == "abb_bridge" and not s.kill]
    return [now - max([min(died), *(when for when in resumed if when <= now)])] if died else []
