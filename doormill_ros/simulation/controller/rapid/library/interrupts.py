"""Instructions that order interrupts and control them; CONNECT is part of the language.

Page numbers are those of "RAPID Reference Manual, Basic Characteristics", yumpu.com 5679047.
"""

from __future__ import annotations

from collections.abc import Callable

from doormill_ros.simulation.controller.rapid.context import Context
from doormill_ros.simulation.controller.rapid.faults import RapidFault
from doormill_ros.simulation.controller.rapid.library.predefined import predefined
from doormill_ros.simulation.controller.rapid.scope import Reference
from doormill_ros.simulation.controller.rapid.types import AnyType, Value, copy

#: Shortest time of an interrupt that comes again and again, and of a single one [s] [?].
SHORTEST_CYCLE, SHORTEST_TIME = 0.1, 0.01
_ONCE = "\\switch Single | switch SingleSafe"


def _edge(context: Context, signal: str, trigger: float | None) -> Callable[[], bool]:
    """A change of a signal to a value, or any change with None; its value when ordered is no event.

    A signal whose device is lost changes no more [?], the harsher reading.
    """
    read = context.machine.read_signal
    last = [read(signal)]

    def occurred() -> bool:
        try:
            value, before = read(signal), last[0]
        except RapidFault:
            return False
        last[0] = value
        return value != before and (trigger is None or value == trigger)

    return occurred


def _order_digital(
    context: Context, what: str, single: bool, signal: str, trigger: float, interrupt: Reference
) -> None:
    if trigger not in (0.0, 1.0, 2.0):
        raise RapidFault("ERR_ARGVALERR", f"{what} {signal}: {trigger:g}, allowed are low, high and edge")
    occurred = _edge(context, signal, None if trigger == 2.0 else trigger)
    context.interrupts.order(what, interrupt[0][interrupt[1]], occurred, single)


@predefined(
    "PROC ISignalDI(\\switch Single | switch SingleSafe, signaldi Signal, num TriggValue, VAR intnum Interrupt)"
)
def i_signal_di(
    context: Context, single: bool, safe: bool, signal: str, trigger: float, interrupt: Reference
) -> None:
    """Interrupt when a digital input changes to a value."""
    _order_digital(context, "ISignalDI", single or safe, signal, trigger, interrupt)


@predefined(
    "PROC ISignalDO(\\switch Single | switch SingleSafe, signaldo Signal, num TriggValue, VAR intnum Interrupt)"
)
def i_signal_do(
    context: Context, single: bool, safe: bool, signal: str, trigger: float, interrupt: Reference
) -> None:
    """Interrupt when a digital output changes to a value."""
    _order_digital(context, "ISignalDO", single or safe, signal, trigger, interrupt)


@predefined(f"PROC ISignalGI({_ONCE}, signalgi Signal, VAR intnum Interrupt)")
def i_signal_gi(context: Context, single: bool, safe: bool, signal: str, interrupt: Reference) -> None:
    """Interrupt when a group of digital inputs changes."""
    occurred = _edge(context, signal, None)
    context.interrupts.order("ISignalGI", interrupt[0][interrupt[1]], occurred, single or safe)


@predefined(f"PROC ISignalGO({_ONCE}, signalgo Signal, VAR intnum Interrupt)")
def i_signal_go(context: Context, single: bool, safe: bool, signal: str, interrupt: Reference) -> None:
    """Interrupt when a group of digital outputs changes."""
    occurred = _edge(context, signal, None)
    context.interrupts.order("ISignalGO", interrupt[0][interrupt[1]], occurred, single or safe)


@predefined(f"PROC ITimer({_ONCE}, num Time, VAR intnum Interrupt)")
def i_timer(context: Context, single: bool, safe: bool, seconds: float, interrupt: Reference) -> None:
    """Interrupt when a time is over, once or again and again."""
    once = single or safe
    shortest = SHORTEST_TIME if once else SHORTEST_CYCLE
    if seconds < shortest - 1e-9:
        raise RapidFault("ERR_ARGVALERR", f"ITimer {seconds:g} s, allowed is {shortest:g} s and more")
    due = [context.machine.now() + seconds]

    def occurred() -> bool:
        if context.machine.now() < due[0]:
            return False
        due[0] += seconds
        return True

    context.interrupts.order("ITimer", interrupt[0][interrupt[1]], occurred, once)


@predefined(f"PROC IPers({_ONCE}, PERS anytype Name, VAR intnum Interrupt)")
def i_pers(
    context: Context, single: bool, safe: bool, place: tuple[list[Value], int, AnyType], interrupt: Reference
) -> None:
    """Interrupt when persistent data change."""
    container, index, _ = place
    last = [copy(container[index])]

    def occurred() -> bool:
        changed: bool = container[index] != last[0]
        if changed:
            last[0] = copy(container[index])
        return changed

    context.interrupts.order("IPers", interrupt[0][interrupt[1]], occurred, single or safe)


@predefined("PROC IDelete(VAR intnum Interrupt)")
def i_delete(context: Context, interrupt: Reference) -> None:
    """Cancel an interrupt; its variable may then be connected again."""
    context.interrupts.delete(interrupt[0][interrupt[1]])


@predefined("PROC ISleep(VAR intnum Interrupt)")
def i_sleep(context: Context, interrupt: Reference) -> None:
    """Disregard an interrupt until IWatch (page 51)."""
    context.interrupts.set_asleep("ISleep", interrupt[0][interrupt[1]], True)


@predefined("PROC IWatch(VAR intnum Interrupt)")
def i_watch(context: Context, interrupt: Reference) -> None:
    """Regard an interrupt again after ISleep."""
    context.interrupts.set_asleep("IWatch", interrupt[0][interrupt[1]], False)


@predefined("PROC IDisable()")
def i_disable(context: Context) -> None:
    """Put all interrupts into the queue until IEnable (page 111)."""
    context.interrupts.disable(True)


@predefined("PROC IEnable()")
def i_enable(context: Context) -> None:
    """Run what was put into the queue, and what comes."""
    context.interrupts.disable(False)
