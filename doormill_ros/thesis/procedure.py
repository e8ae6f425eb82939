"""The thesis' identification from raw files, formula by formula (section 3.1, appendices A.8 to A.13).

A test in loading_tests.yaml says under `thesis` which joint it is for and what the formula needs:

| joint | keys beside `joint` | reflectors | equations |
| --- | --- | --- | --- |
| 1 | force (fx, fy or fz), load_arm, lever | one | 3.1, 3.2 |
| 2 | load_arm, lever | one | 3.3, 3.4 |
| 3 | lever | one | 3.5 to 3.8; takes joint 2 off |
| 4 | force, load_arm, lever (L_2), radius (R_4) | A before, B behind the joint | 3.9 to 3.17 |
| 5 | force, load_arm | A, B, C along the arm | 3.18 to 3.29 |
| 6 | lever | one | 3.30 to 3.33; takes joint 1 off |

Forces are those of the flange axes, lengths in metres. Where the thesis' scripts go wrong (docs/thesis.md) the
mechanics is followed: torques by the transposed Jacobian, with load and Jacobian both in base axes.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.measurements.errors import LoadingTestError
from doormill_ros.measurements.raw.raw_set import RawTest
from doormill_ros.robot.kinematics import Kinematics
from doormill_ros.thesis import formulas as formula

_AXES = {"fx": 0, "fy": 1, "fz": 2}
_REFLECTORS = {4: 2, 5: 3}
_EQUATIONS = {
    1: "3.1, 3.2",
    2: "3.3, 3.4",
    3: "3.5 to 3.8",
    4: "3.9 to 3.17",
    5: "3.18 to 3.29",
    6: "3.30 to 3.33",
}


@dataclass(frozen=True)
class FormulaResult:
    """Stiffness of one joint by the thesis' formula.

    Attributes:
        joint: Number 1..6.
        stiffness: [N m/rad].
        equations: Numbers of the equations used.
        test: Name of the test.
    """

    joint: int
    stiffness: float
    equations: str
    test: str


def thesis_stiffness(
    kinematics: Kinematics, tests: list[RawTest], fallback: FloatArray
) -> list[FormulaResult]:
    """Apply the formula of each test that names a joint, joint 1 first.

    Args:
        kinematics: Of the robot that was loaded.
        tests: Means of the raw tests.
        fallback: Stiffness of joints 1 and 2 where no test gives it, shape (6,) [N m/rad].

    Raises:
        LoadingTestError: A test lacks what its formula needs.
    """
    known = dict(enumerate(np.asarray(fallback, dtype=float), start=1))
    results = []
    for test in sorted((t for t in tests if t.thesis), key=_joint):
        joint = _joint(test)
        stiffness = _stiffness(kinematics, test, joint, known)
        known[joint] = stiffness
        results.append(FormulaResult(joint, float(stiffness), _EQUATIONS[joint], test.name))
    return results


def _stiffness(kinematics: Kinematics, test: RawTest, joint: int, known: dict[int, float]) -> float:
    needed = _REFLECTORS.get(joint, 1)
    if len(test.loaded) < needed:
        raise LoadingTestError(
            f"test {test.name} has {len(test.loaded)} reflectors, the formula of joint {joint} needs {needed}"
        )
    x0, x = test.unloaded, test.loaded
    if joint in (1, 2):
        force = _force(kinematics, test) if joint == 1 else float(np.linalg.norm(test.wrench[:3]))
        length = formula.displacement_length(x[0], x0[0])
        return formula.stiffness_from_length(force, _length(test, "load_arm"), _length(test, "lever"), length)
    if joint == 4:
        turned = formula.joint4_rotation(
            (x0[0], x0[1]), (x[0], x[1]), _length(test, "lever"), _length(test, "radius")
        )
        return formula.stiffness_from_rotation(_force(kinematics, test), _length(test, "load_arm"), turned)
    if joint == 5:
        turned = abs(formula.joint5_rotation((x0[0], x0[1], x0[2]), (x[0], x[1], x[2])))
        return formula.stiffness_from_rotation(_force(kinematics, test), _length(test, "load_arm"), turned)
    other = {3: 2, 6: 1}[joint]
    J = kinematics.link_jacobian(test.q, test.load_link, test.load_point)
    taken_off = formula.joint_displacement(J, test.wrench, other, known[other])
    length = formula.displacement_length(x[0], x0[0], taken_off)
    torque = float(J[:, joint - 1] @ test.wrench)  # F L_1
    return formula.stiffness_from_length(torque, 1.0, _length(test, "lever"), length)


def _joint(test: RawTest) -> int:
    joint = test.thesis.get("joint")
    if isinstance(joint, bool) or not isinstance(joint, int) or joint not in _EQUATIONS:
        raise LoadingTestError(f"test {test.name} has thesis joint {joint!r}, allowed is 1 to 6")
    return joint


def _length(test: RawTest, key: str) -> float:
    value = test.thesis.get(key)
    if isinstance(value, bool) or not isinstance(value, int | float) or not 0.0 < value < 10.0:
        raise LoadingTestError(
            f"test {test.name} has thesis {key} {value!r}, allowed is a length above 0 in metres"
        )
    return float(value)


def _force(kinematics: Kinematics, test: RawTest) -> float:
    axis = test.thesis.get("force")
    if axis not in _AXES:
        raise LoadingTestError(f"test {test.name} has thesis force {axis!r}, allowed is fx, fy or fz")
    R_base_flange = kinematics.forward(test.q)[:3, :3]
    return float(abs(R_base_flange[:, _AXES[axis]] @ test.wrench[:3]))
