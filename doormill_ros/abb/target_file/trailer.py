"""What follows the targets in a target file: for whom, which run, how to move, and the checksum.

Each line begins with `#` and a key, in this fixed order, and holds no `;`. The thesis' program
looks for eleven `;` in every line it reads and stops with an error at a line without them, so
a file with fewer than its 14 targets can never become a motion.

    #doormill 2                                    version of the form
    #door standard_door
    #run 20260314T101500-3f2a
    #recipe 3                                      version of the recipe
    #home [0,-40,30,0,10,0]                        where the program begins and ends, degrees
    #tool [[0,0,250],[1,0,0,0]]                    whose tip the targets are of, in the flange, mm and quaternion
    #targets 14
    #features 2
    #feature hinge_1                               one line for each, counted from 1
    #points 6
    #point [12.5,-3.25,40,0,-60,0]                 one line for each point of joint space, counted from 1, degrees
    #escape [2,4]                                  one line for each feature: first and last point of its way home
    #motions 16
    #move ["C",3,2,20,"z0",1,TRUE,3200]            kind, target (of "A" a point) and circle point
                                                   counted from 1, mm/s, zone, feature or 0, cutting, rev/min
    #move ["P",12,1,1000,"fine",0,FALSE,0]         at the rack, in front of which point 12 is: "P" puts the tool into
                                                   place 1, "T" takes the one of a place, "M" measures it
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
from doormill_ros.abb.target_file.move import Ends, Mistake, format_move, parse_move, plain_number
from doormill_ros.abb.target_file.tool import format_tool, parse_tool
from doormill_ros.arrays import FloatArray
from doormill_ros.cell.rapid_limits import MAX_ESCAPE, MAX_FEATURES, MAX_MOTIONS, MAX_POINTS, MAX_TARGETS
from doormill_ros.robot.chain import JOINTS
from doormill_ros.toolpath.program import Motion
from doormill_ros.units import deg_to_rad, rad_to_deg

MARK = "#"
#: Key of the line that earlier files lack: the RAPID module refuses them, bags of them can be read.
TOOL = "tool"
VERSION = 2
#: What a name must not hold: the separator of targets, and what ends or escapes a RAPID string.
FORBIDDEN = {SEPARATOR, '"', "\\"}

_SUM = re.compile(r"\[(\d{1,5}),(\d{1,5})\]")
_COUNT = re.compile(r"\d{1,6}")
_ESCAPE = re.compile(r"\[(\d{1,4}),(\d{1,4})\]")
_ANGLE = r"(-?\d{1,3}(?:\.\d{1,4})?)"
_POINT = re.compile(rf"\[{','.join([_ANGLE] * JOINTS)}\]")
LARGEST_ANGLE = deg_to_rad(999.0)  #: no joint of this kind of robot turns further [rad]
ANGLE_DECIMALS = 4  #: of a degree; a point 3 m away moves by 3 um


@dataclass(frozen=True, eq=False)
class Trailer:
    """What the trailer says; `wrench` of the motions is zero because the file does not carry it."""

    door_id: str
    run_id: str
    recipe_version: int
    target_count: int
    home: FloatArray
    points: tuple[FloatArray, ...]
    escapes: tuple[range, ...]
    motions: tuple[Motion, ...]
    tool: FloatArray | None = None


def format_trailer(trailer: Trailer) -> list[str]:
    """The trailer's lines without the checksum line.

    Raises:
        TargetValueError: A name that a RAPID string cannot hold, or a count that is too large.
        TargetProgramError: A motion, point or way home that does not fit the targets or the RAPID module.
    """
    features = list(dict.fromkeys(motion.feature for motion in trailer.motions if motion.feature))
    _check_count("targets", trailer.target_count, MAX_TARGETS)
    _check_count("motions", len(trailer.motions), MAX_MOTIONS)
    _check_count("features", len(features), MAX_FEATURES)
    _check_count("points", len(trailer.points), MAX_POINTS)
    _check_escapes(trailer, features)
    lines = [
        f"{MARK}doormill {VERSION}",
        _name_line("door", trailer.door_id),
        _name_line("run", trailer.run_id),
        f"{MARK}recipe {_recipe_version(trailer.recipe_version)}",
        f"{MARK}home {_format_point(trailer.home, 'home')}",
        *([] if trailer.tool is None else [f"{MARK}{TOOL} {format_tool(trailer.tool)}"]),
        f"{MARK}targets {trailer.target_count}",
        f"{MARK}features {len(features)}",
        *(_name_line("feature", feature) for feature in features),
        f"{MARK}points {len(trailer.points)}",
        *(f"{MARK}point {_format_point(q, f'point {i + 1}')}" for i, q in enumerate(trailer.points)),
        *(f"{MARK}escape [{escape.start + 1},{escape.stop}]" for escape in trailer.escapes),
        f"{MARK}motions {len(trailer.motions)}",
    ]
    ends = Ends(trailer.target_count, len(trailer.points))
    moves = [format_move(index, motion, ends, features) for index, motion in enumerate(trailer.motions)]
    return lines + [f"{MARK}move {move}" for move in moves]


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
        recipe_version, home = self._count("recipe"), self._angles("home")
        tool = self._tool() if self._comes(TOOL) else None
        targets = self._count("targets")
        features = [self._value("feature") for _ in range(self._count("features", MAX_FEATURES))]
        if len(set(features)) != len(features):
            raise self._error("repeats a feature", "each feature once")
        points = tuple(self._angles("point") for _ in range(self._count("points", MAX_POINTS)))
        escapes = tuple(self._escape(len(points)) for _ in features)
        ends = Ends(targets, len(points))
        motions = tuple(self._move(ends, features) for _ in range(self._count("motions", MAX_MOTIONS)))
        match = _SUM.fullmatch(self._value("sum", {SEPARATOR}))
        if not match:
            raise self._error("holds no checksum", "two numbers as in #sum [12345,23456]")
        trailer = Trailer(door_id, run_id, recipe_version, targets, home, points, escapes, motions, tool)
        return trailer, (int(match[1]), int(match[2]))

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

    def _angles(self, key: str) -> FloatArray:
        """Joint angles of a line such as #point, shape (6,) [rad]."""
        text = self._value(key, {SEPARATOR})
        match = _POINT.fullmatch(text)
        if not match:
            raise self._error(f"is {text!r}", f"{JOINTS} joint angles such as [0,-40,30.5,0,10,0]")
        return deg_to_rad(np.array([float(angle) for angle in match.groups()]))

    def _comes(self, key: str) -> bool:
        return not self.at_end and self._lines[self._next].startswith(f"{MARK}{key} ")

    def _tool(self) -> FloatArray:
        """T_flange_tool, shape (4, 4)."""
        text = self._value(TOOL, {SEPARATOR})
        tool = parse_tool(text)
        if tool is None:
            raise self._error(f"is {text!r}", "a place and a unit quaternion such as [[0,0,250],[1,0,0,0]]")
        return tool

    def _escape(self, points: int) -> range:
        """The points of a way home, counted from 0."""
        text = self._value("escape", {SEPARATOR})
        match = _ESCAPE.fullmatch(text)
        first, last = (int(match[1]), int(match[2])) if match else (0, 0)
        if not 1 <= first <= last <= points or last - first >= MAX_ESCAPE:
            raise self._error(
                f"has the way home {text!r}", f"first and last of {points} points, at most {MAX_ESCAPE}"
            )
        return range(first - 1, last)

    def _move(self, ends: Ends, features: list[str]) -> Motion:
        text = self._value("move", {SEPARATOR})
        found = parse_move(text, ends, features)
        if isinstance(found, Mistake):
            raise self._error(found.found, found.allowed)
        return found

    def _error(self, found: str, allowed: str) -> AbbError:
        return TargetLineError(
            f"line {self.number} of the target file {found}, allowed is {allowed}: write the file anew",
            line=self.number,
        )


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


def _format_point(q: FloatArray, name: str) -> str:
    """Joint angles in degrees as a RAPID record."""
    angles = np.asarray(q, dtype=float)
    if angles.shape != (JOINTS,) or not np.all(np.abs(angles) <= LARGEST_ANGLE):
        raise TargetProgramError(
            f"{name} has the joint angles {angles.tolist()} rad, allowed are {JOINTS} within "
            f"{LARGEST_ANGLE:.1f} rad: correct the milling program"
        )
    return f"[{','.join(plain_number(angle, ANGLE_DECIMALS) for angle in rad_to_deg(angles).tolist())}]"


def _check_escapes(trailer: Trailer, features: list[str]) -> None:
    """One way home for each feature, along points that there are."""
    if len(trailer.escapes) != len(features):
        raise TargetProgramError(
            f"the milling program has {len(trailer.escapes)} ways home for {len(features)} features, allowed is "
            "one for each: generate the path again"
        )
    for feature, escape in zip(features, trailer.escapes, strict=True):
        if not 0 <= escape.start < escape.stop <= len(trailer.points) or len(escape) > MAX_ESCAPE:
            raise TargetProgramError(
                f"the way home from {feature} has the points {escape.start + 1} to {escape.stop}, allowed are 1 to "
                f"{MAX_ESCAPE} of the {len(trailer.points)} points: correct the milling program",
                feature=feature,
            )


def _plain(text: str, forbidden: set[str]) -> bool:
    """Printable ASCII without the forbidden characters."""
    return text.isascii() and text.isprintable() and not any(map(text.__contains__, forbidden))


def _recipe_version(version: int) -> int:
    if not isinstance(version, int | np.integer) or not 0 <= version <= 999_999:
        raise TargetValueError(
            f"the recipe version is {version!r}, allowed is an integer from 0 to 999999: check the recipe",
            version=version,
        )
    return int(version)


def _check_count(what: str, found: int, largest: int) -> None:
    if not 1 <= found <= largest and not (what in ("features", "points") and found == 0):
        raise TargetValueError(
            f"the milling program has {found} {what}, allowed are 1 to {largest}: "
            "mill the door in several runs",
            what=what,
            found=found,
        )
