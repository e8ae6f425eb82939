"""What docs/thesis.md prints of the thesis' displacements against ours, and of those that contradict each other."""

from __future__ import annotations

import math

import numpy as np

from doormill_ros.measurements.loading import displacement_per_compliance
from doormill_ros.robot.kinematics import Kinematics
from doormill_ros.thesis.comparison import compare_with_simulation
from doormill_ros.thesis.fit import overall_std
from doormill_ros.thesis.outcome import find_contradictions
from support.computed_figures.thesis.facts import FACTS
from support.computed_figures.thesis.stiffness import DATA, FIT, RECOVERED, REPETITION

STD = overall_std(RECOVERED, FIT)
ROWS = compare_with_simulation(DATA, RECOVERED, STD)
OTHER_SIDE = compare_with_simulation(DATA, RECOVERED, STD, -1)[5]
#: Vectors with all joints giving way, base axes [m].
VECTORS = [row.predicted_vector.tolist() for row in ROWS]
#: Lengths that each joint alone would give [m].
ALONE = [row.by_joint.tolist() for row in ROWS]
#: Components that the thesis prints of its simulation, a test each; test 4 has none.
SIMULATED = [test.simulated_components.tolist() for test in DATA.tests]
COMPONENTS = [float(np.linalg.norm(test.simulated_components)) for test in DATA.tests]
#: The numbers of every contradiction, by its name.
NUMBERS = {found.name: found.numbers for found in find_contradictions(DATA, RECOVERED)}

_LOADINGS = DATA.loadings(REPETITION)
_KINEMATICS = Kinematics(DATA.robot)
_MOVED = displacement_per_compliance(_KINEMATICS, _LOADINGS) / RECOVERED.stiffness
#: Joint 3 alone in test 3, base axes [m].
JOINT_3_ALONE = _MOVED[2][:, 2].tolist()
_LOADINGS.reflector[5, 1] *= -1.0
_MOVED_AWAY = displacement_per_compliance(_KINEMATICS, _LOADINGS) / RECOVERED.stiffness
#: Joints 2 and 6 in test 6, the reflector on the other side, base axes [m].
JOINTS_2_AND_6 = _MOVED_AWAY[5][:, [1, 5]].sum(axis=1).tolist()
#: How far these are off the simulated components, its last two axes exchanged, as shares.
OFF_2_AND_6 = [
    abs(abs(ours) / theirs - 1.0)
    for ours, theirs in zip(JOINTS_2_AND_6, np.array(SIMULATED[5])[[0, 2, 1]], strict=True)
]

ROTATION_4 = FACTS["stiffness"]["tests"]["joint4"]["simulated_rotation"]
_RATIOS = NUMBERS["agreement of tests 1 and 2"]
FARTHER_1 = _RATIOS["simulated_over_measured_1"] - 1.0
FARTHER_2 = _RATIOS["simulated_over_measured_2"] - 1.0
#: By how many standard deviations of a repetition test 3 ought to have gone farther.
MISSED_3 = (ROWS[2].predicted - ROWS[2].measured) / REPETITION
OFF_5 = ROWS[4].predicted / ROWS[4].measured - 1.0
SHORT_5 = 1.0 - ROWS[4].simulated / ROWS[4].measured

#: Lengths from which the places of the reflectors follow [m].
REFLECTOR_3 = DATA.test(3).reflector.tolist()
FLANGE = float(DATA.robot.dh[5, 1])
FLANGE_AND_REFLECTOR = FLANGE + REFLECTOR_3[2]
REFLECTOR_6 = DATA.test(6).reflector.tolist()
RADIUS_6 = math.hypot(REFLECTOR_6[0], REFLECTOR_6[1])

#: What the table and the components of tests 1 and 2 are off the measured lengths [m].
OFF_BY_TABLE = [abs(row.simulated - row.measured) for row in ROWS]
OFF_BY_COMPONENTS = [abs(length - row.measured) for length, row in zip(COMPONENTS, ROWS, strict=True)]
#: Rotation of test 4 by the spring [rad].
BY_SPRING_4 = ROTATION_4 / NUMBERS["simulated rotation of test 4"]["ratio"]
_ARMS = NUMBERS["arm of the load in tests 1, 5 and 6"]
ARM_5_LESS_1 = abs(_ARMS["arm_5"] - _ARMS["arm_1"])
#: As a share of the arm that all tests take.
ARM_SHARE = ARM_5_LESS_1 / DATA.test(5).load_arm
_FORCES = NUMBERS["load of test 2"]
SOFTER_2 = (
    1.0 - (_FORCES["force_1"] + _FORCES["force_6"]) / 2.0 / FACTS["stiffness"]["tests"]["joint2"]["force"]
)
STIFFER_5 = NUMBERS["angle of test 5"]["stiffness_factor"] - 1.0
FOUND_OVER_TRUE_5 = 1.0 / NUMBERS["angle of test 5"]["stiffness_factor"]
