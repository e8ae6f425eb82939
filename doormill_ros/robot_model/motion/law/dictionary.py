"""The dictionary of moving joints: what may be off, driven by what, in which shape; one line an entry."""

from __future__ import annotations

from collections.abc import Sequence

from doormill_ros.robot_model.law.entries import SECTORS, Drives, Entry, Shapes, terms
from doormill_ros.robot_model.motion.law.carriers import BRISTLES, SETTLES
from doormill_ros.robot_model.motion.law.term import MotionTerm, Rides

WAVES = 30  #: a turn of the joint, at most
_LEVEL: Shapes = (("level", 0.0),)
_TIME: Shapes = (
    ("slope", 0.0),
    *(("settling", part) for part in (0.05, 0.1, 0.2, 0.4, 0.8)),
    *(("past", part) for part in (0.2, 0.35, 0.5, 0.65, 0.8)),
    *(("periods", part) for part in (0.25, 0.5, 1.0)),
)
_SIZE: Shapes = (
    ("size", 1.0),
    ("square", 1.0),
    ("root", 1.0),
    *((name, part) for name in ("fading", "saturating") for part in (0.1, 0.3, 0.8)),
    *(("past", part) for part in (0.25, 0.5, 0.75)),
    *(("beyond", part) for part in (0.25, 0.5)),
)
_ODD: Shapes = (("slope", 0.0), *_SIZE)
_ANGLE: Shapes = (("slope", 0.0), ("square", 1.0), *(("waves", float(n)) for n in range(1, 5)))
_SIDES: Shapes = (("positive", 0.0),)
_OWN: Shapes = (*_ANGLE, *(("waves", float(n)) for n in range(5, WAVES + 1)), *SECTORS)

_ANGLE_DRIVES: Drives = (
    ("time", _TIME, True),
    ("own torque", _ODD, True),
    ("torque sign", (*_SIDES, ("sign", 0.0)), False),
    ("own angle", _OWN, True),
    ("angle of joint k", _ANGLE, True),
    ("torque of joint k", _ODD, True),
    ("speed", _ODD, True),
    ("speed (its change)", (("slope", 0.0), ("size", 1.0)), False),
    ("speed (of joint k)", (("slope", 0.0), ("size", 1.0), ("square", 1.0)), False),
    ("direction", (("slope", 0.0),), False),
)
_SPRING_DRIVES: Drives = (
    ("own torque", (*_LEVEL, *_SIZE), True),
    ("torque sign", _SIDES, False),
    ("own angle", _OWN, True),
    ("angle of joint k", _ANGLE, True),
    ("torque of joint k", _ODD, True),
    ("time", _TIME, True),
    ("speed", _SIZE, True),
    ("direction", (("slope", 0.0),), False),
)
_DELAY_DRIVES: Drives = (
    ("speed", _LEVEL, False),
    ("own torque", _ODD, True),
    ("torque sign", _SIDES, False),
    ("time", _TIME, True),
    ("own angle", _ANGLE, False),
    ("angle of joint k", _ANGLE, False),
    ("torque of joint k", _ODD, False),
)
_FRICTION_DRIVES: Drives = (
    ("direction", _LEVEL, False),
    ("time", _TIME, True),
    ("own angle", (*_ANGLE, *SECTORS), True),
    ("own torque", _SIZE, True),
    ("speed", _SIZE, True),
    ("angle of joint k", _ANGLE, False),
    ("torque of joint k", _SIZE, False),
)


def dictionary(case: Rides) -> list[MotionTerm]:
    """Every term that recordings of one joint can speak of."""
    own = case[0].own.motion.joint
    where: Sequence[str] = (f"joint {own}",)
    entries: list[Entry] = [
        ("joint angle", where, _ANGLE_DRIVES),
        ("spring", where, _SPRING_DRIVES),
        ("delay", where, _DELAY_DRIVES),
        *((f"friction within {width:g} mrad", where, _FRICTION_DRIVES) for width in BRISTLES),
        *(
            (f"spring that yields in {time:g} s", where, (("time under load", _LEVEL, False),))
            for time in SETTLES
        ),
    ]
    joints = sorted({k + 1 for ride in case for k in ride.others} | {own})
    return terms(MotionTerm, case, entries, joints)
