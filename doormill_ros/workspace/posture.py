"""How well the robot stands at many flange positions with the tool pointing at the door."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from doormill_ros.arrays import FloatArray, IntArray
from doormill_ros.robot.chain import JOINTS, chain_frames, jacobian_columns
from doormill_ros.robot.description import Robot
from doormill_ros.robot.inverse import inverse_branches
from doormill_ros.robot.singularity import line_angle
from doormill_ros.workspace.conditioning import characteristic_length, inverse_condition_number

#: R_base_flange at a hinge: flange z along base +x, flange x along base -y (from table 4.6).
R_AT_HINGE = np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])

#: Arm postures: base and elbow as in cfx, less the bit of the wrist.
POSTURES = {0: "elbow up", 1: "elbow down", 2: "base backward, elbow up", 3: "base backward, elbow down"}

_CHUNK = 2048
_UNREACHED = {"conditioning": 0.0, "stiffness": 0.0, "margin": -np.inf, "wrist": 0.0, "clearance": -np.inf}
FIGURES = tuple(_UNREACHED)  #: figures of merit of a posture; of each the smallest counts


@dataclass(frozen=True, eq=False)
class PostureFigures:
    """Figures at n flange positions in one arm posture.

    Where the posture does not reach, every figure has its worst value.

    Attributes:
        conditioning: Inverse condition number of the normalized Jacobian, shape (n,) [-].
        stiffness: Stiffness of the flange in its softest direction, shape (n,) [N/m].
        margin: Smallest distance of joints 1, 2, 3 and 5 from their limits, shape (n,) [rad]. Joints 4
            and 6 turn more than once and find their place.
        wrist: Angle of axis 5 from straight, shape (n,) [rad].
        clearance: How far the elbow stays behind the flange along base x, shape (n,) [m].
    """

    conditioning: FloatArray
    stiffness: FloatArray
    margin: FloatArray
    wrist: FloatArray
    clearance: FloatArray


def posture_figures(robot: Robot, positions: FloatArray, posture: int) -> PostureFigures:
    """Figures of merit of flange positions, shape (n, 3) [m], in an arm posture of `POSTURES`.

    Both flips of the wrist give the same figures but for the margin, of which the better counts.

    Raises:
        GeometryError: The robot has no closed-form inverse here.
    """
    return all_posture_figures(robot, positions, (posture,))[posture]


def all_posture_figures(
    robot: Robot, positions: FloatArray, postures: Iterable[int] = tuple(POSTURES)
) -> dict[int, PostureFigures]:
    """`posture_figures` of several postures, for which the inverse is solved once."""
    n = len(positions)
    results = {p: {name: np.full(n, worst) for name, worst in _UNREACHED.items()} for p in postures}
    length = characteristic_length(robot)
    for first in range(0, n, _CHUNK):
        part = np.arange(first, min(first + _CHUNK, n))
        T = np.zeros((len(part), 4, 4))
        T[:, :3, :3], T[:, :3, 3], T[:, 3, 3] = R_AT_HINGE, positions[part], 1.0
        branches = inverse_branches(robot, T)
        for posture, result in results.items():
            flips = branches[:, 2 * posture : 2 * posture + 2]  # (n, 2, 6)
            reached = np.isfinite(flips[:, 0, 0])
            if reached.any():
                _fill(robot, length, flips[reached], part[reached], result)
    return {posture: PostureFigures(**result) for posture, result in results.items()}


def _fill(
    robot: Robot, length: float, flips: FloatArray, part: IntArray, result: dict[str, FloatArray]
) -> None:
    room = np.minimum(flips - robot.lower, robot.upper - flips)[..., [0, 1, 2, 4]]
    frames = chain_frames(robot.dh, np.ascontiguousarray(flips[:, 0].T))
    velocity = jacobian_columns(frames, frames.origin[JOINTS])
    result["conditioning"][part] = inverse_condition_number(frames, velocity, length)
    result["stiffness"][part] = softest_direction(velocity, robot.stiffness)
    result["margin"][part] = room.min(axis=2).max(axis=1)
    result["wrist"][part] = line_angle(frames.z[3], frames.z[5])
    result["clearance"][part] = frames.origin[JOINTS, 0] - frames.origin[2, 0]


def softest_direction(velocity: FloatArray, stiffness: FloatArray) -> FloatArray:
    """Force per displacement in the direction that gives way most, shape (n,) [N/m].

    Args:
        velocity: Translational Jacobian, shape (6, 3, n).
        stiffness: Joint stiffness, shape (6,) [N m/rad].
    """
    compliance = np.einsum("jin,jkn,j->nik", velocity, velocity, 1.0 / stiffness)
    return 1.0 / np.linalg.eigvalsh(compliance)[:, -1]
