"""The dictionary of poses: which frame is displaced, driven by what, in which shape; one line an entry."""

from __future__ import annotations

from doormill_ros.robot_model.law.entries import Drives, Entry, Shapes, terms
from doormill_ros.robot_model.pose.law.term import PoseTerm, Sight

_LEVEL: Shapes = (("level", 0.0),)
_TIME: Shapes = (
    ("slope", 0.0),
    *(("settling", part) for part in (0.03, 0.1, 0.3)),
    *(("creeping", part) for part in (0.01, 0.03, 0.1)),
    *(("past", part) for part in (0.2, 0.35, 0.5, 0.65, 0.8)),
    *(("periods", part) for part in (0.25, 0.33, 0.4, 0.5, 0.67, 1.0, 2.0)),
)
_WARM: Shapes = (("slope", 0.0), ("past", 0.5))
_SIZE: Shapes = (
    ("size", 1.0),
    ("square", 1.0),
    *((name, part) for name in ("saturating", "fading") for part in (0.1, 0.3, 0.8)),
    *(("past", part) for part in (0.25, 0.5, 0.75)),
)
_ANGLE: Shapes = (("slope", 0.0), ("positive", 0.0), *(("waves", float(n)) for n in range(1, 5)))
_OWN: Shapes = (*_ANGLE, *(("waves", float(n)) for n in range(5, 13)))
_OTHER: Shapes = (("slope", 0.0), ("size", 1.0), ("positive", 0.0))

_ANGLE_DRIVES: Drives = (
    ("own angle", _OWN, True),
    ("own torque", (("slope", 0.0), *_SIZE), True),
    ("torque sign", (("sign", 0.0),), False),
    ("direction", (("slope", 0.0),), False),
    ("direction (of joint k)", (("slope", 0.0),), False),
    ("angle of joint k", _ANGLE, True),
    ("torque of joint k", _OTHER, True),
    ("time", _TIME, True),
    ("temperature", _WARM, False),
)
_SAG_DRIVES: Drives = (
    ("own torque", (*_LEVEL, *_SIZE), True),
    ("torque sign", (("positive", 0.0),), False),
    ("own angle", _ANGLE, True),
    ("direction", (("slope", 0.0),), False),
    ("direction (of joint k)", (("slope", 0.0),), False),
    ("angle of joint k", _ANGLE, True),
    ("torque of joint k", _OTHER, False),
    ("time", _TIME, True),
    ("temperature", _WARM, False),
)
_FRAME_DRIVES: Drives = (
    ("time", _TIME, True),
    ("temperature", _WARM, False),
    ("angle of joint k", _ANGLE, False),
    ("direction (of joint k)", (("slope", 0.0),), False),
)


def dictionary(case: Sight) -> list[PoseTerm]:
    """Every term that series of poses can speak of."""
    count = case.views[0].joints
    joints = tuple(f"joint {k}" for k in range(1, count + 1))
    entries: list[Entry] = [
        ("joint angle", joints, _ANGLE_DRIVES),
        ("sag", joints, _SAG_DRIVES),
        ("base place", ("base",), _FRAME_DRIVES),
        ("base turn", ("base",), _FRAME_DRIVES),
        ("axis", joints[1:], _FRAME_DRIVES),
        ("seat", ("tool",), _FRAME_DRIVES),
        ("seat place", ("tool",), _FRAME_DRIVES),
    ]
    return terms(PoseTerm, case, entries, range(1, count + 1))
