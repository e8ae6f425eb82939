"""Signals and waiting for them."""

from __future__ import annotations

from collections.abc import Callable

from doormill_ros.simulation.controller.rapid.faults import RapidFault
from doormill_ros.simulation.controller.rapid.library.predefined import predefined
from doormill_ros.simulation.controller.rapid.scope import Context, Reference


@predefined("PROC SetDO(\\num SDelay \\switch Sync, signaldo Signal, num Value)")
def set_do(context: Context, delay: float | None, _sync: bool, signal: str, value: float) -> None:
    """Set a digital output."""
    if delay:
        raise RapidFault("ERR_ARGVALERR", "SetDO \\SDelay is not simulated")
    if value not in (0.0, 1.0):
        raise RapidFault("ERR_ARGVALERR", f"SetDO {signal}: {value:g}, allowed are 0 and 1")
    context.machine.write_signal(signal, value)


@predefined("PROC Set(signaldo Signal)")
def set_(context: Context, signal: str) -> None:
    """Set a digital output to 1."""
    context.machine.write_signal(signal, 1.0)


@predefined("PROC Reset(signaldo Signal)")
def reset(context: Context, signal: str) -> None:
    """Set a digital output to 0."""
    context.machine.write_signal(signal, 0.0)


@predefined("PROC SetAO(signalao Signal, num Value)")
def set_ao(context: Context, signal: str, value: float) -> None:
    """Set an analog output."""
    context.machine.write_signal(signal, value)


@predefined("FUNC num DOutput(signaldo Signal)")
def d_output(context: Context, signal: str) -> float:
    """Value of a digital output."""
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


@predefined("PROC WaitUntil(\\switch InPos, condition Cond \\num MaxTime \\VAR bool TimeFlag \\num PollRate)")
def wait_until(
    context: Context,
    in_position: bool,
    condition: Callable[[], bool],
    seconds: float | None,
    flag: Reference | None,
    _poll_rate: float | None,
) -> None:
    """Wait until a condition holds."""
    if in_position:
        context.machine.wait_in_position()
    _wait(context, "WaitUntil", condition, seconds, flag)


@predefined("PROC WaitTime(\\switch InPos, num Time)")
def wait_time(context: Context, in_position: bool, seconds: float) -> None:
    """Wait for a time."""
    if seconds < 0.0:
        raise RapidFault("ERR_NEGARG", f"WaitTime {seconds:g}: allowed is 0 and more")
    if in_position:
        context.machine.wait_in_position()
    context.machine.wait(None, seconds)
