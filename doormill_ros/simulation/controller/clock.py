"""Simulated time: what passes in it, who is asked while it does, and waiting."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from doormill_ros.simulation.controller.cabinet.cell import GUARD_CLOSED, SPINDLE_AT_SPEED, SimulatedCell
from doormill_ros.simulation.controller.motion import LONGEST_STEP, MotionEngine
from doormill_ros.simulation.controller.operation.configuration import SystemOutputs
from doormill_ros.simulation.controller.operation.panel import ControlPanel
from doormill_ros.simulation.controller.operation.states import OperatingMode
from doormill_ros.simulation.controller.rapid.errors import RapidStoppedError
from doormill_ros.simulation.controller.rapid.machine import Attendant
from doormill_ros.simulation.controller.records.recording import Surroundings

#: So often is looked for interrupts while time passes [s].
INTERRUPT_STEP = 0.01
#: So much time passes at least, lest a motion without length keeps everything waiting [s].
SHORTEST_STEP = 1e-6


@dataclass(frozen=True)
class Pace:
    """How simulated time goes with the world around it.

    Attributes:
        time_scale: Simulated over real seconds for motions; None for as fast as possible.
        patience: Longest wait for a signal [s] before the program is stopped; None for ever.
        on_wait: Called again and again while the program waits; then simulated time no longer follows the
            wall clock.
        on_stopped: The same while the program stands; it is the operator's turn.
        on_time: Called whenever time has passed.
    """

    time_scale: float | None = None
    patience: float | None = None
    on_wait: Callable[[], None] | None = None
    on_stopped: Callable[[], None] | None = None
    on_time: Callable[[], None] | None = None


class ControllerClock:
    """Lets time pass for the robot, the cell and everybody who watches them.

    Attributes:
        react: Called after each step, for orders that the panel took.
        attendant: Looks for interrupts; only while `attended`.
        system: What the system itself writes.
    """

    def __init__(self, engine: MotionEngine, cell: SimulatedCell, panel: ControlPanel, pace: Pace) -> None:
        """Start at 0."""
        self._engine, self._cell, self._panel, self._pace = engine, cell, panel, pace
        self._end = threading.Event()
        self.react: Callable[[], None] = lambda: None
        self.attendant: Attendant | None = None
        self.attended = True
        self.system = SystemOutputs({})
        #: Marks of panel and cell and the system outputs for which nothing is left to be written.
        self._settled: tuple[object, object, SystemOutputs] | None = None
        #: Marks of panel and cell, the tool and its length that the surroundings are of.
        self._seen: tuple[object, object, str, float] | None = None
        self._look()

    def now(self) -> float:
        """Simulated time [s]."""
        return self._engine.time

    def end(self) -> None:
        """End everything at the next step; from any thread."""
        self._end.set()

    def step(self, seconds: float, pace: bool = True) -> None:
        """One step of time, as long as nothing changes within it.

        Raises:
            RapidStoppedError: `end` was called.
        """
        if self._end.is_set():
            raise RapidStoppedError("the program was stopped from outside")
        engine = self._engine
        step = max(min(seconds, LONGEST_STEP, self._panel.next_order_time() - engine.time), SHORTEST_STEP)
        self._sync()
        engine.advance(step)
        self._cell.advance(engine.time)
        if pace and self._pace.time_scale:
            time.sleep(step / self._pace.time_scale)
        if self._pace.on_time is not None:
            self._pace.on_time()
        self._panel.give_due_orders(engine.time)
        self._sync()

    def pass_time(self, seconds: float) -> None:
        """Let time pass while the program runs."""
        engine = self._engine
        end = engine.time + seconds
        while True:
            armed = self.attended and self.attendant is not None and self.attendant.armed
            left = end - engine.time
            self.step(min(left, INTERRUPT_STEP) if armed else left)
            self.react()
            if armed and self.attendant is not None:
                self.attendant.attend()
            if engine.time >= end - 1e-12:
                return

    def wait(self, condition: Callable[[], bool] | None, seconds: float | None) -> bool:
        """Let time pass until the condition holds or the seconds are over.

        Raises:
            RapidStoppedError: It takes longer than `patience`.
        """
        engine = self._engine
        end = np.inf if seconds is None else engine.time + seconds
        waited = 0.0
        while condition is None or not condition():
            left = end - engine.time
            if left <= 0.0:
                return False
            if condition is None:
                self.pass_time(min(left, engine.until_next() or left))
                continue
            before = engine.time
            self._wait_a_little(left)
            waited += engine.time - before
            if self._pace.patience is not None:
                self._lose_patience(waited, "for a signal")
        return True

    def go_on_until(self, reached: Callable[[], bool]) -> None:
        """Let the robot move until its path is so far; a stopped one stays there until it is started."""
        while not reached():
            if self._engine.moving:
                self.pass_time(max(self._engine.until_next(), SHORTEST_STEP))
            else:
                self.wait(lambda: self._engine.moving or reached(), None)

    def settle(self) -> None:
        """Let a robot that is being stopped come to rest; nobody is asked meanwhile."""
        while self._engine.moving:
            self.step(max(self._engine.until_next(), SHORTEST_STEP))

    def stand(self, stood: float) -> float:
        """One step of time while the program stands; gives the time that passed [s].

        Args:
            stood: How long it has stood [s].
        """
        before = self.now()
        operator = self._pace.on_stopped or self._pace.on_wait
        if operator is not None:
            self.step(0.02)
            operator()
        else:
            self._follow_the_wall_clock(np.inf)
        self._lose_patience(stood, "for a start")
        return self.now() - before

    def _lose_patience(self, waited: float, what: str) -> None:
        patience = self._pace.patience
        if patience is not None and waited > patience:
            raise RapidStoppedError(
                f"the program waited {waited:.1f} s {what}, allowed are {patience:g} s: "
                "check the other side of the handshake"
            )

    def _wait_a_little(self, left: float) -> None:
        """One step of waiting for a condition."""
        if self._engine.moving:
            self.pass_time(min(left, self._engine.until_next(), 0.01) or SHORTEST_STEP)
            return
        event = self._cell.next_event()
        if event is not None:
            self.pass_time(min(left, max(event - self.now(), 0.0)))
        elif self._pace.on_wait is not None:
            self.pass_time(min(left, 0.01))
            self._pace.on_wait()
        else:
            self._follow_the_wall_clock(left)
            self.react()
            if self.attended and self.attendant is not None:
                self.attendant.attend()

    def _follow_the_wall_clock(self, left: float) -> None:
        start = time.perf_counter()
        time.sleep(0.001)
        elapsed = (time.perf_counter() - start) * (self._pace.time_scale or 1.0)
        self.step(min(left, elapsed), pace=False)

    def _sync(self) -> None:
        """Give the motion what panel and cell say; without effect while neither has changed.

        The marks are taken before anything is read: what changes meanwhile is seen the next time.
        """
        system, panel, cell = self.system, self._panel.mark, self._cell.mark
        settled = self._settled
        if settled is None or settled[0] is not panel or settled[1] is not cell or settled[2] is not system:
            self._settle_signals()
            # Signals that others hold may change without a mark, and have to be read each time.
            self._settled = (panel, cell, system) if system.signals <= self._cell.held else None
            self._look()
            return
        rack, seen = self._cell.rack, self._seen
        if (
            seen is None
            or seen[0] is not panel
            or seen[1] is not cell
            or seen[2] != rack.carried
            or seen[3] != rack.longer
        ):
            self._look()

    def _settle_signals(self) -> None:
        """Write what follows from the panel, and from other signals."""
        state = self._panel.state
        rules = self._engine.rules
        manual = state.mode is OperatingMode.MANUAL_REDUCED
        speeds = (state.speed_override / 100.0, rules.limits.manual_speed if manual else np.inf)
        if speeds != (rules.override, rules.tool_speed):
            rules.override, rules.tool_speed = speeds
            self._engine.update_speed()
        if GUARD_CLOSED in self._cell.kinds:
            self._cell.set_input(GUARD_CLOSED, float(self._panel.guard_closed))
        if state.powered:
            self.system.update(self._panel.system_outputs(), self._cell.read, self._cell.force)

    def _look(self) -> None:
        """Let samples say how spindle, guard and tool are now."""
        rack, panel, cell = self._cell.rack, self._panel.mark, self._cell.mark
        carried, longer = rack.carried, rack.longer
        self._seen = panel, cell, carried, longer
        self._engine.surroundings = Surroundings(
            self._level(self._cell.spindle_drive),
            self._level(SPINDLE_AT_SPEED),
            self._panel.guard_closed,
            carried,
            longer,
        )

    def _level(self, name: str) -> bool:
        return name in self._cell.kinds and self._cell.read(name) == 1.0
