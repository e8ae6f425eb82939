"""Signals of the simulated controller: who holds their values, and the spindle."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from doormill_ros.abb.signals import ALL_SIGNALS, GROUP_SIGNALS
from doormill_ros.arrays import FloatArray
from doormill_ros.simulation.controller.cabinet.io_port import IoPort
from doormill_ros.simulation.controller.cabinet.tool_rack import DRAWBAR_OPEN, DRAWBAR_RUN, GAUGE, ToolRack
from doormill_ros.simulation.controller.configuration.io_configuration import IoConfiguration
from doormill_ros.simulation.controller.rapid.errors import SignalError
from doormill_ros.simulation.controller.rapid.faults import RapidFault, RapidStop

SPINDLE_STOPPED = "diSpindleStopped"
SPINDLE_ON, SPINDLE_SPEED, SPINDLE_AT_SPEED = "doSpindleOn", "aoSpindleSpeed", "diSpindleAtSpeed"
DOOR_CLAMPED, GUARD_CLOSED = "diDoorClamped", "diGuardClosed"
_OF_THE_PORT = frozenset(ALL_SIGNALS + GROUP_SIGNALS)
#: Output to the spindle's drive, where the cell has one of its own behind a cross connection.
SPINDLE_RUN = "doSpindleRun"
_LIMITS = {"AO": "ERR_AO_LIM", "GO": "ERR_GO_LIM", "DO": "ERR_ARGVALERR"}


class SimulatedCell:
    """Holds the cell's own signals and routes those of the handshake to the port.

    Attributes:
        spindle_time: Time in which the spindle comes to speed [s].
        coasting_time: Time in which it comes to rest [s].
        spindle_drive: Output that makes the spindle turn.
        drawbar_valve: Output that opens the drawbar.
        spindle_works: False for a spindle that never comes to speed.
        rack: Drawbar, tools and gauge.
        lost: Signals of an I/O device that the controller does not reach, see `lose`.
        mark: Another object after each change of a signal that the cell itself holds, analog inputs apart: a drive
            tells another load at every moment, and nothing that the system itself writes follows one.
    """

    def __init__(
        self,
        configuration: IoConfiguration,
        port: IoPort,
        rack: ToolRack | None = None,
        flange: Callable[[], FloatArray] = lambda: np.eye(4),
    ) -> None:
        """Start with the door clamped, the guard closed and everything else at its default.

        Args:
            configuration: The signals.
            port: Who holds those of the handshake.
            rack: Drawbar, tools and gauge; None for a spindle whose tool nobody takes out.
            flange: Gives where the robot holds the spindle, T_base_flange of shape (4, 4).
        """
        self.rack = rack or ToolRack(None, lambda q: np.eye(4))
        self._flange = flange
        self.configuration = configuration
        self.kinds = configuration.kinds
        #: Signals that only change here, not in the port and not with the robot.
        self.held = frozenset(self.kinds) - _OF_THE_PORT - {GAUGE}
        self._analog = frozenset(name for name, s in configuration.signals.items() if s.type == "AI")
        self.lost: frozenset[str] = frozenset()
        self.mark = object()
        #: Mark, drawbar and tool for which its sensors say what they should.
        self._shown: tuple[object, bool, str] | None = None
        self._port = port
        self._values = {name: signal.default for name, signal in configuration.signals.items()}
        for name in (DOOR_CLAMPED, GUARD_CLOSED):
            if name in self._values:
                self._values[name] = 1.0
        self.spindle_drive = SPINDLE_RUN if SPINDLE_RUN in self._values else SPINDLE_ON
        self.drawbar_valve = DRAWBAR_RUN if DRAWBAR_RUN in self._values else DRAWBAR_OPEN
        self.spindle_time = self.coasting_time = 1.5
        self.spindle_works = True
        self._spindle_due: float | None = None
        self._rest_due: float | None = None
        self._tell(SPINDLE_STOPPED, 1.0)
        self.show_drawbar()
        self._now = 0.0
        #: Simulated time [s] at which the spindle came to speed (True) or was switched off, in order.
        self.spindle_turned: list[tuple[float, bool]] = []

    def read(self, name: str) -> float:
        """Present value of a configured signal."""
        if name in self.held:
            return self._values[name]
        self._check(name)
        if name == GAUGE:
            return self.rack.gauge(self._flange())
        return float(self._port.read(name)) if name in _OF_THE_PORT else self._values[name]

    def write(self, name: str, value: float, now: float) -> None:
        """Set an output at simulated time `now` [s], as the program does.

        Raises:
            SignalError: Not an output.
            RapidStop: Its access level does not let RAPID write it.
            RapidFault: ERR_AO_LIM, ERR_GO_LIM or ERR_ARGVALERR for a value out of range, ERR_NORUNUNIT for a
                signal of a device that is lost.
        """
        self._check(name)
        self.reach(name)
        self._now = now
        signal = self.configuration.signals[name]
        if not signal.output:
            raise SignalError(
                f"signal {name} is an input, allowed are outputs: correct the program", name=name
            )
        if "rapid" not in signal.access.writers:
            # Who may write is what an access level says, RAPID being one of them: EIO_ACCESS of public backups
            # (github.com SDEBEUL/Kraker1, panin-anan/abb_SAMXL_Grinding). No ERROR clause takes it [?].
            raise RapidStop(
                f"signal {name} has access level {signal.access.name}, which RAPID may not write: configure "
                "another one"
            )
        if not signal.lowest <= value <= signal.largest:
            raise RapidFault(
                _LIMITS[signal.type],
                f"signal {name} cannot become {value:g}, allowed is {signal.lowest:g} to {signal.largest:g}",
            )
        self._set(name, value, now)

    def force(self, name: str, value: float) -> None:
        """Set an output whatever its access level, as the system does."""
        self._check(name)
        if name not in self.lost:
            self._set(name, value, self._now)

    def lose(self, *names: str) -> None:
        """Lose the device of these signals, or none: its outputs fall, its inputs stay as they were seen last."""
        self.lost = frozenset()
        for name in names:
            if self.configuration.signals[name].output:
                self.force(name, 0.0)
        self.lost = frozenset(names)

    def reach(self, name: str) -> None:
        """What the program reads or writes.

        Raises:
            RapidFault: ERR_NORUNUNIT: the device of the signal is lost.
        """
        if name in self.lost:
            raise RapidFault("ERR_NORUNUNIT", f"signal {name}: its I/O device is lost")

    def _set(self, name: str, value: float, now: float) -> None:
        if name in _OF_THE_PORT:
            self._port.write(name, int(value))
            return
        changed = self._values[name] != value
        if changed and name == self.spindle_drive and not value:
            self.spindle_turned.append((now, False))
        self._hold(name, value)
        if changed and name == self.drawbar_valve:
            self.rack.order(now)
        if changed and name == self.spindle_drive and SPINDLE_STOPPED in self._values:
            self._hold(SPINDLE_STOPPED, 0.0)
            self._rest_due = None if value else now + self.coasting_time
        if changed and name in (self.spindle_drive, SPINDLE_SPEED) and SPINDLE_AT_SPEED in self._values:
            self._hold(SPINDLE_AT_SPEED, 0.0)
            self._spindle_due = now + self.spindle_time

    def set_input(self, name: str, value: float) -> None:
        """Set an input from outside, as the plant does."""
        self._check(name)
        self._hold(name, value)

    def next_event(self) -> float | None:
        """Simulated time at which a signal changes by itself [s], None when none will."""
        spindle = self._spindle_due if self.spindle_works else None
        rest, drawbar = self._rest_due, self.rack.next_event
        if spindle is None and rest is None and drawbar is None:
            return None
        return min(time for time in (spindle, rest, drawbar) if time is not None)

    def advance(self, now: float) -> None:
        """Let what is due happen."""
        self._now = now
        if self._spindle_due is not None and self.spindle_works and now >= self._spindle_due:
            self._hold(SPINDLE_AT_SPEED, self._values.get(self.spindle_drive, 0.0))
            self.spindle_turned.append((self._spindle_due, bool(self._values[SPINDLE_AT_SPEED])))
            self._spindle_due = None
        if self._rest_due is not None and now >= self._rest_due:
            self._rest_due = None
            self._tell(SPINDLE_STOPPED, 1.0)
        drawbar = self.rack.next_event
        if drawbar is not None and now >= drawbar:
            turning = bool(self._values.get(self.spindle_drive, 0.0)) or not self._values.get(
                SPINDLE_STOPPED, 1.0
            )
            self.rack.advance(now, bool(self._values.get(self.drawbar_valve, 0.0)), self._flange(), turning)
        self.show_drawbar()

    def show_drawbar(self) -> None:
        """Give the drawbar's sensors what the plant says."""
        mark, opened, carried = self.mark, self.rack.opened, self.rack.carried
        shown = self._shown
        if shown is not None and shown[0] is mark and shown[1] == opened and shown[2] == carried:
            return
        for name, value in self.rack.signals().items():
            self._tell(name, value)
        self._shown = mark, opened, carried

    def _tell(self, name: str, value: float) -> None:
        if self._values.get(name, value) != value:
            self._hold(name, value)

    def _hold(self, name: str, value: float) -> None:
        """Keep a value, and say so after it when it is another one than before; see `mark`."""
        changed = self._values.get(name) != value and name not in self._analog
        self._values[name] = value
        if changed:
            self.mark = object()

    def _check(self, name: str) -> None:
        if name not in self.kinds:
            raise SignalError(
                f"signal {name!r} is not configured, allowed are {', '.join(self.kinds)}", name=name
            )
