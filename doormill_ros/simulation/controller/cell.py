"""Signals of the simulated controller: what is configured, who holds the values, and the spindle."""

from __future__ import annotations

import re
from pathlib import Path

from doormill_ros.abb.signals import ALL_SIGNALS
from doormill_ros.simulation.controller.io_port import IoPort
from doormill_ros.simulation.controller.rapid.errors import SignalError

_TYPES = {"DI": "signaldi", "DO": "signaldo", "AI": "signalai", "AO": "signalao"}
_SIGNAL = re.compile(r'-Name\s+"(?P<name>[^"]+)"[^-]*-SignalType\s+"(?P<type>[A-Z]+)"')
_LIMIT = re.compile(r"-MaxLog\s+([\d.]+)")

SPINDLE_ON, SPINDLE_SPEED, SPINDLE_AT_SPEED = "doSpindleOn", "aoSpindleSpeed", "diSpindleAtSpeed"
DOOR_CLAMPED = "diDoorClamped"


def read_io_configuration(path: Path) -> tuple[dict[str, str], dict[str, float]]:
    r"""Signals of a controller's I/O configuration file.

    Args:
        path: EIO.cfg; a backslash at the end of a line continues it.

    Returns:
        Name to RAPID type, and name to the largest value of the analog ones.

    Raises:
        SignalError: No signal in it, or one of a type that is not simulated.
    """
    text = re.sub(r"\\\s*\n", " ", path.read_text(encoding="ascii"))
    kinds, limits = {}, {}
    for line in text.splitlines():
        match = _SIGNAL.search(line)
        if match is None:
            continue
        if match["type"] not in _TYPES:
            raise SignalError(
                f"{path}: signal {match['name']} is {match['type']}, allowed are {', '.join(_TYPES)}"
            )
        kinds[match["name"]] = _TYPES[match["type"]]
        limit = _LIMIT.search(line)
        if limit is not None:
            limits[match["name"]] = float(limit[1])
    if not kinds:
        raise SignalError(f"{path} configures no signal, allowed is at least one: check the file")
    return kinds, limits


class SimulatedCell:
    """Holds the cell's own signals and routes those of the handshake to the port.

    Attributes:
        spindle_time: Time in which the spindle comes to speed or to rest [s].
        spindle_works: False for a spindle that never comes to speed.
    """

    def __init__(self, kinds: dict[str, str], limits: dict[str, float], port: IoPort) -> None:
        """Start with the door clamped and everything else low."""
        self.kinds = kinds
        self._limits = limits
        self._port = port
        self._values = dict.fromkeys(kinds, 0.0)
        if DOOR_CLAMPED in self._values:
            self._values[DOOR_CLAMPED] = 1.0
        self.spindle_time = 1.5
        self.spindle_works = True
        self._spindle_due: float | None = None

    def read(self, name: str) -> float:
        """Present value of a configured signal."""
        self._check(name)
        return float(self._port.read(name)) if name in ALL_SIGNALS else self._values[name]

    def write(self, name: str, value: float, now: float) -> None:
        """Set an output at simulated time `now` [s].

        Raises:
            SignalError: Not an output, or a value out of range.
        """
        self._check(name)
        kind = self.kinds[name]
        if kind not in ("signaldo", "signalao"):
            raise SignalError(
                f"signal {name} is an input, allowed are outputs: correct the program", name=name
            )
        largest = self._limits.get(name, 1.0 if kind == "signaldo" else float("inf"))
        if not 0.0 <= value <= largest:
            raise SignalError(
                f"signal {name} cannot become {value:g}, allowed is 0 to {largest:g}", name=name
            )
        if name in ALL_SIGNALS:
            self._port.write(name, int(value))
            return
        changed = self._values[name] != value
        self._values[name] = value
        if changed and name in (SPINDLE_ON, SPINDLE_SPEED) and SPINDLE_AT_SPEED in self._values:
            self._values[SPINDLE_AT_SPEED] = 0.0
            self._spindle_due = now + self.spindle_time

    def set_input(self, name: str, value: float) -> None:
        """Set an input from outside, as the plant does."""
        self._check(name)
        self._values[name] = value

    def next_event(self) -> float | None:
        """Simulated time at which a signal changes by itself [s], None when none will."""
        return self._spindle_due if self.spindle_works else None

    def advance(self, now: float) -> None:
        """Let what is due happen."""
        if self._spindle_due is not None and self.spindle_works and now >= self._spindle_due:
            self._values[SPINDLE_AT_SPEED] = self._values.get(SPINDLE_ON, 0.0)
            self._spindle_due = None

    def _check(self, name: str) -> None:
        if name not in self.kinds:
            raise SignalError(
                f"signal {name!r} is not configured, allowed are {', '.join(self.kinds)}", name=name
            )
