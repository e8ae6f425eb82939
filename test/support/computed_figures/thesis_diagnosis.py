"""What docs/diagnosis-thesis.md prints of the thesis' own loading tests."""

from __future__ import annotations

import re

import numpy as np

from doormill_ros.thesis.diagnosis import AS_GOOD, diagnose_thesis
from doormill_ros.thesis.loading_tests import load_thesis_data
from doormill_ros.thesis.predicted_lengths import cases_of, predicted_lengths
from doormill_ros.thesis.preload import read_preload_test
from doormill_ros.thesis.recovery import recover

DATA = load_thesis_data()
FOUND = diagnose_thesis(DATA)
GAP = read_preload_test(DATA)
TEST_3, TEST_4, TEST_5, TEST_6 = FOUND.rows[2:6]
SHORTEST, LONGEST = FOUND.test_6_range
FRICTION, STIFF_3, STIFF_2 = FOUND.candidates
JOINT_3_ALONE, JOINT_3_WITH_5 = FOUND.joint_3
DECIDES_NOTHING = AS_GOOD
FIRST, LAST = GAP.gap_ci95
#: Stiffness of joint 1 where the pre-load closed the gap [N m / rad].
CLOSED = GAP.torque / (GAP.torque / GAP.stiffness_if_friction - GAP.gap)
#: Of joint 3 over that of joint 1 in table 4.1.
PRINTED_RATIO = float(recover(DATA).stiffness[2] / recover(DATA).stiffness[0])


def other_side() -> float:
    """Length of test 6 with the springs of all joints and the reflector on the other side [m]."""
    cases = cases_of(DATA, recover(DATA).stiffness, -1)
    return float(predicted_lengths(DATA, cases, None, np.zeros(0))[5])


def apart() -> float:
    """How far two candidates would send the tool apart [mm]."""
    (said,) = re.findall(r"up to ([\d.]+) mm apart", FOUND.unchanged)
    return float(said)
