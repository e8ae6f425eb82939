"""Causes that hide each other, that do as well as another, or that nobody wrote down where they act."""

import numpy as np
import pytest

from doormill_ros.diagnosis.core.fitting.fit import fit
from doormill_ros.diagnosis.core.fitting.robust import trial_weights
from doormill_ros.diagnosis.core.searching.preview import Preview
from doormill_ros.diagnosis.loading.next_measurement import plan_next
from doormill_ros.diagnosis.loading.problem import LoadingProblem as Problem
from doormill_ros.robot_model.elastic.causes.registry import candidates
from support.diagnoses import diagnose_set


@pytest.fixture
def drawn(score, tmp_path):
    """Diagnose a set of the campaign, by its number."""

    def look(seed):
        kind = score.KINDS[seed % len(score.KINDS)]
        truth = score.draw_set(tmp_path / str(seed), seed, kind)
        diagnosis = diagnose_set(score.read_measurement_set(tmp_path / str(seed)))
        return diagnosis, score.judge(seed, kind, *truth, diagnosis)

    return look


def test_gains_of_pairs_are_those_of_least_squares(make_set):
    effect = {"cause": "link_bending", "where": "link 2", "parameters": {"EI": 1.5e7}}
    problem = Problem(make_set([effect], seed=90))
    library = [c for c in candidates(["ee"]) if len(c.starts(problem.case)) == 1]
    empty = fit(problem, ())
    numbers, gains = Preview(problem, library).pairs(empty)
    white = empty.prediction.white
    root = np.sqrt(trial_weights(np.sum(white**2, axis=1), False))[:, None]
    target = (white * root).ravel()
    assert np.all(np.diff(gains) <= 0.0)
    for (i, j), gain in list(zip(numbers, gains, strict=True))[::40]:
        slopes = [problem.slope(library[k], np.zeros(library[k].size)) * root[:, :, None] for k in (i, j)]
        both = np.concatenate(slopes, axis=2).reshape(len(target), -1)
        left = target - both @ np.linalg.lstsq(both, target, rcond=1e-7)[0]
        assert gain == pytest.approx(target @ target - left @ left, rel=1e-3, abs=1e-3)


def test_two_causes_that_hide_each_other_are_found(drawn):
    """A tracker that reads too little and a bent link 3: neither alone is among the ten most promising."""
    diagnosis, outcome = drawn(10013)
    assert outcome.right
    assert ("link_bending", "link 3") in [f.cause.key for f in diagnosis.findings]


def test_equals_are_compared_at_the_best_of_their_kinked_numbers(drawn):
    """Sensor gain and tracker scale stay equal beside a backlash, whose size depends on which it is."""
    diagnosis, outcome = drawn(20317)
    assert outcome.right
    gain, gap = diagnosis.findings
    assert {gain.cause.name, *(c.name for c in gain.confusable)} == {"wrench_gain", "tracker_scale"}
    [true] = [e["parameters"]["gap"] for e in outcome.truth if e["cause"] == "joint_backlash"]
    assert abs(gap.values[0] - true) < 2.0 * gap.std[0]


def test_two_causes_of_fewer_numbers_are_listed_beside_one(drawn):
    """Joint 6 turned one way and the sensor the other: to one reflector that is a reflector elsewhere."""
    diagnosis, outcome = drawn(10019)
    [finding] = diagnosis.findings
    assert finding.cause.name == "reflector_position"
    assert {c.key for c in finding.confusable} == {(e["cause"], e["where"]) for e in outcome.truth}


def test_a_hardening_spring_is_not_ruled_out_by_few_trials(drawn):
    diagnosis, outcome = drawn(40102)
    assert outcome.wrong == []
    keys = {diagnosis.findings[0].cause.key, *(c.key for c in diagnosis.findings[0].confusable)}
    assert keys >= {("joint_stiffness", "joint 4"), ("joint_hardening", "joint 4")}


def test_a_law_with_one_more_number_has_to_earn_its_name(drawn):
    """Noise bends a soft spring's line, as in one set of thousands: the other law stays open, and is put to test."""
    diagnosis, outcome = drawn(40450)
    assert outcome.wrong == []
    [finding] = diagnosis.findings
    assert finding.cause.key == ("joint_stiffness", "joint 3")
    assert [c.key for c in finding.confusable] == [("joint_hardening", "joint 3")]
    plan = plan_next(diagnosis)
    assert {plan.favourite, plan.rival} == {"joint_stiffness at joint 3", "joint_hardening at joint 3"}


@pytest.mark.parametrize("seed", [10025, 10185])
def test_a_gap_without_known_direction_opens_either_way_under_no_torque(drawn, seed):
    """Trials in which even the sign of the torque is noise are no gross errors."""
    diagnosis, outcome = drawn(seed)
    assert outcome.right
    assert diagnosis.outliers == ()
    assert diagnosis.verdict == "explained"
