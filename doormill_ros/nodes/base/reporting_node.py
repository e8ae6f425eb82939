"""A node that says how it is: parameters, diagnostics, and callbacks that report what goes wrong in them."""

from __future__ import annotations

import threading
import traceback
from collections.abc import Callable
from typing import Any

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from rcl_interfaces.msg import SetParametersResult
from rclpy.clock import Clock, ClockType
from rclpy.exceptions import ParameterException
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.lifecycle import LifecycleNode
from rclpy.parameter import Parameter

from doormill_ros.cell.errors import BadParameterError
from doormill_ros.errors import DoormillError, one_line, unexpected
from doormill_ros.nodes.base import topics
from doormill_ros.nodes.base.node_parameter import NodeParameter
from doormill_ros.nodes.base.parameter_changes import refusal
from doormill_ros.nodes.base.unmatched import (
    NO_PUBLISHER_EVENTS,
    NO_SUBSCRIPTION_EVENTS,
    PERIOD,
    UnmatchedEndpoints,
)
from doormill_ros.nodes.convert.diagnostics import diagnostics

OK: bytes = DiagnosticStatus.OK
WARN: bytes = DiagnosticStatus.WARN
ERROR: bytes = DiagnosticStatus.ERROR
DIAGNOSTICS_PERIOD = 1.0  # s
DISPLAY_DELAY = 0.1  # s
#: What to do about a value that a node cannot be started with.
AT_START = "correct it on the command line or in the parameter file"
STEADY = Clock(clock_type=ClockType.STEADY_TIME)
#: What rclpy raises once a signal has taken the context away.
_GONE = (rclpy_implementation.RCLError, rclpy_implementation.InvalidHandle)


class ReportingNode(LifecycleNode):  # type: ignore[misc]  # rclpy has no types
    """A node that outlives its callbacks' errors and tells of them on /diagnostics."""

    PARAMETERS: tuple[NodeParameter, ...] = ()

    def __init__(self, name: str, **kwargs: Any) -> None:
        """Declare the parameters and start reporting on /diagnostics."""
        super().__init__(name, **kwargs)
        self._later: dict[str, Any] = {}  # timers by name
        self._due: dict[str, Callable[[], None]] = {}
        self._when_set: dict[str, Callable[[], None]] = {}
        self._health: tuple[bytes, str, dict[str, Any]] = (WARN, "unconfigured", {})
        self._telling = threading.RLock()
        # Errors of guarded callbacks that are told, the latest last, and what the node said of itself before them.
        self._failures: dict[object, tuple[bytes, str, dict[str, Any]]] = {}
        self._otherwise = self._health
        try:
            for parameter in self.PARAMETERS:
                self._declare(parameter)
        except BadParameterError:
            LifecycleNode.destroy_node(self)  # what subclasses destroy is not there yet
            raise
        self.add_post_set_parameters_callback(self._tell_change)
        self._diagnostics = self.create_publisher(
            DiagnosticArray, topics.DIAGNOSTICS.name, topics.DIAGNOSTICS.offered
        )
        self.create_timer(DIAGNOSTICS_PERIOD, self._publish_diagnostics)
        self._unmatched = UnmatchedEndpoints(self)
        self.create_timer(PERIOD, self.guarded(self._tell_unmatched))

    def create_publisher(self, *args: Any, **kwargs: Any) -> Any:
        """A publisher without the events of rclpy's default, see `unmatched`."""
        return super().create_publisher(*args, **_with_events(kwargs, NO_PUBLISHER_EVENTS))

    def create_subscription(self, *args: Any, **kwargs: Any) -> Any:
        """A subscription without the events of rclpy's default, see `unmatched`."""
        return super().create_subscription(*args, **_with_events(kwargs, NO_SUBSCRIPTION_EVENTS))

    def _tell_unmatched(self) -> None:
        for sentence in self._unmatched.news():
            self.get_logger().warning(sentence)

    def create_timer(
        self, period: float, callback: Callable[[], None] | None, *args: Any, **kwargs: Any
    ) -> Any:
        """A timer on a steady clock: one on the node's own stands still for as long as the wall clock is set back."""
        return super().create_timer(period, callback, *args, **{"clock": STEADY, **kwargs})

    def _declare(self, parameter: NodeParameter) -> None:
        """Declare a parameter with what the command line or a file says of it.

        Raises:
            BadParameterError: That is no value that it can have.
        """
        given = self._parameter_overrides.get(parameter.name)
        default, whole = parameter.default, given is not None and type(given.value) is int
        if given is not None and parameter.choices and given.value not in parameter.choices:
            raise self._bad_value(parameter, given.value)
        if isinstance(default, float) and whole:
            given = Parameter(parameter.name, value=float(given.value))
            self._parameter_overrides[parameter.name] = given
        try:
            self.declare_parameter(parameter.name, default, parameter.descriptor())
        except ParameterException as error:
            raise self._bad_value(parameter, given.value) from error

    def _bad_value(self, parameter: NodeParameter, value: object) -> DoormillError:
        return BadParameterError(parameter.refusal(self.get_name(), value, AT_START))

    def declared(self) -> set[str]:
        """Names of the parameters that the node has."""
        return set(self._parameters)

    def given(self) -> set[str]:
        """Names of the parameters that the command line or a file gives the node a value for."""
        return set(self._parameter_overrides)

    def parameter(self, name: str) -> NodeParameter:
        """What a parameter of the node may be; that of one of rclpy or of a base class by its value."""
        found = {parameter.name: parameter for parameter in self.PARAMETERS}.get(name)
        return found or NodeParameter(name, self.value(name), self.describe_parameter(name).description)

    def set_parameters(self, parameter_list: list[Parameter]) -> list[SetParametersResult]:
        """See the base class, whose method does not call the one below."""
        return [self.set_parameters_atomically([parameter]) for parameter in parameter_list]

    def set_parameters_atomically(self, parameter_list: list[Parameter]) -> SetParametersResult:
        """Judge changes first: of a value of another type rclpy tells the numbers of the types."""
        reason = refusal(self, parameter_list)
        if reason:
            return SetParametersResult(successful=False, reason=reason)
        return super().set_parameters_atomically(parameter_list)

    def _tell_change(self, changes: list[Parameter]) -> None:
        for change in changes:
            told = self._when_set.get(change.name)
            if told is not None:
                told()

    def when_set(self, name: str, callback: Callable[[], None]) -> None:
        """Call each time a live parameter was set, in the thread that set it, once its value is the new one."""
        self._when_set[name] = self.guarded(callback)

    @property
    def settled(self) -> bool:
        """The node has read its parameters."""
        return False

    def value(self, name: str) -> Any:
        """Current value of a parameter."""
        return self.get_parameter(name).value

    def guarded(self, callback: Callable[..., None], name: str = "") -> Callable[..., None]:
        """A callback that reports what went wrong instead of ending the node.

        The next call that goes well takes the error back, where the node has said nothing else of itself since.

        Args:
            callback: What is called.
            name: Calls under the same name take each other's errors back; empty: only those of what is returned.
        """
        key: object = name or object()

        def call(*args: Any) -> None:
            try:
                callback(*args)
            except DoormillError as error:
                self._tell_failure(key, error.message, error_code=error.code)
                self.get_logger().error(error.message)
            except Exception as error:
                if not self.context.ok():  # interrupted: nothing can be published any more
                    return
                self._tell_failure(key, unexpected(error))
                self.get_logger().error(traceback.format_exc())
            else:
                if key in self._failures:
                    self._take_back(key)

        return call

    def _tell_failure(self, key: object, message: str, **values: Any) -> None:
        with self._telling:
            others = {other: told for other, told in self._failures.items() if other is not key}
            otherwise = self._otherwise if self._failures else self._health
            self.report(ERROR, message, **values)
            self._failures, self._otherwise = {**others, key: self._health}, otherwise

    def _take_back(self, key: object) -> None:
        """Say what would be said had this callback not failed: the error of another one stays."""
        with self._telling:
            if self._failures.pop(key, None) is None:
                return
            left = self._failures
            level, message, values = [self._otherwise, *left.values()][-1]
            self.report(level, message, **values)
            self._failures = left

    @property
    def heard(self) -> bool:
        """Whether what it tells reaches somebody."""
        return bool(self.context.ok())

    def as_refusal(self, error: Exception) -> DoormillError:
        """What is said under a run of whatever went wrong; what nobody thought of is logged in full."""
        if isinstance(error, DoormillError):
            return error
        if self.heard:  # else it is the way out that it met
            self.get_logger().error("".join(traceback.format_exception(error)))
        return DoormillError(
            f"{unexpected(error)}; see the log of {self.get_name()} and start the door again"
        )

    def answering(self, callback: Callable[[Any, Any], Any]) -> Callable[[Any, Any], Any]:
        """A service's callback whose errors become `error_code` and `message` of the answer."""

        def answer(request: Any, response: Any) -> Any:
            try:
                return callback(request, response)
            except DoormillError as error:
                response.error_code, response.message = error.code, error.message
                self.report(WARN, error.message, error_code=error.code)
            except Exception as error:
                response.error_code = DoormillError.code
                response.message = f"{unexpected(error)}; see the log of {self.get_name()}"
                self.report(ERROR, response.message)
                self.get_logger().error(traceback.format_exc())
            return response

        return answer

    def attempt(self, what: str, action: Callable[[], None]) -> bool:
        """Do something that may fail; False when it did, which is then reported and logged once."""
        try:
            action()
        except DoormillError as error:
            message, values = error.message, {"error_code": error.code}
        except Exception as error:
            if isinstance(error, _GONE) and not self.context.ok():
                return False  # the way out, no fault
            message, values = f"{type(error).__name__}: {error}", {}
            self.get_logger().error(traceback.format_exc())
        else:
            return True
        if self._health[1] != f"could not {what}: {message}":
            self.get_logger().error(f"could not {what}: {message}")
        self.report(ERROR, f"could not {what}: {message}", **values)
        return False

    def report(self, level: bytes, message: str, **values: Any) -> None:
        """Set what the node says of itself on /diagnostics.

        What is not well, or well again, is published at once; a healthy node's news wait for the next round:
        each message wakes every process that listens, in the middle of a run.
        """
        with self._telling:
            self._failures = {}
            healthy = level == OK and self._health[0] == OK
            message = one_line(message)
            changed = (level, message) != self._health[:2]
            self._health = (level, message, values)
            if changed and not healthy:
                self._publish_diagnostics()

    def later(self, name: str, callback: Callable[[], None]) -> None:
        """Call once, a moment from now; one that still waits under the same name gives way.

        For what only people look at: drawn at once, it would take a core from the run in hand.
        """
        self._due[name] = self.guarded(callback, f"later {name}")
        timer = self._later.get(name)
        if timer is None:
            # Kept for the next time: a callback group never forgets what was made in it, destroyed or not.
            made = self.create_timer(DISPLAY_DELAY, lambda: self._call_due(name))
            if self._later.setdefault(name, made) is not made:  # another thread was first
                self.destroy_timer(made)
            return
        timer.reset()
        if self.executor is not None:
            self.executor.wake()

    def _call_due(self, name: str) -> None:
        # In this order: what another thread leaves meanwhile is called now, or sets the timer again.
        timer = self._later.get(name)
        if timer is not None:
            timer.cancel()
        call = self._due.pop(name, None)
        if call is not None:
            call()

    def forget_later(self) -> None:
        """Call nothing any more of what was to be called later."""
        self._due.clear()
        while self._later:
            self.destroy_timer(self._later.popitem()[1])

    def _publish_diagnostics(self) -> None:
        if not self.context.ok():
            return
        name, stamp = self.get_fully_qualified_name(), self.get_clock().now().to_msg()
        self._diagnostics.publish(diagnostics(name, *self._health, stamp))


def _with_events(arguments: dict[str, Any], events: Any) -> dict[str, Any]:
    """The arguments with these events, where they name none."""
    return arguments if arguments.get("event_callbacks") else {**arguments, "event_callbacks": events}
