"""Interrupts of a RAPID program: what is connected, what was ordered, the queue, and running traps.

Sources are pages of "RAPID Reference Manual, Basic Characteristics", yumpu.com 5679047; [?] marks what was not
seen, docs/rapid.md names its manual.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field

from doormill_ros.simulation.controller.rapid.faults import RapidFault, RapidStop, error_name
from doormill_ros.simulation.controller.rapid.machine import Machine
from doormill_ros.simulation.controller.rapid.scope import Reference, RoutineInfo

#: Interrupts that may be connected at a time [?]; the RAPID overview has 100, the stricter is taken.
LARGEST_NUMBER = 70
#: Time between an event and its trap: of 5 to 120 ms (page 111) the longest while the robot is moved
#: by the instruction that is executed, the shortest otherwise [s].
DELAY_MOVING, DELAY = 0.12, 0.005


@dataclass(eq=False)
class Interrupt:
    """An interrupt number that is connected to a trap.

    Attributes:
        number: The value of its intnum.
        trap: The routine.
        occurred: Whether its event has occurred since it was last asked; None before it was ordered.
        single: It is deleted from the orders with its first event.
        asleep: ISleep: its events are disregarded.
    """

    number: int
    trap: RoutineInfo
    occurred: Callable[[], bool] | None = None
    single: bool = False
    asleep: bool = False


@dataclass(eq=False)
class Interrupts:
    """All interrupts of a task.

    Attributes:
        machine: Where the time comes from.
        intno: INTNO, as the list of one that the symbol refers to.
        queue: Events whose traps are still to be run, first in first out (page 111), with the time
            from which they may [s].
        in_motion: Nested motion instructions whose end the program waits for.
        held_back: While it is set no trap runs; what is in the queue stays there.
    """

    machine: Machine
    intno: list[float] = field(default_factory=lambda: [0.0])
    queue: list[tuple[Interrupt, float]] = field(default_factory=list)
    in_motion: int = 0
    held_back: bool = False
    _connected: dict[int, Interrupt] = field(default_factory=dict)
    _numbers: int = 0
    _disabled: bool = False
    _in_trap: bool = False

    def clear(self) -> None:
        """Forget everything, as moving the program pointer to main does."""
        self._connected.clear()
        self.queue.clear()
        self.intno[0] = 0.0
        self._disabled = self._in_trap = False
        self.in_motion = 0

    # What the instructions do

    def connect(self, place: Reference, trap: RoutineInfo) -> None:
        """CONNECT: give the variable a number of its own.

        Raises:
            RapidFault: ERR_ALRDYCNT for a variable that is connected, ERR_INOMAX for one too many.
        """
        if int(place[0][place[1]]) in self._connected:
            raise RapidFault("ERR_ALRDYCNT", f"CONNECT: the interrupt is connected to {trap.name} already")
        if len(self._connected) >= LARGEST_NUMBER:
            raise RapidFault("ERR_INOMAX", f"CONNECT: more than {LARGEST_NUMBER} interrupts")
        self._numbers += 1
        place[0][place[1]] = float(self._numbers)
        self._connected[self._numbers] = Interrupt(self._numbers, trap)

    def order(self, what: str, number: float, occurred: Callable[[], bool], single: bool) -> None:
        """ISignalDI and its kin: say what triggers an interrupt.

        Args:
            what: The instruction, for messages.
            number: The intnum.
            occurred: Whether the event has occurred since it was last asked.
            single: Only its first occurrence counts.

        Raises:
            RapidFault: ERR_UNKINO for a number that is not connected.
            RapidStop: It is ordered already: delete it first [?].
        """
        interrupt = self._find(what, number)
        if interrupt.occurred is not None:
            raise RapidStop(
                f"{what}: the interrupt is ordered already, allowed is one that was deleted before"
            )
        interrupt.occurred, interrupt.single, interrupt.asleep = occurred, single, False

    def delete(self, number: float) -> None:
        """IDelete: cancel the order and the connection; a number that is not connected is none's loss [?]."""
        interrupt = self._connected.pop(int(number), None)
        self.queue[:] = [item for item in self.queue if item[0] is not interrupt]

    def set_asleep(self, what: str, number: float, asleep: bool) -> None:
        """ISleep and IWatch of one interrupt; what occurs between them is disregarded (page 51).

        Raises:
            RapidFault: ERR_UNKINO for a number that is not connected.
        """
        self._find(what, number).asleep = asleep

    def disable(self, disabled: bool) -> None:
        """IDisable and IEnable: what occurs between them is queued (page 111)."""
        self._disabled = disabled

    def _find(self, what: str, number: float) -> Interrupt:
        found = self._connected.get(int(number))
        if found is None:
            raise RapidFault("ERR_UNKINO", f"{what}: the interrupt is not connected: CONNECT it first")
        return found

    # What happens as time passes

    @property
    def armed(self) -> bool:
        """Whether an event may occur or a trap is waiting."""
        if self.queue:
            return True
        for interrupt in self._connected.values():  # noqa: SIM110  # asked with every step of time
            if interrupt.occurred is not None:
                return True
        return False

    def discard(self) -> None:
        r"""Forget what waits for its trap and what occurs until now, as a program that stands does.

        RAPID overview, 3HAC050947-001, Interrupts: a stop empties the queue, what occurs meanwhile is not dealt with.
        Of `\SingleSafe` too, the harsher reading.
        """
        for interrupt in self._connected.values():
            if interrupt.occurred is not None:
                interrupt.occurred()
        self.queue.clear()

    def poll(self) -> None:
        """Look whether events have occurred."""
        for interrupt in list(self._connected.values()):
            if interrupt.occurred is None or not interrupt.occurred() or interrupt.asleep:
                continue
            delay = DELAY_MOVING if self.in_motion else DELAY
            self.queue.append((interrupt, self.machine.now() + delay))
            if interrupt.single:
                interrupt.occurred = None

    def attend(self) -> None:
        """To be called whenever time has passed: poll, and run the traps that are due.

        Raises:
            RapidStop: The program ends in a trap, or an error leaves one.
        """
        if self._connected:
            self.poll()
            self.serve()

    def serve(self) -> None:
        """Run the traps that are due; a trap is not interrupted (page 111)."""
        while self.queue and self.queue[0][1] <= self.machine.now():
            if self._disabled or self._in_trap or self.held_back:
                return
            self._run(self.queue.pop(0)[0])

    def _run(self, interrupt: Interrupt) -> None:
        saved, self.in_motion = (self.intno[0], self.in_motion), 0
        self._in_trap = True
        self.intno[0] = float(interrupt.number)
        try:
            interrupt.trap.run([])
        except RapidFault as fault:
            # An error that leaves a trap ends the execution (page 110).
            stop = RapidStop(
                f"{error_name(fault.number)}: {fault.reason}, and it left trap {interrupt.trap.name}"
            )
            stop.file, stop.line = fault.file, fault.line
            raise stop from None
        finally:
            self._in_trap = False
            self.intno[0], self.in_motion = saved

    @contextmanager
    def moving(self) -> Iterator[None]:
        """While a motion instruction is executed."""
        self.in_motion += 1
        try:
            yield
        finally:
            self.in_motion = max(self.in_motion - 1, 0)
