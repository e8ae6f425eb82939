"""Signs of life: every node of the cell offers a topic that says nothing but that it lives; the bridge watches them.

It is DDS' liveliness, which DDS' own threads keep up: a busy node counts as alive, one that was killed or stopped is
given up after `LEASE`, or after the longer one that who watches asks for. The topics are hidden from what lists and
records topics.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import partial
from typing import Any

from rclpy.duration import Duration
from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.qos import LivelinessPolicy, QoSProfile
from std_msgs.msg import Empty

from doormill_ros.nodes.base.topics import Topic
from doormill_ros.units import s_to_ns

OFFERED = 0.6  #: s that a node's sign of life lasts by its own word; DDS sends them two thirds of it apart
#: s without a sign of life after which a node is dead. With `GRACE`, a loaded machine may keep one from the processor
#: for 1.2 s, and one that died is known in 1.6 s.
LEASE = 1.2
GRACE = 0.4  #: s by which a sign may come after that
#: A node that is started again stands beside its dead predecessor for so long after the lease [s].
SETTLING = 0.5


def qos(lease: float) -> QoSProfile:
    """Liveliness by DDS itself, for so long after each sign [s]."""
    return QoSProfile(
        depth=1,
        liveliness=LivelinessPolicy.AUTOMATIC,
        liveliness_lease_duration=Duration(nanoseconds=s_to_ns(lease)),
    )


def alive_topic(name: str, lease: float = LEASE) -> Topic:
    """The topic that a node of that name offers as long as it lives; nothing is ever published.

    Args:
        name: One that begins with a slash is taken as it is, for what is not of one namespace.
        lease: Of who watches [s], at least `LEASE`.
    """
    return Topic(name if name.startswith("/") else f"_alive/{name}", Empty, qos(OFFERED), qos(lease))


@dataclass
class _Seen:
    """What is known of the nodes of one name; times are monotonic [s]."""

    alive: int = 0
    since: float = 0.0  # when their number changed last
    ever: bool = False


class AliveWatch:
    """Knows which nodes are alive.

    Args:
        node: Managed node of which it is part; make this in its `setup`.
        names: Of the nodes to be watched.
        notify: Called after each change.
        clock: Monotonic [s].
        own: The names are also this process' own; DDS tells of the liveliness of other processes only.
        lease: Without a sign of life for so long a node is given up [s], at least `LEASE`.
    """

    def __init__(
        self,
        node: Any,
        names: Iterable[str],
        notify: Callable[[], None],
        clock: Callable[[], float] = time.monotonic,
        own: bool = False,
        lease: float = LEASE,
    ) -> None:
        self._most = 0 if own else 1
        self._settling = lease + SETTLING
        self._notify = notify
        self._clock = clock
        self._lock = threading.Lock()
        self._seen = {name: _Seen() for name in names}
        for name in self._seen:
            topic = alive_topic(name, lease)
            count = partial(self._count, name)
            events = SubscriptionEventCallbacks(liveliness=count, use_default_callbacks=False)
            subscription = node.create_subscription(
                topic.type, topic.name, lambda _: None, topic.requested, event_callbacks=events
            )
            node.keep(node.destroy_subscription, subscription)

    def dead(self, names: Iterable[str]) -> str:
        """The first of the names whose node was there and is dead; else empty."""
        late = self._clock() - GRACE
        with self._lock:
            seen = ((name, self._seen[name]) for name in names)
            return next((name for name, one in seen if one.ever and not one.alive and one.since <= late), "")

    def alive(self, name: str) -> bool:
        """A node that offers this name is alive in another process."""
        with self._lock:
            return self._seen[name].alive > 0

    def doubled(self, lasting: float | None = None) -> str:
        """The name of which more than one node is alive for so long [s], by default a restart; else empty."""
        now, lasting = self._clock(), self._settling if lasting is None else lasting
        with self._lock:
            return next(
                (
                    name
                    for name, seen in self._seen.items()
                    if seen.alive > self._most and now - seen.since > lasting
                ),
                "",
            )

    def settling(self) -> bool:
        """Two nodes of one name are alive, but perhaps not for long."""
        with self._lock:
            return any(seen.alive > self._most for seen in self._seen.values())

    def _count(self, name: str, event: Any) -> None:
        with self._lock:
            seen = self._seen[name]
            if event.alive_count != seen.alive:
                seen.alive, seen.since = event.alive_count, self._clock()
            seen.ever = seen.ever or seen.alive > 0
        self._notify()
