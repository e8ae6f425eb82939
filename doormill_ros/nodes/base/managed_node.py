"""What all nodes of the cell have in common: a life cycle, and what lives as long as it."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Any

from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.lifecycle import LifecycleState, TransitionCallbackReturn
from rclpy.qos import QoSProfile
from rclpy.serialization import deserialize_message, serialize_message

from doormill_ros.nodes.base import topics
from doormill_ros.nodes.base.alive import alive_topic
from doormill_ros.nodes.base.nested_messages import reading
from doormill_ros.nodes.base.node_parameter import NodeParameter
from doormill_ros.nodes.base.reporting_node import OK, WARN, ReportingNode

AUTOSTART = NodeParameter("autostart", True, "configure and activate at start-up")  #: of every node
RETRY_PERIOD = 2.0  # s
_REHEARSED: set[type] = set()


class ManagedNode(ReportingNode):
    """A managed node that brings itself up unless told to wait for an operator.

    Subclasses list their `PARAMETERS` and fill `setup` (configure: open what the node needs,
    create publishers and subscriptions with the helpers below) and, where they need it, `start`
    (activate), `stop` (deactivate) and `teardown` (clean up).
    """

    def __init__(self, name: str, **kwargs: Any) -> None:
        """See the base class."""
        super().__init__(name, **kwargs)
        self.active = False
        self.configured = False
        self._leaving = False
        alive = alive_topic(name)
        self.create_publisher(alive.type, alive.name, alive.offered)
        self._carried: set[Any] = set()  # types of its messages
        self._created: list[tuple[Callable[[Any], Any], Any]] = []
        self.declare_parameter(AUTOSTART.name, AUTOSTART.default, AUTOSTART.descriptor())

    def bring_up(self) -> None:
        """Configure and activate, if the parameter `autostart` says so; again until it works.

        A share, a database or a controller that comes up later than this node is nothing unusual.
        """
        if not self.value(AUTOSTART.name):
            return
        self._starting = threading.Lock()
        self._again = self.create_timer(RETRY_PERIOD, self._try_to_start)
        self._try_to_start()

    def _try_to_start(self) -> None:
        # The timer may come round while a slow machine is still at the attempt before.
        if not self._starting.acquire(blocking=False):
            return
        try:
            self._start_up()
        finally:
            self._starting.release()

    def _start_up(self) -> None:
        if self.configured or self.trigger_configure() == TransitionCallbackReturn.SUCCESS:
            self.destroy_timer(self._again)
            if not self.active:
                self.trigger_activate()

    @property
    def settled(self) -> bool:
        """See the base class."""
        return self.configured

    @property
    def heard(self) -> bool:
        """Whether what it tells surely reaches somebody; what does not is left to the next process.

        On the way out the context goes whenever rclpy's own thread comes to it, perhaps in the middle of a message.
        """
        return not self._leaving and bool(self.context.ok())

    def leave(self) -> None:
        """The process ends; `close` follows."""
        self._leaving = True

    # What a node does in each transition; subclasses override these.

    def setup(self) -> None:
        """Open files and databases, create publishers, subscriptions, services and timers."""

    def rehearse(self) -> None:
        """Do once on made-up input what a door will ask for; nothing of it leaves the node.

        Whatever is loaded, compiled or remembered at first use is there for the first door. Comes after `setup`, once
        in a process for each kind of node.
        """

    def start(self) -> None:
        """Begin to act."""

    def stop(self) -> None:
        """Cease to act; keep everything open."""

    def teardown(self) -> None:
        """Close what `setup` opened; publishers and the like are destroyed by the base class."""

    # Helpers for subclasses.

    def publisher(self, topic: topics.Topic) -> Any:
        """A publisher that lives until clean-up."""
        self._carried.add(topic.type)
        return self.keep(self.destroy_publisher, self.create_publisher(topic.type, topic.name, topic.offered))

    def subscribe(self, topic: topics.Topic, callback: Callable[[Any], None], **kwargs: Any) -> Any:
        """Call `callback` with each message while the node is active; returns the subscription.

        A publisher that offers less than the topic asks for is taken as it is, where the topic allows it.
        """
        guarded = self.guarded(reading(topic, callback))
        self._carried.add(topic.type)
        created: list[Any] = []

        def create(qos: QoSProfile, events: SubscriptionEventCallbacks | None = None) -> None:
            subscription = self.create_subscription(
                topic.type,
                topic.name,
                lambda m: guarded(m) if self.active else None,
                qos,
                event_callbacks=events,
                raw=topic.nested,
                **kwargs,
            )
            created.append(subscription)
            self.keep(self.destroy_subscription, subscription)

        def fall_back(_: Any) -> None:
            if len(created) == 1 and topic.fallback is not None:
                self.get_logger().info(f"{topic.name} is offered best effort only; messages may get lost")
                create(topic.fallback)

        events = None
        if topic.fallback:
            events = SubscriptionEventCallbacks(incompatible_qos=fall_back, use_default_callbacks=False)
        create(topic.requested, events)
        return created[0]

    def serve(self, service_type: Any, name: str, callback: Callable[[Any, Any], Any]) -> None:
        """Offer a service until clean-up; it answers in the inactive state too.

        What `callback` raises becomes `error_code` and `message` of the answer.
        """
        self.keep(self.destroy_service, self.create_service(service_type, name, self.answering(callback)))

    def every(self, period: float, callback: Callable[[], None], **kwargs: Any) -> None:
        """Call `callback` every `period` seconds while the node is active."""
        guarded = self.guarded(callback)
        timer = self.create_timer(period, lambda: guarded() if self.active else None, **kwargs)
        self.keep(self.destroy_timer, timer)

    def when_set(self, name: str, callback: Callable[[], None]) -> None:
        """As the base class, until clean-up; in the inactive state too."""
        super().when_set(name, callback)
        self.keep(self._when_set.pop, name)

    # Life cycle.

    def on_configure(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Run `setup`; on an error the node stays unconfigured and says why."""
        if not self.attempt("configure", self.setup):
            self._release()
            return TransitionCallbackReturn.FAILURE
        self._rehearse_once()
        self.configured = True
        self.report(WARN, "inactive")
        return TransitionCallbackReturn.SUCCESS

    def _rehearse_once(self) -> None:
        """A rehearsal that fails costs the first door time, nothing else."""
        if type(self) in _REHEARSED:
            return
        _REHEARSED.add(type(self))
        try:
            for message_type in self._carried:
                deserialize_message(serialize_message(message_type()), message_type)
            self.rehearse()
        except Exception as error:
            self.get_logger().warning(f"the rehearsal ended early, the first door will be slower: {error}")

    def on_activate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Run `start`."""
        self.active = True
        if not self.attempt("activate", self.start):
            self.active = False
            return TransitionCallbackReturn.FAILURE
        if self._health[1] == "inactive":
            self.report(OK, "active")
        elif self._otherwise[1] == "inactive":  # what a callback said stands in front of it
            self._otherwise = (OK, "active", {})
        self.get_logger().info("active")
        return TransitionCallbackReturn.SUCCESS

    def on_deactivate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Run `stop`."""
        self.active = False
        self.attempt("deactivate", self.stop)
        self.report(WARN, "inactive")
        return TransitionCallbackReturn.SUCCESS

    def on_cleanup(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Run `teardown` and destroy publishers, subscriptions, services and timers."""
        self.configured = False
        self.attempt("clean up", self.teardown)
        self._release()
        self.report(WARN, "unconfigured")
        return TransitionCallbackReturn.SUCCESS

    def on_shutdown(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Stop and close, from whatever state."""
        self.close()
        self._release()
        return TransitionCallbackReturn.SUCCESS

    def close(self) -> None:
        """Stop and close without ROS: the way out when the process ends and the context is gone."""
        if self.active:
            self.active = False
            self.attempt("deactivate", self.stop)
        if self.configured:
            self.configured = False
            self.attempt("clean up", self.teardown)

    def destroy_node(self) -> None:
        """Leave nothing in the ROS graph."""
        self._release()
        super().destroy_node()

    def keep(self, destroy: Callable[[Any], Any], entity: Any) -> Any:
        """Destroy `entity` at clean-up; returns it."""
        self._created.append((destroy, entity))
        return entity

    def _release(self) -> None:
        self.forget_later()
        for destroy, entity in reversed(self._created):
            destroy(entity)
        self._created.clear()
