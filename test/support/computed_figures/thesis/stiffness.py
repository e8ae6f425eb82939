"""What docs/thesis.md prints of the stiffness recovered from the thesis' figures."""

from __future__ import annotations

import functools

import numpy as np
from scipy.optimize import least_squares

from doormill_ros.arrays import FloatArray
from doormill_ros.robot.kinematics import Kinematics
from doormill_ros.thesis.fit import FIGURES, FigureModel, fit_thesis, overall_std
from doormill_ros.thesis.formulas import joint_displacement, stiffness_from_length
from doormill_ros.thesis.loading_tests import load_thesis_data
from doormill_ros.thesis.recovery import recover, repeatability
from doormill_ros.units import GRAVITY
from support.computed_figures.thesis.facts import FACTS

DATA = load_thesis_data()
RECOVERED = recover(DATA)
FIT = fit_thesis(DATA)
ONE = DATA.test(1)
FORCE_1 = abs(float(ONE.wrench_flange[1]))
RADIUS_1 = float(np.hypot(*FACTS["stiffness"]["tests"]["joint1"]["reflector_radius"]))
WEIGHT = DATA.load_mass * GRAVITY

STIFFNESS = RECOVERED.stiffness.tolist()
ROUNDING = (RECOVERED.printing_std / RECOVERED.stiffness).tolist()
FITTED = FIT.stiffness.tolist()
DEVIATION = (overall_std(RECOVERED, FIT) / RECOVERED.stiffness).tolist()
JOINT_4_APART = RECOVERED.stiffness_4_from_rotation / RECOVERED.stiffness[3] - 1.0
REPETITION = repeatability(DATA)
REPETITION_SHARE = REPETITION / ONE.measured
FIGURES_FITTED = len(FIGURES)
#: How far the fit of all joints stays from the measured length of test 5, as a share.
FIT_OFF_TEST_5 = abs(float(FIT.fitted[4]) / DATA.test(5).measured - 1.0)


def _joint_6(side: int) -> tuple[float, float]:
    """Stiffness of joint 6 in the fit of all joints with the reflector on a side, and its misfit."""
    model = FigureModel(DATA, RECOVERED, side)
    target, sigma = model.target(), model.sigma()

    def off(x: FloatArray) -> FloatArray:
        return (model.predict(np.exp(x)) - target) / sigma

    start = np.log(RECOVERED.stiffness)
    found = [
        least_squares(off, start + np.array([0, 0, 0, 0, 0, shift]), x_scale=0.1)
        for shift in (-1.0, -0.5, 0.0, 0.5, 1.0)
    ]
    best = min(found, key=lambda result: float(result.cost))
    return float(np.exp(best.x[5])), float(2.0 * best.cost)


@functools.cache
def side_away() -> float:
    """Of joint 6 with the reflector away from the load, which must fit better [N m / rad]."""
    away, load = _joint_6(-1), _joint_6(1)
    assert away[1] < load[1]
    return away[0]


@functools.cache
def side_of_load() -> float:
    """Of joint 6 with the reflector on the load's side [N m / rad]."""
    return _joint_6(1)[0]


@functools.cache
def joint_6_found_over_true() -> float:
    """What equation 3.30 makes of joint 6 of a robot whose joints all give way, over its stiffness."""
    kinematics = Kinematics(DATA.robot)
    q = np.radians([0.0, 0.0, 0.0, 0.0, 90.0, 0.0])
    R = kinematics.forward(q)[:3, :3]
    # The load and the reflector of test/measurements/test_raw_set.py.
    wrench = np.concatenate([R @ [178.0, 0.0, 0.0], R @ [0.0, 0.0, -89.5]])
    at_load = kinematics.jacobian(q, (0.0, 0.0, DATA.tool_z))
    reflector = kinematics.jacobian(q, (0.088, 0.25, 0.207))[:3]
    stiffness = np.array(DATA.robot.stiffness)
    moved = reflector @ (at_load.T @ wrench / stiffness)
    length = float(np.linalg.norm(moved - joint_displacement(at_load, wrench, 1, stiffness[0])))
    found = stiffness_from_length(89.5, 1.0, float(np.hypot(0.088, 0.25)), length)
    return found / float(stiffness[5])


def joint_6_without_5() -> float:
    """Joint 6 of the thesis with joint 5's share taken out of the formula [N m / rad]."""
    return STIFFNESS[5] / joint_6_found_over_true()
