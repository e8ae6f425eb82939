"""What the simulation of the thesis left out: its six loading tests, questioned.

Table 4.2 prints one length a test, so the tests decide little: a cause can be fitted to some of
them and must predict the others. What the printed data cannot decide is said so.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares

from doormill_ros.arrays import BoolArray, FloatArray
from doormill_ros.diagnosis.core.fitting.ranking import ranked
from doormill_ros.diagnosis.loading.path_shift import DOOR, paths_apart
from doormill_ros.robot_model.elastic.causes.cause import ElasticCause
from doormill_ros.robot_model.elastic.causes.joint_stiffness import JointStiffness
from doormill_ros.robot_model.elastic.causes.registry import candidates
from doormill_ros.robot_model.elastic.load_case import LoadCase
from doormill_ros.robot_model.extended_model import SizedCause
from doormill_ros.thesis.loading_tests import ThesisData
from doormill_ros.thesis.predicted_lengths import cases_of, load_point, own_joint_length, predicted_lengths
from doormill_ros.thesis.recovery import recover, repeatability
from doormill_ros.units import m_to_mm

#: Finer end of the tracker's resolution in section 3.1 [m].
TRACKER = 10e-6
#: Tests whose lengths a model can be held against; where the reflector of test 6 sat is not printed.
DECIDABLE = (1, 2, 3, 4, 5)
#: A rival that fits within this of the best in squared deviations is as good (odds of 20 to 1).
AS_GOOD = 6.0


@dataclass(frozen=True, eq=False)
class ThesisRow:
    """One test: lengths in metres.

    Attributes:
        joint: The joint under test.
        measured, simulated: Table 4.2.
        own_joint: With the joint under test giving way alone.
        all_joints: With all joint springs of table 4.1.
        extended: With the established cause as well.
        held_out: The same, the cause fitted without this test; NaN where nothing else holds the cause.
        left_out: What the thesis' simulation left out, or why that cannot be said.
    """

    joint: int
    measured: float
    simulated: float
    own_joint: float
    all_joints: float
    extended: float
    held_out: float
    left_out: str


@dataclass(frozen=True, eq=False)
class ThesisCandidate:
    """A cause fitted to tests 1 to 5.

    Attributes:
        cause: The cause.
        value, std: Its parameter and the standard deviation of that.
        misfit: Squared deviations of the tests with it.
    """

    cause: ElasticCause
    value: float
    std: float
    misfit: float


@dataclass(frozen=True, eq=False)
class ThesisDiagnosis:
    """All six tests.

    Attributes:
        candidates: Causes that bring the tests together equally well, the closest fit first. They are one finding.
        next_misfit: Squared deviations with the best cause that is none of them.
        before: Squared deviations of tests 1 to 5 without any cause.
        rows: The tests, extended by the first candidate.
        test_6_range: Shortest and longest prediction of test 6 over the two sides of its reflector [m].
        joint_3: Stiffness of joint 3 over that of joint 1 as test 3 alone says, and tests 3 and 5 together.
        joint_3_plain: The first again with a load straight down that bends joints 2 and 3 only.
        unchanged: Why model.yaml holds none of the candidates.
    """

    candidates: tuple[ThesisCandidate, ...]
    next_misfit: float
    before: float
    rows: tuple[ThesisRow, ...]
    test_6_range: tuple[float, float]
    joint_3: tuple[float, float]
    joint_3_plain: float
    unchanged: str

    @property
    def cause(self) -> ElasticCause:
        """Of the closest fit."""
        return self.candidates[0].cause

    @property
    def confusable(self) -> tuple[ElasticCause, ...]:
        """Those of the others."""
        return tuple(candidate.cause for candidate in self.candidates[1:])

    @property
    def misfit(self) -> tuple[float, float]:
        """Squared deviations of tests 1 to 5 before, and with the closest fit."""
        return self.before, self.candidates[0].misfit


def diagnose_thesis(data: ThesisData) -> ThesisDiagnosis:
    """Question the simulation of table 4.2."""
    stiffness = recover(data).stiffness
    cases = {side: cases_of(data, stiffness, side) for side in (1, -1)}
    std = float(np.hypot(TRACKER, repeatability(data)))
    measured = np.array([test.measured for test in data.tests])
    use = np.array([test.joint in DECIDABLE for test in data.tests])

    def misfit(cause: ElasticCause | None, theta: FloatArray, rows: BoolArray) -> FloatArray:
        off: FloatArray = predicted_lengths(data, cases[1], cause, theta)[rows] - measured[rows]
        return off / std

    def only(*joints: int) -> BoolArray:
        return np.array([test.joint in joints for test in data.tests])

    library = [cause for cause in candidates(["ee"]) if cause.stage == "robot" and cause.size == 1]
    fits = ranked([(cause, *_fit(misfit, cause, use)) for cause in library], lambda fit: fit[2])
    good = [fit for fit in fits if fit[2] < fits[0][2] + AS_GOOD]
    found = tuple(_candidate(*fit, cases[1][0]) for fit in good)
    cause, theta, _, slope = good[0]
    plain = predicted_lengths(data, cases[1], None, np.zeros(0))
    full = predicted_lengths(data, cases[1], cause, theta)
    rows = []
    for i, test in enumerate(data.tests):
        held = np.nan
        others = use.copy()
        others[i] = False
        left, _, strength = _fit(misfit, cause, others)
        # A fit that hardly knows its parameter predicts nothing.
        if use[i] and strength > 0.5 * slope / len(others):
            held = float(predicted_lengths(data, cases[1], cause, left)[i])
        rows.append(
            ThesisRow(
                test.joint,
                test.measured,
                test.simulated,
                own_joint_length(data, cases[1][i], test, stiffness),
                float(plain[i]),
                float(full[i]),
                held,
                LEFT_OUT[i],
            )
        )
    spring = JointStiffness("joint 3")
    third = [
        float(spring.values(_fit(misfit, spring, only(*joints))[0], cases[1][0])[0] / stiffness[0])
        for joints in ((3,), (3, 5))
    ]
    sides = [float(predicted_lengths(data, cases[side], cause, theta)[5]) for side in (1, -1)]
    models = {repr(c.cause): [SizedCause(c.cause, np.array([c.value]))] for c in found}
    return ThesisDiagnosis(
        candidates=found,
        next_misfit=fits[len(good)][2],
        before=float(np.sum(misfit(None, np.zeros(0), use) ** 2)),
        rows=tuple(rows),
        test_6_range=(min(sides), max(sides)),
        joint_3=(third[0], third[1]),
        joint_3_plain=_plain_ratio(data, cases[1][2], stiffness),
        unchanged=_unchanged(*paths_apart(data.robot.name, data.robot.dh, stiffness, models)),
    )


def _candidate(
    cause: ElasticCause, theta: FloatArray, cost: float, slope: float, case: LoadCase
) -> ThesisCandidate:
    value = float(cause.values(theta, case)[0])
    step = 1e-4
    rate = (float(cause.values(theta + step, case)[0]) - value) / step
    return ThesisCandidate(cause, value, abs(rate) / float(np.sqrt(slope)), cost)


def _unchanged(pair: tuple[str, str], apart: float) -> str:
    return (
        f"model.yaml is the unchanged model: five printed lengths cannot tell the candidates apart; {pair[0]} and "
        f"{pair[1]} would send the tool up to {m_to_mm(apart):.3f} mm apart on the door {DOOR}."
    )


def _plain_ratio(data: ThesisData, case: LoadCase, stiffness: FloatArray) -> float:
    """Stiffness of joint 3 over joint 1 by test 3 if its load hangs straight down and bends joints 2 and 3 only."""
    test = data.test(3)
    weight = float(np.linalg.norm(test.force_base))
    moved = []
    for k in (1, 2):
        torque = float(
            case.axis(k)[0] @ np.cross(load_point(data, test) - case.origin[0, k], [0.0, 0.0, -weight])
        )
        moved.append(torque / stiffness[k] * case.joint_twist(k)[0, :3])
    # |moved by joint 2 + s moved by joint 3| is what was measured: a quadratic equation for s.
    a, b = float(moved[1] @ moved[1]), float(moved[0] @ moved[1])
    c = float(moved[0] @ moved[0]) - test.measured**2
    return float(stiffness[2] / stiffness[0] * a / (-b + np.sqrt(b * b - a * c)))


LEFT_OUT = (
    "nothing that one number can show: the stiffness comes from this very displacement",
    "nothing that one number can show, as in test 1",
    "joint 2, which moves this reflector as far as joint 3 does; with it the springs overshoot, so joint 3 was "
    "identified too soft or friction carried part of the load",
    "cannot be decided: the rotation printed for the simulation follows from no printed stiffness, and the load of "
    "this test is not printed",
    "part of joints 2 and 3, each of which moves the reflector as far as joint 5 does",
    "joint 5, which bends under the same rope; how much of it shows depends on the side of the reflector, which is "
    "not printed, so the deviation cannot be assigned",
)


def _fit(
    misfit: Callable[[ElasticCause | None, FloatArray, BoolArray], FloatArray],
    cause: ElasticCause,
    rows: BoolArray,
) -> tuple[FloatArray, float, float]:
    """Theta, squared deviations, and squared slope of the deviations by theta."""
    best = least_squares(
        lambda theta: misfit(cause, theta, rows), 0.1 * cause.scale, bounds=(cause.lower - 1e-9, cause.upper)
    )
    return best.x, float(2.0 * best.cost), float(np.sum(best.jac**2))
