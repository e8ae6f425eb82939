"""One motion of a target file as a RAPID record, `["C",3,2,20,"z0",1,TRUE,3200]`, and back."""

from __future__ import annotations

import re
from typing import NamedTuple

import numpy as np

from doormill_ros.abb.errors import AbbError, TargetProgramError
from doormill_ros.cell.rapid_limits import MAX_PLACES
from doormill_ros.toolpath.program import Motion, MotionKind
from doormill_ros.units import RPM, m_to_mm, mm_to_m

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


_KINDS = {
    MotionKind.LINEAR: "L",
    MotionKind.CIRCULAR: "C",
    MotionKind.ABSOLUTE: "A",
    MotionKind.PUT: "P",
    MotionKind.TAKE: "T",
    MotionKind.MEASURE: "M",
}
#: Kinds that end at a point of joint space, and those among them that name a place of the rack.
_AT_POINTS, _AT_RACK = "APTM", "PTM"
_KIND_OF = {letter: kind for kind, letter in _KINDS.items()}
_NUMBER = r"(\d{1,5}(?:\.\d{1,3})?)"
_MOVE = re.compile(
    rf'\["([LCAPTM])",(\d{{1,4}}),(\d{{1,4}}),{_NUMBER},"([a-z0-9]{{2,4}})",(\d{{1,2}}),(TRUE|FALSE),{_NUMBER}\]'
)


class Ends(NamedTuple):
    """Where motions can end: how many targets and how many points of joint space there are."""

    targets: int
    points: int

    def of(self, letter: str) -> int:
        """How many ends a kind of motion has."""
        return self.points if letter in _AT_POINTS else self.targets

    def by_way_of(self, letter: str) -> int:
        """How many circle points or places of the rack a kind of motion may name."""
        return MAX_PLACES if letter in _AT_RACK else self.targets if letter == "C" else 0


class Mistake(NamedTuple):
    """What is wrong with a record, and what is allowed."""

    found: str
    allowed: str


def parse_move(text: str, ends: Ends, features: list[str]) -> Motion | Mistake:
    """The motion that a record says, or what is wrong with it.

    Args:
        text: The record.
        ends: How many targets and points there are.
        features: Names of the features in the order of the file.
    """
    match = _MOVE.fullmatch(text)
    if not match:
        return Mistake(f"is {text!r}", 'a move such as ["C",3,2,20,"z0",1,TRUE,3200]')
    letter, zone = match[1], match[5]
    target, via, feature = int(match[2]), int(match[3]), int(match[6])
    last, most = ends.of(letter), ends.by_way_of(letter)
    if not 1 <= target <= last or not (1 <= via <= most if most else via == 0):
        said = f"1 to {most} beside it" if most else "0 without circle"
        return Mistake(f"moves to {target} by way of {via}", f"1 to {last}, and {said}")
    if feature > len(features) or zone not in ZONES:
        return Mistake(f"names feature {feature} and zone {zone}", f"0 to {len(features)} and one of {ZONES}")
    speed, spindle = mm_to_m(float(match[4])), float(match[8]) * RPM
    if letter in _AT_RACK and spindle:
        return Mistake(f"is {text!r}", "a spindle at rest at the rack")
    if not 0.0 < speed <= MAX_SPEED or spindle > MAX_SPINDLE_SPEED * (1.0 + 1e-9):
        return Mistake(f"is {text!r}", "a speed above 0 and a spindle speed the cell has")
    return Motion(
        kind=_KIND_OF[letter],
        target=target - 1,
        via=via - 1 if via else None,
        speed=speed,
        zone=zone,
        feature=features[feature - 1] if feature else "",
        cutting=match[7] == "TRUE",
        wrench=np.zeros(6),
        spindle_speed=spindle,
    )


def format_move(index: int, motion: Motion, ends: Ends, features: list[str]) -> str:
    """A motion as a RAPID record.

    Args:
        index: Its number, for the sentence.
        motion: The motion.
        ends: How many targets and points there are.
        features: Names of the features in the order of the file.

    Raises:
        TargetProgramError: It does not fit them, or the RAPID module does not know it.
    """

    def error(found: str, allowed: str) -> AbbError:
        return TargetProgramError(
            f"motion {index} has {found}, allowed is {allowed}: correct the milling program", motion=index
        )

    if motion.kind not in _KINDS:
        raise error(f"kind {motion.kind!r}", "MoveL, MoveC or MoveAbsJ, or one of the rack")
    last = ends.of(_KINDS[motion.kind])
    if not 0 <= motion.target < last:
        raise error(f"target {motion.target}", f"0 to {last - 1}")
    via, most = motion.via, ends.by_way_of(_KINDS[motion.kind])
    if (most > 0) != (via is not None) or (via is not None and not 0 <= via < most):
        raise error(
            f"circle point or place {motion.via}",
            "a target for MoveC, a place at the rack, and None for the others",
        )
    if motion.zone not in ZONES:
        raise error(f"zone {motion.zone!r}", f"one of {', '.join(ZONES)}")
    speed = plain_number(m_to_mm(motion.speed))
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
        plain_number(motion.spindle_speed / RPM),
    )
    return f"[{','.join(fields)}]"


def plain_number(value: float, decimals: int = 3) -> str:
    """At most so many decimals, without zeros at the end and without a minus sign before a zero."""
    text = f"{value:.{decimals}f}".rstrip("0").rstrip(".")
    return "0" if text in ("", "-0") else text
