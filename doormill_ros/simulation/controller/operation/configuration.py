"""What the system parameters say of operation: system outputs and cross connections.

Sections SYSSIG_OUT and EIO_CROSS of EIO.cfg as in public backups of RobotWare 6 and 7 (github.com SDEBEUL/Kraker1,
panin-anan/abb_SAMXL_Grinding).
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from doormill_ros.simulation.controller.rapid.errors import SignalError

#: System outputs that are simulated, by the word of `-Status`.
STATUSES = ("AutoOn", "CycleOn", "EmStop", "MotOnState", "MotOffState", "RunchOk", "Error")
_SECTION = re.compile(r"([A-Z_]+[A-Z0-9_]*):")
_PAIR = re.compile(r'-(\w+)\s+"([^"]*)"|-(\w+)')


@dataclass(frozen=True)
class Cross:
    """A cross connection: the result follows its actors.

    Attributes:
        result: Signal that is set.
        actors: Signals, and whether each is inverted.
        operators: "AND" or "OR" between them, evaluated from left to right.
    """

    result: str
    actors: tuple[tuple[str, bool], ...]
    operators: tuple[str, ...]

    def value(self, read: Callable[[str], float]) -> float:
        """0 or 1 from the actors' values."""
        levels = [(read(name) == 1.0) != inverted for name, inverted in self.actors]
        level = levels[0]
        for operator, other in zip(self.operators, levels[1:], strict=False):
            level = (level and other) if operator == "AND" else (level or other)
        return float(level)


@dataclass(frozen=True)
class SystemOutputs:
    """What the system itself writes: status word to signal, and cross connections in their order."""

    status: Mapping[str, str]
    crosses: tuple[Cross, ...] = ()

    @cached_property
    def signals(self) -> frozenset[str]:
        """All signals that are read or written here."""
        crossed = {name for cross in self.crosses for name in (cross.result, *(a for a, _ in cross.actors))}
        return frozenset(self.status.values()) | crossed

    def update(
        self, states: Mapping[str, int], read: Callable[[str], float], write: Callable[[str, float], None]
    ) -> None:
        """Write what follows from the states and the signals."""
        for word, signal in self.status.items():
            if read(signal) != states[word]:
                write(signal, float(states[word]))
        for cross in self.crosses:
            value = cross.value(read)
            if read(cross.result) != value:
                write(cross.result, value)


def read_system_outputs(path: Path) -> SystemOutputs:
    """System outputs and cross connections of EIO.cfg.

    Raises:
        SignalError: No plain text, a status that is not simulated, or a cross connection without result or actor.
    """
    status, crosses = {}, []
    for section, keys in _entries(path):
        if section == "SYSSIG_OUT":
            if keys.get("Status") not in STATUSES or "Signal" not in keys:
                found = keys.get("Status", "nothing")
                raise SignalError(f"{path}: status {found}, allowed are {', '.join(STATUSES)} with -Signal")
            status[keys["Status"]] = keys["Signal"]
        elif section == "EIO_CROSS":
            actors = tuple(
                (keys[f"Act{n}"], f"Act{n}_invert" in keys) for n in range(1, 6) if f"Act{n}" in keys
            )
            operators = tuple(keys[f"Oper{n}"] for n in range(1, 5) if f"Oper{n}" in keys)
            if "Res" not in keys or not actors or len(operators) < len(actors) - 1:
                raise SignalError(
                    f"{path}: cross connection {keys.get('Name', '')} lacks -Res, -Act1 or -Oper1: add it"
                )
            crosses.append(Cross(keys["Res"], actors, operators))
    return SystemOutputs(status, tuple(crosses))


def _entries(path: Path) -> Iterator[tuple[str, dict[str, str]]]:
    """Section and keys of every entry; a backslash at the end of a line continues it."""
    section = ""
    try:
        content = path.read_text(encoding="ascii")
    except UnicodeDecodeError as error:
        raise SignalError(
            f"{path}: byte {error.start} is no ASCII, allowed is plain text: save it so"
        ) from error
    for line in re.sub(r"\\\s*\n", " ", content).splitlines():
        text = line.strip()
        heading = _SECTION.fullmatch(text)
        if heading is not None:
            section = heading[1]
        elif text.startswith("-"):
            yield section, {m[1] or m[3]: m[2] or "" for m in _PAIR.finditer(text)}
