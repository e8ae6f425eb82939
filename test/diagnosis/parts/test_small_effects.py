"""An effect that moves the points by less than twice what the mill is known to has no name."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from doormill_ros.diagnosis.parts.effects.shift import Warming
from doormill_ros.diagnosis.parts.fitting.course import InTime
from doormill_ros.diagnosis.parts.fitting.known import SHARE
from doormill_ros.diagnosis.parts.fitting.problem import FLANK, DoorProblem
from doormill_ros.diagnosis.parts.kind import Inspections
from support.gauged_shift import HINGE_DOORS, gauged_shift
from support.shift_worlds import diagnosed, draw_shift, inspected, judged


@pytest.fixture(scope="module")
def problem(tmp_path_factory: pytest.TempPathFactory) -> DoorProblem:
    """Of two doors in a world as assumed."""
    return Inspections().problem(
        inspected(gauged_shift(tmp_path_factory.mktemp("doors"), {"seed": 1}, HINGE_DOORS[:2], 1))
    )


@pytest.mark.parametrize("joint", [1, 2, 3])
def test_a_spring_is_named_from_twice_what_the_mill_is_known_to_on(problem: DoorProblem, joint: int) -> None:
    spring, force = (
        next(one for one in problem.candidates() if one.key == key)
        for key in (("joint_stiffness", f"joint {joint}"), ("process_force", "tool"))
    )
    unit = problem.derivative_alone(spring)[:, 0] * problem.noise
    per = float(np.sqrt(np.mean(unit[unit != 0.0] ** 2)))
    for share, refused in ((1.95, True), (2.05, False)):
        theta = np.array([share * FLANK / per])
        [check] = problem.objections([spring], theta, spring)
        assert check.fails == refused
        assert check.margins[0].value == pytest.approx(share)
        # Beside another force the same spring gives way by as much more.
        [check] = problem.objections([force, spring], np.concatenate([[0.5], theta]), spring)
        assert check.margins[0].value == pytest.approx(1.5 * share, rel=1e-6)
    [check] = problem.objections([force, spring], np.array([0.5, 0.0]), spring)
    assert check.fails
    assert "0.0 um" in check.against


def test_a_drift_is_known_to_a_share_of_itself(problem: DoorProblem) -> None:
    spring = next(one for one in problem.candidates() if one.key == ("joint_stiffness", "joint 1"))
    warming, growth = InTime(Warming(0.5)), 2e4
    drift = growth * warming.effect.displacement(problem.case)[:, 0]
    alone, beside = (
        problem.objections(members, np.array([growth, 0.1][-len(members) :]), spring)[0].margins[0].value
        for members in ([spring], [warming, spring])
    )
    assert alone / beside == pytest.approx(np.hypot(1.0, SHARE * np.sqrt(np.mean(drift**2)) / FLANK))
    assert alone > 1.5 * beside


def test_a_spring_off_by_a_tenth_is_no_cause_beside_a_weight_that_nobody_told(tmp_path: Path) -> None:
    # 22 kg turn the mill by 0.4 mrad. Its lower edge cuts floors 4 um deeper, another amount in every posture: that
    # looks like a spring, whose effect a weight of another size all but undoes.
    drawn = draw_shift(8020)
    diagnosis = diagnosed(tmp_path / "shift", drawn, 8020)
    found = judged(diagnosis, drawn.hidden)
    assert (found.missed, found.wrong, found.late) == ((), (), ())
    assert ("joint_stiffness", "joint 2") in {cause.key for cause, _ in diagnosis.examination.refused}
