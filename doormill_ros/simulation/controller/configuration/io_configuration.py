"""The I/O configuration of a controller, EIO.cfg: signals, who may write them, their limits.

Sections and keys as in public backups and parsers of RobotWare 6 and 7 (github.com SDEBEUL/Kraker1,
rpiRobotics/abb_motion_program_exec, panin-anan/abb_SAMXL_Grinding). A key that is not among them is
refused, where a controller would refuse to load the file.
"""

from __future__ import annotations

import re
import shlex
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from doormill_ros.abb.errors import AbbError
from doormill_ros.simulation.controller.configuration.cfg_lines import entries, lines_of
from doormill_ros.simulation.controller.rapid.errors import SignalError

#: RAPID type of each type of signal.
KINDS = {
    "DI": "signaldi", "DO": "signaldo", "AI": "signalai", "AO": "signalao", "GI": "signalgi", "GO": "signalgo",
}  # fmt: skip
#: Bits that a group holds at most.
LARGEST_GROUP = 32
NAME_LENGTH, LABEL_LENGTH = 32, 80
SAFE_LEVELS = ("DefaultSafeLevel", "SafetySafeLevel")

_HEADER = re.compile(r"EIO:CFG_1\.0:([67]):\d+:[^:]*:?")
_SECTION = re.compile(r"((?:EIO|SYSSIG|INDUSTRIAL|DEVICENET|PROFINET|PROFIBUS|ETHERNETIP|UNIT)_[A-Z_]+):")
_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]*")
_TEXTS = {"Name", "SignalType", "Device", "DeviceMap", "Label", "Category", "Access", "SafeLevel", "EncType"}
_NUMBERS = {
    "Default", "FiltPas", "FiltAct", "MaxLog", "MaxPhys", "MaxPhysLimit", "MaxBitVal", "MinLog", "MinPhys",
    "MinPhysLimit", "MinBitVal", "Size",
}  # fmt: skip
_FLAGS = {"Invert"}
_ACCESS = {
    "Rapid": "rapid", "LocalManual": "local_manual", "LocalAuto": "local_auto",
    "RemoteManual": "remote_manual", "RemoteAuto": "remote_auto",
}  # fmt: skip


@dataclass(frozen=True)
class SignalAccess:
    """Who may write a signal.

    Attributes:
        name: As `-Access` names it.
        writers: Of "rapid", "local_manual", "local_auto" (pendant), "remote_manual" and "remote_auto"
            (network clients).
    """

    name: str
    writers: frozenset[str]


#: The levels that every controller has; ReadOnly and Internal leave no writer but the system.
ACCESS_LEVELS = {
    "Default": SignalAccess("Default", frozenset({"rapid", "local_manual"})),
    "All": SignalAccess("All", frozenset(_ACCESS.values())),
    "ReadOnly": SignalAccess("ReadOnly", frozenset()),
    "Internal": SignalAccess("Internal", frozenset()),
}


@dataclass(frozen=True)
class SignalConfiguration:
    """One signal.

    Attributes:
        name: As RAPID knows it.
        type: "DI", "DO", "AI", "AO", "GI" or "GO".
        access: Who may write it.
        lowest: Smallest value.
        largest: Largest value.
        label: Text for people.
        default: Value after the controller was switched on, as far as `safe_level` says so.
        safe_level: "SafetySafeLevel" sets the default value when the power comes back.
    """

    name: str
    type: str
    access: SignalAccess
    lowest: float = 0.0
    largest: float = 1.0
    label: str = ""
    default: float = 0.0
    safe_level: str = "DefaultSafeLevel"

    @property
    def kind(self) -> str:
        """Its RAPID type."""
        return KINDS[self.type]

    @property
    def output(self) -> bool:
        """Whether the controller sets it."""
        return self.type in ("DO", "AO", "GO")


@dataclass(frozen=True)
class IoConfiguration:
    """All signals of a controller by name; `version` is 6 or 7 as RobotWare counts."""

    version: int
    signals: dict[str, SignalConfiguration] = field(default_factory=dict)

    @property
    def kinds(self) -> dict[str, str]:
        """Name to RAPID type."""
        return {name: signal.kind for name, signal in self.signals.items()}

    @property
    def safe_outputs(self) -> frozenset[str]:
        """Outputs that return to their default value after a loss of power, `-SafeLevel "SafetySafeLevel"`."""
        found = (s for s in self.signals.values() if s.output and s.safe_level == "SafetySafeLevel")
        return frozenset(signal.name for signal in found)


def read_io_configuration(path: Path) -> IoConfiguration:
    r"""Read EIO.cfg; a backslash at the end of a line continues it.

    Raises:
        SignalError: No signal in it, or anything that a controller would not take; names the line.
    """
    lines = lines_of(path, SignalError)
    header = _HEADER.fullmatch(lines[0].strip()) if lines else None
    if header is None:
        raise _refuse(
            path, 1, f"found {lines[0] if lines else 'nothing'!r}", "EIO:CFG_1.0:6:1:: or ...:7:0::"
        )
    levels, entries = dict(ACCESS_LEVELS), []
    safe_levels = set(SAFE_LEVELS)
    for line, section, keys in _entries(path, lines[1:]):
        if section == "EIO_ACCESS":
            level = _level(path, line, keys)
            levels[level.name] = level
        elif section == "EIO_SIGNAL_SAFELEVEL":
            safe_levels.add(keys.get("Name") or "")
        elif section == "EIO_SIGNAL":
            entries.append((line, keys))
    signals: dict[str, SignalConfiguration] = {}
    for line, keys in entries:
        signal = _Reader(path, line, keys, levels, safe_levels).signal()
        if signal.name.lower() in map(str.lower, signals):
            raise _refuse(path, line, f"signal {signal.name!r} stands here a second time", "each name once")
        signals[signal.name] = signal
    if not signals:
        raise SignalError(f"{path} configures no signal, allowed is at least one: check the file")
    return IoConfiguration(int(header[1]), signals)


def _refuse(path: Path, line: int, found: str, allowed: str) -> AbbError:
    return SignalError(
        f"{path}, line {line}: {found}, allowed is {allowed}: correct the configuration", line=line
    )


def _entries(path: Path, lines: list[str]) -> Iterator[tuple[int, str, dict[str, str | None]]]:
    """Line, section and keys of every entry; a key without value, a flag, has None."""
    section = ""
    for start, entry in entries(lines, 2):
        heading = _SECTION.fullmatch(entry)
        if heading is not None:
            section = heading[1]
        elif not section or not entry.startswith("-"):
            raise _refuse(path, start, f"found {entry[:40]!r}", "a section such as EIO_SIGNAL: or -Key value")
        else:
            yield start, section, _keys(path, start, entry)


def _keys(path: Path, line: int, entry: str) -> dict[str, str | None]:
    try:
        # A negative number is a value, anything else behind a dash outside quotes a key.
        words = re.findall(r'"[^"]*"|[^\s"]+', entry) if entry.count('"') % 2 == 0 else shlex.split(entry)
    except ValueError:
        raise _refuse(path, line, "found a quotation mark without its partner", "pairs of them") from None
    keys: dict[str, str | None] = {}
    last = ""
    for word in words:
        if re.match(r"-[A-Za-z]", word):
            last = word[1:]
            if last in keys:
                raise _refuse(path, line, f"-{last} stands here twice", "each key once")
            keys[last] = None
        elif last and keys[last] is None:
            keys[last] = word.strip('"')
        else:
            raise _refuse(path, line, f"found {word!r}", "-Key value")
    return keys


def _level(path: Path, line: int, keys: dict[str, str | None]) -> SignalAccess:
    """An entry of EIO_ACCESS; those that every controller has keep their meaning."""
    name = keys.get("Name")
    unknown = set(keys) - {"Name", *_ACCESS}
    if not name or unknown:
        raise _refuse(
            path, line, f"found {', '.join(sorted(unknown)) or 'no -Name'}", f"-Name and {', '.join(_ACCESS)}"
        )
    level = SignalAccess(name, frozenset(_ACCESS[key] for key in keys if key != "Name"))
    if name in ACCESS_LEVELS and level != ACCESS_LEVELS[name]:
        raise _refuse(path, line, f"access level {name} is changed", "a level of another name")
    return level


class _Reader:
    """Reads one entry of EIO_SIGNAL."""

    def __init__(
        self,
        path: Path,
        line: int,
        keys: dict[str, str | None],
        levels: dict[str, SignalAccess],
        safe_levels: set[str],
    ) -> None:
        self._path, self._line, self._keys = path, line, keys
        self._levels, self._safe_levels = levels, safe_levels

    def signal(self) -> SignalConfiguration:
        """The signal, when nothing is wrong with its entry."""
        for key, value in self._keys.items():
            if key not in _TEXTS | _NUMBERS | _FLAGS:
                raise self._refuse(f"found the key -{key}", ", ".join(sorted(_TEXTS | _NUMBERS | _FLAGS)))
            if value is None and key not in _FLAGS:
                raise self._refuse(f"-{key} has no value", f'-{key} "value"')
        name = self._text("Name", "")
        if not _NAME.fullmatch(name) or len(name) > NAME_LENGTH:
            raise self._refuse(
                f"the name is {name!r}", f"a letter, then letters, digits, _, at most {NAME_LENGTH}"
            )
        kind = self._choice("SignalType", "", KINDS)
        label = self._text("Label", "")
        if len(label) > LABEL_LENGTH:
            raise self._refuse(f"the label has {len(label)} characters", f"at most {LABEL_LENGTH}")
        if "DeviceMap" in self._keys and "Device" not in self._keys:
            raise self._refuse(f"{name} has -DeviceMap without -Device", "both or none, a virtual signal")
        access = self._levels[self._choice("Access", "Default", self._levels)]
        safe_level = self._choice("SafeLevel", "DefaultSafeLevel", self._safe_levels)
        lowest, largest = self._limits(name, kind)
        default = self._number("Default", 0.0)
        if not lowest <= default <= largest:
            raise self._refuse(f"the default of {name} is {default:g}", f"{lowest:g} to {largest:g}")
        return SignalConfiguration(name, kind, access, lowest, largest, label, default, safe_level)

    def _limits(self, name: str, kind: str) -> tuple[float, float]:
        if kind in ("AI", "AO"):
            lowest, largest = self._number("MinLog", 0.0), self._number("MaxLog", 0.0)
            if lowest == largest == 0.0:
                return -float("inf"), float("inf")
            if lowest >= largest:
                raise self._refuse(f"{name} goes from {lowest:g} to {largest:g}", "-MinLog below -MaxLog")
            return lowest, largest
        if kind in ("DI", "DO"):
            return 0.0, 1.0
        bits = self._bits(name)
        return 0.0, float(2**bits - 1)

    def _bits(self, name: str) -> int:
        """Bits of a group: its `-Size`, or those of `-DeviceMap "0-7"` and `"0-3,8"`."""
        bits = self._number("Size", 0.0)
        if "DeviceMap" in self._keys:
            parts = [part.split("-") for part in self._text("DeviceMap", "").split(",")]
            try:
                bits = float(sum(int(part[-1]) - int(part[0]) + 1 for part in parts))
            except ValueError:
                raise self._refuse(f"-DeviceMap of {name} cannot be read", 'bits such as "0-7"') from None
        if bits != int(bits) or not 1 <= bits <= LARGEST_GROUP:
            raise self._refuse(
                f"group {name} has {bits:g} bits", f"-Size or -DeviceMap with 1 to {LARGEST_GROUP}"
            )
        return int(bits)

    def _text(self, key: str, otherwise: str) -> str:
        return self._keys.get(key) or otherwise

    def _number(self, key: str, otherwise: float) -> float:
        try:
            return float(self._text(key, str(otherwise)))
        except ValueError:
            raise self._refuse(f"-{key} is {self._keys[key]!r}", "a number") from None

    def _choice(
        self, key: str, otherwise: str, allowed: dict[str, SignalAccess] | dict[str, str] | set[str]
    ) -> str:
        value = self._text(key, otherwise)
        if value not in allowed:
            raise self._refuse(f"-{key} is {value!r}", ", ".join(sorted(allowed)))
        return value

    def _refuse(self, found: str, allowed: str) -> AbbError:
        return _refuse(self._path, self._line, found, allowed)
