"""Node /bag_recorder: every topic of the cell into an MCAP bag."""

from __future__ import annotations

import contextlib
import os
import socket
import sys
import threading
import time
from collections import deque
from collections.abc import Callable
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.qos import DurabilityPolicy, QoSProfile

from doormill_ros.catalogue.filler import RunFiller
from doormill_ros.catalogue.run_collector import CELL, SOFTWARE, TOPICS, topic_of
from doormill_ros.cell.errors import BadParameterError
from doormill_ros.cell.graph.node_names import BAG_RECORDER
from doormill_ros.cell.run.clock import EvenClock
from doormill_ros.nodes.base import topics
from doormill_ros.nodes.base.found_topics import is_hidden, matching, message_class, qos_document, type_name
from doormill_ros.nodes.base.frame_publisher import frame_topics
from doormill_ros.nodes.base.managed_node import ManagedNode
from doormill_ros.nodes.base.node_parameter import NodeParameter
from doormill_ros.nodes.base.reporting_node import ERROR, OK, WARN
from doormill_ros.nodes.process.run import run_nodes
from doormill_ros.recording.bag_filler import BagFiller
from doormill_ros.recording.bag_writer import BagWriter
from doormill_ros.recording.bounded_queue import BoundedQueue, Received
from doormill_ros.recording.errors import UnknownTypeError
from doormill_ros.recording.typestores import reader_of
from doormill_ros.software import software

DISCOVERY_PERIOD = 0.5  # s
SETTLING = 0.2  # s, for messages on their way when the recording ends
NICENESS = 5  # of the process: the door comes first
REMEMBERED = 32  # samples of each topic by which one that is delivered again is recognized


class BagRecorder(ManagedNode):
    """Subscribes to every topic it can see and writes what arrives, byte for byte."""

    PARAMETERS = (
        NodeParameter("bag", "", "folder to record into; empty: a new folder under `folder`"),
        NodeParameter("folder", "out/bags", "where new bags are made when `bag` is empty"),
        NodeParameter("exclude", "", "topics that are not recorded, separated by spaces"),
        NodeParameter("include_hidden_topics", False, "record what actions publish too: feedback and status"),
        NodeParameter("split_size", 512 << 20, "begin a new file at this size [bytes]; 0: never", 0, 1 << 40),
        NodeParameter(
            "catalogue",
            "",
            "database that each run is noted in, URL or file; empty: $DOORMILL_CATALOGUE or the user's; none: no",
        ),
        NodeParameter("queue_size", 256 << 20, "most that may wait for the disk [bytes]", 1 << 20, 1 << 36),
    )

    def __init__(self, **kwargs: Any) -> None:
        super().__init__(BAG_RECORDER, **kwargs)

    def setup(self) -> None:
        """Open the bag and subscribe to the cell's topics, and from then on to what else turns up.

        Raises:
            BadParameterError: The bag's folder cannot be made.
            BagExistsError: It holds files.
        """
        folder = self.value("bag")
        if not folder:
            name = datetime.now(UTC).strftime("%Y%m%dT%H%M%S%fZ")
            folder = os.path.join(self.value("folder"), name)
        self._subscribed: set[str] = set()
        self._taps: list[tuple[Any, Callable[[bytes, Any], None]]] = []
        self._skipped: set[str] = set()
        self._discovering = threading.Lock()
        self._queue = BoundedQueue(self.value("queue_size"))
        device = f"{socket.gethostname()}{self.get_namespace()}".rstrip("/")
        recorder = {SOFTWARE: software(), CELL: device}
        self._writer = self._opened(Path(folder), device, recorder)
        self._filler = BagFiller(self._queue, self._writer)
        self._runs = self._run_filler(Path(folder), recorder)
        self._even_clock = EvenClock()  # readers sort by it
        self._wanted = False
        self._excluded = {self.resolve_topic_name(name) for name in self.value("exclude").split()}
        for topic in (*topics.ALL, *frame_topics()):
            name = self.resolve_topic_name(topic.name)
            if name not in self._excluded:
                self._record(name, type_name(topic.type), topic.type, topic.offered, topic.latched)
        self._filler.start()
        if self._runs is not None:
            self._runs.start()
        self.every(DISCOVERY_PERIOD, self._discover)
        self.get_logger().info(f"recording into {folder}")

    def _opened(self, folder: Path, device: str, recorder: dict[str, str]) -> BagWriter:
        try:
            return BagWriter(folder, self.value("split_size"), device=device, custom=recorder)
        except OSError as error:
            # The bag's own name is another one at each attempt, of which the first is told.
            name = "bag" if self.value("bag") else "folder"
            raise BadParameterError(
                f"nothing can be recorded into {self.value(name)}: {error.strerror or error}; correct the parameter "
                f"{name}, or make way"
            ) from error

    def start(self) -> None:
        """Record what arrives from now on, latched state first."""
        self._wanted = True
        self._discover()

    def stop(self) -> None:
        """Leave aside what is not latched, after what was sent until now."""
        time.sleep(SETTLING)
        for subscription, receive in self._taps:
            self._drain(subscription, receive)
        self._wanted = False

    def teardown(self) -> None:
        """Write what still waits and close the bag."""
        try:
            self._filler.stop()
        finally:
            if self._runs is not None:
                self._runs.stop()
                if self._runs.failure:
                    self.get_logger().warning(self._runs.failure)
            if self._queue.dropped:
                self.get_logger().warning(_dropped_text(self._queue.dropped))

    def _run_filler(self, bag: Path, recorder: dict[str, str]) -> RunFiller | None:
        if self.value("catalogue") == "none":
            return None
        types = {topic.name: type_name(topic.type) for topic in topics.ALL if topic.name in TOPICS}
        # Readers are made once, when the first run has ended.
        return RunFiller(
            self.value("catalogue"), bag, recorder, lambda topic, data: reader_of(types[topic])(data)
        )

    def _discover(self) -> None:
        # Activation and timer may come at once from two threads; one subscription each is wanted.
        with self._discovering:
            self._subscribe_to_new()
        self._report()

    def _subscribe_to_new(self) -> None:
        for name, types in self.get_topic_names_and_types():
            if name in self._subscribed or name in self._skipped:
                continue
            hidden = is_hidden(name) and not self.value("include_hidden_topics")
            if name in self._excluded or hidden or not self._own(name):
                self._skipped.add(name)
                continue
            offers = [info.qos_profile for info in self.get_publishers_info_by_topic(name)]
            if not offers:
                continue
            found = matching(offers)
            latched = found.durability == DurabilityPolicy.TRANSIENT_LOCAL
            try:
                self._record(name, types[0], message_class(types[0]), found, latched)
            except (ImportError, AttributeError, UnknownTypeError):
                self._skipped.add(name)
                self.get_logger().warning(f"{name} is not recorded: {types[0]} is not installed here")

    def _own(self, name: str) -> bool:
        """A topic of this cell or of the whole network: in a namespace those of other cells are none of its own."""
        namespace = self.get_namespace().rstrip("/")
        return not namespace or name.startswith(f"{namespace}/") or name.count("/") == 1

    def _record(self, name: str, kind: str, message_type: Any, offered: QoSProfile, latched: bool) -> None:
        # Of a kept event nothing is repeated, neither in a further file nor by who plays the bag.
        durability = "transient_local" if latched else "volatile"
        self._filler.add_topic(name, kind, [{**qos_document(offered), "durability": durability}])
        told = topic_of(name)
        latest: deque[tuple[Any, Any]] = deque(maxlen=REMEMBERED)

        # Both arguments are needed: with one, rclpy does not tell when the message was sent.
        def receive(data: bytes, info: Any) -> None:
            sample = info.get("source_timestamp"), info.get("publication_sequence_number")
            if sample in latest:  # DDS may deliver what is latched to a late joiner twice
                return
            latest.append(sample)
            if self._wanted or latched:
                now = self._even_clock.now()
                self._queue.put(Received(name, bytes(data), now, sample[0] or now))
                if told and self._runs is not None:
                    self._runs.take(told, bytes(data), now)

        requested = QoSProfile(
            depth=max(10, offered.depth), reliability=offered.reliability, durability=offered.durability
        )
        events = SubscriptionEventCallbacks(
            message_lost=lambda event: self._count_lost(name, event), use_default_callbacks=False
        )
        subscription = self.create_subscription(
            message_type, name, receive, requested, raw=True, event_callbacks=events
        )
        self.keep(self.destroy_subscription, subscription)
        self._taps.append((subscription, receive))
        self._subscribed.add(name)

    def _count_lost(self, name: str, event: Any) -> None:
        """DDS could not deliver messages; they count like those that did not fit."""
        if self._wanted:
            self._queue.count_dropped({name: event.total_count_change})

    @staticmethod
    def _drain(subscription: Any, receive: Callable[[bytes, Any], None]) -> None:
        """Take what has arrived and no executor has asked for any more."""
        with contextlib.suppress(RuntimeError), subscription.handle:
            while (taken := subscription.handle.take_message(subscription.msg_type, True)) is not None:
                receive(*taken)

    def _report(self) -> None:
        dropped = sum(self._queue.dropped.values())
        counts = {"messages": sum(f.message_count for f in self._writer.record.files), "dropped": dropped}
        if self._filler.failure:
            self.report(ERROR, f"{self._filler.failure}; {_dropped_text(self._queue.dropped)}", **counts)
        elif dropped:
            self.report(WARN, _dropped_text(self._queue.dropped), **counts)
        elif self._runs is not None and self._runs.failure:
            self.report(WARN, self._runs.failure, **counts)
        else:
            self.report(OK, "recording", bag=str(self._writer.folder), **counts)


def _dropped_text(dropped: dict[str, int]) -> str:
    counts = ", ".join(f"{count} of {topic}" for topic, count in sorted(dropped.copy().items()))
    return f"messages that are not in the bag: {counts or 'none'}"


def main() -> int:
    """Run the node; compressing a picture may wait until the door has its targets, and so may its memory."""
    os.nice(NICENESS)
    return run_nodes(BagRecorder, keep_freed=False)


if __name__ == "__main__":
    sys.exit(main())
