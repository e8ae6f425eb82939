"""Recover the confidential stiffness of table 4.1 from what the appendices print, joint by joint.

Joints 1 and 2 follow from loads, arms and displacements alone. The ratio of the two is printed in table 4.1
and was used in neither, so it checks both. Joints 3 to 6 need displacement vectors that are not printed; they
follow through the ratios of table 4.1, and joint 4 once more through table 4.2.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.robot.chain import JOINTS
from doormill_ros.thesis.formulas import stiffness_from_length, stiffness_from_rotation
from doormill_ros.thesis.loading_tests import ThesisData
from doormill_ros.units import GRAVITY, UM

#: Half of the last printed digit, as the standard deviation of a uniform distribution.
_ROUNDING = 0.5 / np.sqrt(3.0)
_UM_DIGIT = 0.1 * UM  # table 4.2 prints tenths of a micrometre
_RATIO_DIGIT = (1e-3, 1e-3, 1e-4, 1e-3, 1e-3, 1e-4)  # last digit of each ratio of table 4.1


@dataclass(frozen=True, eq=False)
class Recovery:
    """The thesis' own stiffness in absolute terms.

    Attributes:
        stiffness: Shape (6,) [N m/rad].
        printing_std: How exactly the printed figures give the thesis' number, shape (6,) [N m/rad].
        ratio_2_to_1: Joint 2 over joint 1 from loads, arms and displacements.
        ratio_2_to_1_std: Its deviation from rounding.
        stiffness_4_from_rotation: Joint 4 from table 4.2 and the weight, without table 4.1 [N m/rad].
        load_4_implied: Load of the joint 4 test that table 4.1 and table 4.2 imply together [N].
        equations: Where each joint comes from.
    """

    stiffness: FloatArray
    printing_std: FloatArray
    ratio_2_to_1: float
    ratio_2_to_1_std: float
    stiffness_4_from_rotation: float
    load_4_implied: float
    equations: tuple[str, ...]


def recover(data: ThesisData) -> Recovery:
    """Apply the thesis' formulas to its printed figures."""
    one, two, four = data.test(1), data.test(2), data.test(4)
    radius = float(np.hypot(one.reflector[2], one.reflector[0] + data.robot.dh[0, 2]))
    k1 = stiffness_from_length(one.wrench_flange[1], one.load_arm, radius, one.measured)  # (3.1), Fy as A.8
    lever = two.load_arm + two.reflector[0]
    force = float(np.linalg.norm(two.force_base))
    k2 = stiffness_from_length(force, two.load_arm, lever, two.measured)  # (3.3)
    relative_1 = _ROUNDING * _UM_DIGIT / one.measured
    relative_2 = _ROUNDING * _UM_DIGIT / two.measured
    stiffness = data.ratios * k1
    relative = np.hypot(relative_1, _ROUNDING * np.array(_RATIO_DIGIT) / data.ratios)
    stiffness[:2] = k1, k2
    relative[:2] = relative_1, relative_2
    rotation = four.measured / four.extra["radius"]
    weight = data.load_mass * GRAVITY
    return Recovery(
        stiffness=stiffness,
        printing_std=stiffness * relative,
        ratio_2_to_1=k2 / k1,
        ratio_2_to_1_std=float(k2 / k1 * np.hypot(relative_1, relative_2)),
        stiffness_4_from_rotation=stiffness_from_rotation(weight, four.load_arm, rotation),  # (3.17)
        load_4_implied=float(stiffness[3] * rotation / four.load_arm),
        equations=("3.1", "3.3", *("table 4.1 x K1",) * (JOINTS - 2)),
    )


def repeatability(data: ThesisData) -> float:
    """Standard deviation of a measured displacement [m], from repeated tests of joint 1.

    Tables 4.1 and 4.3 hold three pre-loaded identifications of joint 1 under the same load: 1, 1.015 and
    1.125 of the reference. Stiffness goes with 1 / L, so they were three displacements.
    """
    factors = np.concatenate([[1.0], data.table_4_3["preloaded"]])
    return float(np.std(data.test(1).measured / factors, ddof=1))
