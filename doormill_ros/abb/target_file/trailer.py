"""What follows the targets in a target file: for whom, which run, how to move, and the checksum.

Each line begins with `#` and a key, in this fixed order, and holds no `;`. The thesis' program
looks for eleven `;` in every line it reads and stops with an error at a line without them, so
a file with fewer than its 14 targets can never become a motion.

    #doormill 1                                    version of the form
    #door standard_door
    #run 20260314T101500-3f2a
    #recipe 3                                      version of the recipe
    #targets 14
    #features 2
    #feature hinge_1                               one line for each, counted from 1
    #motions 16
    #move ["C",3,2,20,"z0",1,TRUE,3200]            kind, target and circle point counted from 1, mm/s,
                                                   zone, feature or 0, cutting, rev/min
    #sum [12345,23456]                             checksum of every byte before this line

The bracketed parts are RAPID record literals: `StrToVal` turns each into a record in one call.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np

from doormill_ros.abb.errors import (
    AbbError,
    TargetFileCutShortError,
    TargetLineError,
    TargetProgramError,
    TargetValueError,
)
from doormill_ros.abb.target_file.line import RAPID_STRING, SEPARATOR
from doormill_ros.toolpath.program import Motion, MotionKind
from doormill_ros.units import RPM, m_to_mm, mm_to_m

MARK = "#"
VERSION = 1
#: Array sizes of the RAPID module.
MAX_TARGETS = 2000
MAX_MOTIONS = 2000
MAX_FEATURES = 40
#: Zones that the RAPID module knows, as the controller predefines them.
ZONES = (
    "fine",
    "z0",
    "z1",
    "z5",
    "z10",
    "z15",
    "z20",
    "z30",
    "z40",
    "z50",
    "z60",
    "z80",
    "z100",
    "z150",
    "z200",
)
MAX_SPEED = 7.0  #: v7000, the fastest predefined speed [m/s]
MAX_SPINDLE_SPEED = 24000.0 * RPM  #: more than any router spindle of the cell turns [rad/s]

#: What a name must not hold: the separator of targets, and what ends or escapes a RAPID string.
FORBIDDEN = {SEPARATOR, '"', "\\"}

_KINDS = {MotionKind.JOINT: "J", MotionKind.LINEAR: "L", MotionKind.CIRCULAR: "C"}
_KIND_OF = {letter: kind for kind, letter in _KINDS.items()}
_NUMBER = r"(\d{1,5}(?:\.\d{1,3})?)"
_MOVE = re.compile(
    rf'\["([JLC])",(\d{{1,4}}),(\d{{1,4}}),{_NUMBER},"([a-z0-9]{{2,4}})",(\d{{1,2}}),(TRUE|FALSE),{_NUMBER}\]'
)
_SUM = re.compile(r"\[(\d{1,5}),(\d{1,5})\]")
_COUNT = re.compile(r"\d{1,6}")


@dataclass(frozen=True)
class Trailer:
    """What the trailer says; `wrench` of the motions is zero because the file does not carry it."""

    door_id: str
    run_id: str
    recipe_version: int
    target_count: int
    motions: tuple[Motion, ...]


def format_trailer(trailer: Trailer) -> list[str]:
    """The trailer's lines without the checksum line.

    Raises:
        TargetValueError: A name that a RAPID string cannot hold, or a count that is too large.
        TargetProgramError: A motion that does not fit the targets or the RAPID module.
    """
    features = list(dict.fromkeys(motion.feature for motion in trailer.motions if motion.feature))
    _check_count("targets", trailer.target_count, MAX_TARGETS)
    _check_count("motions", len(trailer.motions), MAX_MOTIONS)
    _check_count("features", len(features), MAX_FEATURES)
    lines = [
        f"{MARK}doormill {VERSION}",
        _name_line("door", trailer.door_id),
        _name_line("run", trailer.run_id),
        f"{MARK}recipe {_recipe_version(trailer.recipe_version)}",
        f"{MARK}targets {trailer.target_count}",
        f"{MARK}features {len(features)}",
        *(_name_line("feature", feature) for feature in features),
        f"{MARK}motions {len(trailer.motions)}",
    ]
    for index, motion in enumerate(trailer.motions):
        lines.append(_format_move(index, motion, trailer.target_count, features))
    return lines


class TrailerReader:
    """Walks through the lines after the targets and says where one is wrong."""

    def __init__(self, lines: list[str], first: int) -> None:
        """Take the trailer's lines; `first` is the number of the first one in the file."""
        self._lines = lines
        self._first = first
        self._next = 0

    @property
    def number(self) -> int:
        """Number in the file of the line that was read last."""
        return self._first + self._next - 1

    @property
    def at_end(self) -> bool:
        """True when no line is left."""
        return self._next == len(self._lines)

    def read(self) -> tuple[Trailer, tuple[int, int]]:
        """The trailer and the two remainders of its checksum line.

        Raises:
            TargetFileCutShortError: A line is missing at the end.
            TargetLineError: A line is out of order or holds what it must not.
        """
        version = self._count("doormill")
        if version != VERSION:
            raise self._error(f"says version {version}", f"version {VERSION}")
        door_id, run_id = self._value("door"), self._value("run")
        recipe_version, targets = self._count("recipe"), self._count("targets")
        features = [self._value("feature") for _ in range(self._count("features", MAX_FEATURES))]
        if len(set(features)) != len(features):
            raise self._error("repeats a feature", "each feature once")
        motions = tuple(self._move(targets, features) for _ in range(self._count("motions", MAX_MOTIONS)))
        match = _SUM.fullmatch(self._value("sum", {SEPARATOR}))
        if not match:
            raise self._error("holds no checksum", "two numbers as in #sum [12345,23456]")
        return Trailer(door_id, run_id, recipe_version, targets, motions), (int(match[1]), int(match[2]))

    def _value(self, key: str, forbidden: set[str] = FORBIDDEN) -> str:
        if self.at_end:
            raise TargetFileCutShortError(
                f"the target file ends after line {self.number}, allowed there is a line '{MARK}{key} ...': "
                "write the file anew",
                line=self.number,
                missing=key,
            )
        line = self._lines[self._next]
        self._next += 1
        start = f"{MARK}{key} "
        if len(line) > RAPID_STRING:
            raise self._error(f"has {len(line)} characters", f"at most {RAPID_STRING}")
        value = line[len(start) :]
        if not line.startswith(start) or not value or value != value.strip() or not _plain(value, forbidden):
            raise self._error(f"is {line!r}", f"'{start}' and a value of plain characters")
        return value

    def _count(self, key: str, largest: int = 999_999) -> int:
        text = self._value(key)
        if not _COUNT.fullmatch(text) or int(text) > largest:
            raise self._error(f"says {MARK}{key} {text}", f"an integer from 0 to {largest}")
        return int(text)

    def _move(self, targets: int, features: list[str]) -> Motion:
        text = self._value("move", {SEPARATOR})
        match = _MOVE.fullmatch(text)
        if not match:
            raise self._error(f"is {text!r}", 'a move such as ["C",3,2,20,"z0",1,TRUE,3200]')
        kind, zone = _KIND_OF[match[1]], match[5]
        target, via, feature = int(match[2]), int(match[3]), int(match[6])
        if not 1 <= target <= targets or not (1 <= via <= targets if match[1] == "C" else via == 0):
            raise self._error(f"moves to {target} by way of {via}", f"1 to {targets}, and 0 without circle")
        if feature > len(features) or zone not in ZONES:
            raise self._error(
                f"names feature {feature} and zone {zone}", f"0 to {len(features)} and one of {ZONES}"
            )
        speed, spindle = mm_to_m(float(match[4])), float(match[8]) * RPM
        if not 0.0 < speed <= MAX_SPEED or spindle > MAX_SPINDLE_SPEED * (1.0 + 1e-9):
            raise self._error(f"is {text!r}", "a speed above 0 and a spindle speed the cell has")
        return Motion(
            kind=kind,
            target=target - 1,
            via=via - 1 if via else None,
            speed=speed,
            zone=zone,
            feature=features[feature - 1] if feature else "",
            cutting=match[7] == "TRUE",
            wrench=np.zeros(6),
            spindle_speed=spindle,
        )

    def _error(self, found: str, allowed: str) -> AbbError:
        return TargetLineError(
            f"line {self.number} of the target file {found}, allowed is {allowed}: write the file anew",
            line=self.number,
        )


def _format_move(index: int, motion: Motion, targets: int, features: list[str]) -> str:
    """One `#move` line."""

    def error(found: str, allowed: str) -> AbbError:
        return TargetProgramError(
            f"motion {index} has {found}, allowed is {allowed}: correct the milling program", motion=index
        )

    circular = motion.kind is MotionKind.CIRCULAR
    if motion.kind not in _KINDS:
        raise error(f"kind {motion.kind!r}", "MoveJ, MoveL or MoveC")
    if not 0 <= motion.target < targets:
        raise error(f"target {motion.target}", f"0 to {targets - 1}")
    via = motion.via
    if circular != (via is not None) or (via is not None and not 0 <= via < targets):
        raise error(f"circle point {motion.via}", "a target for MoveC and None for the others")
    if motion.zone not in ZONES:
        raise error(f"zone {motion.zone!r}", f"one of {', '.join(ZONES)}")
    speed = _number(m_to_mm(motion.speed))
    if not 0.0 < motion.speed <= MAX_SPEED or float(speed) == 0.0:
        raise error(f"speed {motion.speed} m/s", f"0.000001 to {MAX_SPEED:g} m/s")
    if not 0.0 <= motion.spindle_speed <= MAX_SPINDLE_SPEED:
        raise error(f"spindle speed {motion.spindle_speed} rad/s", f"0 to {MAX_SPINDLE_SPEED:.0f} rad/s")
    fields = (
        f'"{_KINDS[motion.kind]}"',
        str(motion.target + 1),
        str(0 if via is None else via + 1),
        speed,
        f'"{motion.zone}"',
        str(features.index(motion.feature) + 1 if motion.feature else 0),
        "TRUE" if motion.cutting else "FALSE",
        _number(motion.spindle_speed / RPM),
    )
    return f"{MARK}move [{','.join(fields)}]"


def _number(value: float) -> str:
    """At most three decimals, without zeros at the end."""
    text = f"{value:.3f}".rstrip("0").rstrip(".")
    return text or "0"


def _name_line(key: str, name: str) -> str:
    """A line with a name that a RAPID string can hold."""
    line = f"{MARK}{key} {name}"
    fits = isinstance(name, str) and bool(name) and len(line) <= RAPID_STRING
    if not fits or name != name.strip() or not _plain(name, FORBIDDEN):
        longest = RAPID_STRING - len(key) - 2
        raise TargetValueError(
            f"the name of the {key} is {name!r}, allowed are 1 to {longest} characters of ASCII without "
            f"'{SEPARATOR}', '\"', '\\' and without blanks at the ends: rename it",
            key=key,
            name=name,
        )
    return line


def _plain(text: str, forbidden: set[str]) -> bool:
    """Printable ASCII without the forbidden characters."""
    return text.isascii() and text.isprintable() and not forbidden & set(text)


def _recipe_version(version: int) -> int:
    if not isinstance(version, int | np.integer) or not 0 <= version <= 999_999:
        raise TargetValueError(
            f"the recipe version is {version!r}, allowed is an integer from 0 to 999999: check the recipe",
            version=version,
        )
    return int(version)


def _check_count(what: str, found: int, largest: int) -> None:
    if not 1 <= found <= largest and not (what == "features" and found == 0):
        raise TargetValueError(
            f"the milling program has {found} {what}, allowed are 1 to {largest}: "
            "mill the door in several runs",
            what=what,
            found=found,
        )
