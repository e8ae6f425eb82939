"""What all nodes of the cell have in common: life cycle, parameters, diagnostics, guarded callbacks."""

from __future__ import annotations

import threading
import traceback
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rcl_interfaces.msg import FloatingPointRange, IntegerRange, ParameterDescriptor
from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.lifecycle import LifecycleNode, LifecycleState, TransitionCallbackReturn
from rclpy.qos import QoSProfile

from doormill_ros.errors import DoormillError
from doormill_ros.nodes import topics

OK, WARN, ERROR = DiagnosticStatus.OK, DiagnosticStatus.WARN, DiagnosticStatus.ERROR
DIAGNOSTICS_PERIOD = 1.0  # s
RETRY_PERIOD = 2.0  # s
DISPLAY_DELAY = 0.1  # s


@dataclass(frozen=True)
class Parameter:
    """A declared parameter: name, default, what it means with its unit, allowed range."""

    name: str
    default: Any
    description: str
    low: float | None = None
    high: float | None = None

    def descriptor(self) -> ParameterDescriptor:
        """The ROS descriptor."""
        descriptor = ParameterDescriptor(description=self.description)
        if self.low is not None and isinstance(self.default, float):
            descriptor.floating_point_range = [FloatingPointRange(from_value=self.low, to_value=self.high)]
        elif self.low is not None:
            descriptor.integer_range = [IntegerRange(from_value=int(self.low), to_value=int(self.high))]
        return descriptor


class ManagedNode(LifecycleNode):
    """A managed node that brings itself up unless told to wait for an operator.

    Subclasses list their `PARAMETERS` and fill `setup` (configure: open what the node needs,
    create publishers and subscriptions with the helpers below) and, where they need it, `start`
    (activate), `stop` (deactivate) and `teardown` (clean up).
    """

    PARAMETERS: tuple[Parameter, ...] = ()

    def __init__(self, name: str, **kwargs: Any) -> None:
        """Declare the parameters and start reporting on /diagnostics."""
        super().__init__(name, **kwargs)
        self.active = False
        self.configured = False
        self._created: list[tuple[Callable[[Any], bool], Any]] = []
        self._later: dict[str, Any] = {}
        self._health: tuple[bytes, str, dict[str, Any]] = (WARN, "unconfigured", {})
        self.declare_parameter(
            "autostart", True, ParameterDescriptor(description="configure and activate at start-up")
        )
        for parameter in self.PARAMETERS:
            self.declare_parameter(parameter.name, parameter.default, parameter.descriptor())
        self._diagnostics = self.create_publisher(
            DiagnosticArray, topics.DIAGNOSTICS.name, topics.DIAGNOSTICS.offered
        )
        self.create_timer(DIAGNOSTICS_PERIOD, self._publish_diagnostics)

    def value(self, name: str) -> Any:
        """Current value of a parameter."""
        return self.get_parameter(name).value

    def bring_up(self) -> None:
        """Configure and activate, if the parameter `autostart` says so; again until it works.

        A share, a database or a controller that comes up later than this node is nothing unusual.
        """
        if not self.value("autostart"):
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

    # What a node does in each transition; subclasses override these.

    def setup(self) -> None:
        """Open files and databases, create publishers, subscriptions, services and timers."""

    def start(self) -> None:
        """Begin to act."""

    def stop(self) -> None:
        """Cease to act; keep everything open."""

    def teardown(self) -> None:
        """Close what `setup` opened; publishers and the like are destroyed by the base class."""

    # Helpers for subclasses.

    def publisher(self, topic: topics.Topic) -> Any:
        """A publisher that lives until clean-up."""
        return self.keep(self.destroy_publisher, self.create_publisher(topic.type, topic.name, topic.offered))

    def subscribe(self, topic: topics.Topic, callback: Callable[[Any], None], **kwargs: Any) -> None:
        """Call `callback` with each message while the node is active.

        A publisher that offers less than the topic asks for is taken as it is, where the topic allows it.
        """
        guarded = self.guarded(callback)
        created: list[Any] = []

        def create(qos: QoSProfile, events: SubscriptionEventCallbacks | None = None) -> None:
            subscription = self.create_subscription(
                topic.type,
                topic.name,
                lambda m: guarded(m) if self.active else None,
                qos,
                event_callbacks=events,
                **kwargs,
            )
            created.append(subscription)
            self.keep(self.destroy_subscription, subscription)

        def fall_back(_: Any) -> None:
            if len(created) == 1 and topic.fallback is not None:
                self.get_logger().info(f"{topic.name} is offered best effort only; pictures may get lost")
                create(topic.fallback)

        events = SubscriptionEventCallbacks(incompatible_qos=fall_back) if topic.fallback else None
        create(topic.requested, events)

    def serve(self, service_type: Any, name: str, callback: Callable[[Any, Any], Any]) -> None:
        """Offer a service until clean-up; it answers in the inactive state too.

        What `callback` raises becomes `error_code` and `message` of the answer.
        """

        def answer(request: Any, response: Any) -> Any:
            try:
                return callback(request, response)
            except DoormillError as error:
                response.error_code, response.message = error.code, error.message
                self.report(WARN, error.message, error_code=error.code)
            except Exception as error:
                response.error_code = DoormillError.code
                response.message = (
                    f"unexpected {type(error).__name__}: {error}; see the log of {self.get_name()}"
                )
                self.report(ERROR, response.message)
                self.get_logger().error(traceback.format_exc())
            return response

        self.keep(self.destroy_service, self.create_service(service_type, name, answer))

    def every(self, period: float, callback: Callable[[], None], **kwargs: Any) -> None:
        """Call `callback` every `period` seconds while the node is active."""
        guarded = self.guarded(callback)
        timer = self.create_timer(period, lambda: guarded() if self.active else None, **kwargs)
        self.keep(self.destroy_timer, timer)

    def later(self, name: str, callback: Callable[[], None]) -> None:
        """Call once, a moment from now; one that still waits under the same name gives way.

        For what only people look at: drawn at once, it would take a core from the run in hand.
        """

        def call() -> None:
            self._forget_later(name)
            guarded()

        guarded = self.guarded(callback)
        self._forget_later(name)
        self._later[name] = self.create_timer(DISPLAY_DELAY, call)

    def _forget_later(self, name: str) -> None:
        timer = self._later.pop(name, None)
        if timer is not None:
            self.destroy_timer(timer)

    def guarded(self, callback: Callable[..., None]) -> Callable[..., None]:
        """A callback that reports what went wrong instead of ending the node."""

        def call(*args: Any) -> None:
            try:
                callback(*args)
            except DoormillError as error:
                self.report(ERROR, error.message, error_code=error.code)
                self.get_logger().error(error.message)
            except Exception as error:
                if not self.context.ok():  # interrupted: nothing can be published any more
                    return
                self.report(ERROR, f"unexpected {type(error).__name__}: {error}")
                self.get_logger().error(traceback.format_exc())

        return call

    def report(self, level: bytes, message: str, **values: Any) -> None:
        """Set what the node says of itself on /diagnostics.

        What is not well, or well again, is published at once; a healthy node's news wait for the next round:
        each message wakes every process that listens, in the middle of a run.
        """
        healthy = level == OK and self._health[0] == OK
        changed = (level, message) != self._health[:2]
        self._health = (level, message, values)
        if changed and not healthy:
            self._publish_diagnostics()

    # Life cycle.

    def on_configure(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Run `setup`; on an error the node stays unconfigured and says why."""
        if not self._attempt("configure", self.setup):
            self._release()
            return TransitionCallbackReturn.FAILURE
        self.configured = True
        self.report(WARN, "inactive")
        return TransitionCallbackReturn.SUCCESS

    def on_activate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Run `start`."""
        self.active = True
        if not self._attempt("activate", self.start):
            self.active = False
            return TransitionCallbackReturn.FAILURE
        if self._health[1] == "inactive":
            self.report(OK, "active")
        self.get_logger().info("active")
        return TransitionCallbackReturn.SUCCESS

    def on_deactivate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Run `stop`."""
        self.active = False
        self._attempt("deactivate", self.stop)
        self.report(WARN, "inactive")
        return TransitionCallbackReturn.SUCCESS

    def on_cleanup(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Run `teardown` and destroy publishers, subscriptions, services and timers."""
        self.configured = False
        self._attempt("clean up", self.teardown)
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
            self._attempt("deactivate", self.stop)
        if self.configured:
            self.configured = False
            self._attempt("clean up", self.teardown)

    def destroy_node(self) -> None:
        """Leave nothing in the ROS graph."""
        self._release()
        super().destroy_node()

    def keep(self, destroy: Callable[[Any], Any], entity: Any) -> Any:
        """Destroy `entity` at clean-up; returns it."""
        self._created.append((destroy, entity))
        return entity

    def _release(self) -> None:
        for name in list(self._later):
            self._forget_later(name)
        for destroy, entity in reversed(self._created):
            destroy(entity)
        self._created.clear()

    def _attempt(self, what: str, action: Callable[[], None]) -> bool:
        try:
            action()
        except DoormillError as error:
            message = error.message
        except Exception as error:
            message = f"{type(error).__name__}: {error}"
            self.get_logger().error(traceback.format_exc())
        else:
            return True
        if self._health[1] != f"could not {what}: {message}":
            self.get_logger().error(f"could not {what}: {message}")
        self.report(ERROR, f"could not {what}: {message}")
        return False

    def _publish_diagnostics(self) -> None:
        if not self.context.ok():
            return
        level, message, values = self._health
        status = DiagnosticStatus(
            level=level,
            name=self.get_fully_qualified_name().lstrip("/"),
            message=message,
            hardware_id="doormill",
            values=[KeyValue(key=key, value=str(value)) for key, value in values.items()],
        )
        array = DiagnosticArray(status=[status])
        array.header.stamp = self.get_clock().now().to_msg()
        self._diagnostics.publish(array)
