"""The tool of a target file, a RAPID pose, `[[0,0,250],[1,0,0,0]]`: where its tip is in the flange, and how turned."""

from __future__ import annotations

import re

import numpy as np

from doormill_ros.abb.errors import TargetProgramError
from doormill_ros.abb.target_file.move import plain_number
from doormill_ros.arrays import FloatArray
from doormill_ros.frames import from_wxyz, quaternion_wxyz
from doormill_ros.units import m_to_mm, mm_to_m

_LENGTH, _PART = r"(-?\d{1,4}(?:\.\d{1,3})?)", r"(-?[01](?:\.\d{1,6})?)"
_POSE = re.compile(rf"\[\[{','.join([_LENGTH] * 3)}\],\[{','.join([_PART] * 4)}\]\]")
FARTHEST = 9.999  #: of a tip from the flange along each axis [m]
NORM_TOLERANCE = 1e-4  #: of the squares of a quaternion of six decimals, and more


def format_tool(T_flange_tool: FloatArray) -> str:
    """A tool, T_flange_tool of shape (4, 4), as a RAPID pose in millimetres.

    Raises:
        TargetProgramError: It is no frame, or its tip is too far away.
    """
    T = np.asarray(T_flange_tool, dtype=float)
    if T.shape != (4, 4) or not np.all(np.abs(T[:3, 3]) <= FARTHEST):
        raise TargetProgramError(
            f"the tool is {T.tolist()}, allowed is a frame whose origin is within {FARTHEST:g} m of the flange: "
            "correct tool.position (cell.yaml)"
        )
    tip = [plain_number(value) for value in m_to_mm(T[:3, 3]).tolist()]
    turn = [plain_number(value, 6) for value in quaternion_wxyz(T).tolist()]
    return f"[[{','.join(tip)}],[{','.join(turn)}]]"


def parse_tool(text: str) -> FloatArray | None:
    """T_flange_tool of shape (4, 4) that a pose says; None for no pose."""
    match = _POSE.fullmatch(text)
    if match is None:
        return None
    numbers = np.array([float(value) for value in match.groups()])
    if abs(float(numbers[3:] @ numbers[3:]) - 1.0) > NORM_TOLERANCE:
        return None
    return from_wxyz(mm_to_m(numbers[:3]), numbers[3:])
