"""Signals and waiting for them."""

from __future__ import annotations

from collections.abc import Callable

from doormill_ros.simulation.controller.rapid.context import Context
from doormill_ros.simulation.controller.rapid.faults import RapidFault
from doormill_ros.simulation.controller.rapid.library.predefined import predefined
from doormill_ros.simulation.controller.rapid.scope import Reference
from doormill_ros.simulation.controller.rapid.types import is_integer

#: How often WaitUntil looks at its condition, and how often at most [s] [?]: what is shorter may be missed.
POLL_RATE, SHORTEST_POLL_RATE = 0.1, 0.04


def _write(context: Context, signal: str, value: float) -> None:
    """Set an output, and see at once whether that is an event."""
    context.machine.write_signal(signal, value)
    context.interrupts.poll()


@predefined("PROC SetDO(\\num SDelay \\switch Sync, signaldo Signal, num Value)")
def set_do(context: Context, delay: float | None, _sync: bool, signal: str, value: float) -> None:
    """Set a digital output."""
    if delay:
        raise RapidFault("ERR_ARGVALERR", "SetDO \\SDelay is not simulated")
    if value not in (0.0, 1.0):
        raise RapidFault("ERR_ARGVALERR", f"SetDO {signal}: {value:g}, allowed are 0 and 1")
    _write(context, signal, value)


@predefined("PROC Set(signaldo Signal)")
def set_(context: Context, signal: str) -> None:
    """Set a digital output to 1."""
    _write(context, signal, 1.0)


@predefined("PROC Reset(signaldo Signal)")
def reset(context: Context, signal: str) -> None:
    """Set a digital output to 0."""
    _write(context, signal, 0.0)


@predefined("PROC SetAO(signalao Signal, num Value)")
def set_ao(context: Context, signal: str, value: float) -> None:
    """Set an analog output."""
    _write(context, signal, value)


@predefined("PROC SetGO(\\num SDelay, signalgo Signal, num Value)")
def set_go(context: Context, delay: float | None, signal: str, value: float) -> None:
    """Set a group of digital outputs to a number; one that it cannot hold is ERR_GO_LIM."""
    if delay:
        raise RapidFault("ERR_ARGVALERR", "SetGO \\SDelay is not simulated")
    if not is_integer(value):
        raise RapidFault("ERR_ARGVALERR", f"SetGO {signal}: {value:g}, allowed are whole numbers")
    _write(context, signal, value)


@predefined("FUNC num GOutput(signalgo Signal)")
@predefined("FUNC num GInput(signalgi Signal)")
@predefined("FUNC num AOutput(signalao Signal)")
@predefined("FUNC num DOutput(signaldo Signal)")
def value_of(context: Context, signal: str) -> float:
    """Value of a signal; an input's can be read by its name alone too."""
    return context.machine.read_signal(signal)


@predefined("FUNC bool TestDI(signaldi Signal)")
def test_di(context: Context, signal: str) -> bool:
    """Whether a digital input is 1."""
    return context.machine.read_signal(signal) == 1.0


def _wait(
    context: Context,
    what: str,
    condition: Callable[[], bool],
    seconds: float | None,
    flag: Reference | None,
) -> None:
    """Wait; running out of time sets the flag, or is ERR_WAIT_MAXTIME without one."""
    met = context.machine.wait(condition, seconds)
    if flag is not None:
        flag[0][flag[1]] = not met
    elif not met:
        raise RapidFault("ERR_WAIT_MAXTIME", f"{what}: not within {seconds:g} s")


@predefined("PROC WaitDI(signaldi Signal, num Value \\num MaxTime \\VAR bool TimeFlag)")
def wait_di(
    context: Context, signal: str, value: float, seconds: float | None, flag: Reference | None
) -> None:
    """Wait until a digital input has a value."""
    machine = context.machine
    _wait(context, f"WaitDI {signal}", lambda: machine.read_signal(signal) == value, seconds, flag)


@predefined("PROC WaitDO(signaldo Signal, num Value \\num MaxTime \\VAR bool TimeFlag)")
def wait_do(
    context: Context, signal: str, value: float, seconds: float | None, flag: Reference | None
) -> None:
    """Wait until a digital output has a value."""
    machine = context.machine
    _wait(context, f"WaitDO {signal}", lambda: machine.read_signal(signal) == value, seconds, flag)


def _group_condition(
    context: Context, signal: str, value: float, unequal: bool, less: bool, greater: bool
) -> Callable[[], bool]:
    read = context.machine.read_signal
    if unequal:
        return lambda: read(signal) != value
    if less:
        return lambda: read(signal) < value
    if greater:
        return lambda: read(signal) > value
    return lambda: read(signal) == value


_GROUP_WAIT = (
    "\\switch NOTEQ | switch LT | switch GT, num Value "
    "\\num MaxTime \\INOUT num ValueAtTimeout \\VAR bool TimeFlag"
)


def _wait_group(
    context: Context,
    what: str,
    signal: str,
    relation: tuple[bool, bool, bool],
    value: float,
    seconds: float | None,
    at_timeout: Reference | None,
    flag: Reference | None,
) -> None:
    condition = _group_condition(context, signal, value, *relation)
    try:
        _wait(context, f"{what} {signal}", condition, seconds, flag)
    finally:
        if at_timeout is not None and not condition():
            at_timeout[0][at_timeout[1]] = context.machine.read_signal(signal)


@predefined(f"PROC WaitGI(signalgi Signal {_GROUP_WAIT})")
def wait_gi(
    context: Context,
    signal: str,
    unequal: bool,
    less: bool,
    greater: bool,
    value: float,
    seconds: float | None,
    at_timeout: Reference | None,
    flag: Reference | None,
) -> None:
    """Wait until a group of digital inputs has a value, or another relation to it."""
    _wait_group(context, "WaitGI", signal, (unequal, less, greater), value, seconds, at_timeout, flag)


@predefined(f"PROC WaitGO(signalgo Signal {_GROUP_WAIT})")
def wait_go(
    context: Context,
    signal: str,
    unequal: bool,
    less: bool,
    greater: bool,
    value: float,
    seconds: float | None,
    at_timeout: Reference | None,
    flag: Reference | None,
) -> None:
    """Wait until a group of digital outputs has a value, or another relation to it."""
    _wait_group(context, "WaitGO", signal, (unequal, less, greater), value, seconds, at_timeout, flag)


@predefined("PROC WaitUntil(\\switch InPos, condition Cond \\num MaxTime \\VAR bool TimeFlag \\num PollRate)")
def wait_until(
    context: Context,
    in_position: bool,
    condition: Callable[[], bool],
    seconds: float | None,
    flag: Reference | None,
    poll_rate: float | None,
) -> None:
    r"""Wait until a condition holds when it is looked at, which happens every \PollRate seconds."""
    machine = context.machine
    if in_position:
        machine.wait_in_position()
    every = POLL_RATE if poll_rate is None else poll_rate
    if every < SHORTEST_POLL_RATE - 1e-6:
        raise RapidFault(
            "ERR_ARGVALERR", f"WaitUntil \\PollRate {every:g} s, allowed is {SHORTEST_POLL_RATE:g} s and more"
        )
    following = [machine.now()]

    def polled() -> bool:
        now = machine.now()
        if now < following[0] - 1e-9:
            return False
        following[0] = now + every
        return condition()

    _wait(context, "WaitUntil", polled, seconds, flag)


@predefined("PROC WaitTime(\\switch InPos, num Time)")
def wait_time(context: Context, in_position: bool, seconds: float) -> None:
    """Wait for a time."""
    if seconds < 0.0:
        raise RapidFault("ERR_NEGARG", f"WaitTime {seconds:g}: allowed is 0 and more")
    if in_position:
        context.machine.wait_in_position()
    context.machine.wait(None, seconds)
