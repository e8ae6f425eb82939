"""A fit ends where its own weights want it, and a number pays for what it cannot leave out."""

from types import SimpleNamespace

import numpy as np
import pytest

from doormill_ros.diagnosis.core.fitting.fit import bounds, fit, normal_equations
from doormill_ros.diagnosis.core.fitting.price import LEFT_OUT, price_of_number
from doormill_ros.diagnosis.core.searching.beam import BeamSearch
from doormill_ros.diagnosis.loading.kind import LoadingTests
from doormill_ros.measurements.sets.measurement_set import read_measurement_set
from support.source_tree import ROOT

EXAMPLE = ROOT / "docs" / "diagnosis_example"


@pytest.fixture(scope="module")
def problem():
    """A test with gross errors among its trials."""
    return LoadingTests().problem([read_measurement_set(EXAMPLE)])


def smooth(problem):
    """Causes alone that are smooth and linear in what they do."""
    return [cause for cause in problem.candidates() if not cause.kinked and cause.name.endswith("stiffness")]


def test_gross_errors_do_not_steer_a_fit(problem):
    asked = 0
    for cause in smooth(problem):
        found = fit(problem, (cause,))
        lower, upper = bounds((cause,))
        if np.any((found.theta <= lower) | (found.theta >= upper)) or np.all(found.weights > 0.0):
            continue
        hessian, descent = normal_equations(found.prediction, found.weights)
        step = np.linalg.solve(hessian, descent)
        # In its own standard deviations, with the rows that it says were set aside.
        assert np.sqrt(step @ hessian @ step) < 0.02, cause
        asked += 1
    assert asked >= 5


def test_a_number_that_stays_where_rows_are_left_out_pays_for_that(problem):
    search = BeamSearch(problem, problem.candidates(), lambda line: None)
    friction = next(cause for cause in problem.candidates() if cause.name == "joint_friction")
    stiffness = next(cause for cause in problem.candidates() if cause.name == "joint_stiffness")
    price = price_of_number(problem.components * len(problem))
    for cause, more in ((friction, LEFT_OUT), (stiffness, 0.0)):
        found = search.fit((cause,))
        assert search.total(found) == pytest.approx(found.held_out_score + price + more)


@pytest.mark.parametrize("finite", [False, True])
def test_a_check_predicts_as_the_diagnosed_test_was_predicted(problem, finite):
    read = read_measurement_set(EXAMPLE)
    own = problem.with_angles(finite)
    found = fit(own, ())
    diagnosis = SimpleNamespace(problem=own, extended=found, characterised=None)
    checked = LoadingTests().check(diagnosis, read)
    left = found.prediction.residual
    assert checked["baseline"]["rmse"] == pytest.approx(np.sqrt(np.mean(left**2)), rel=1e-9)


def test_finite_angles_make_a_difference_that_a_check_can_miss(problem):
    to_first_order, finite = (fit(problem.with_angles(way), ()).prediction.residual for way in (False, True))
    assert np.abs(to_first_order - finite).max() > 1e-9


def test_single_trials_of_one_configuration_are_as_many_groups(tmp_path):
    (tmp_path / "set.yaml").write_bytes((EXAMPLE / "set.yaml").read_bytes())
    rows = (EXAMPLE / "trials.csv").read_text().splitlines()[:9]
    (tmp_path / "trials.csv").write_text("\n".join(rows) + "\n")
    diagnosis = LoadingTests().diagnose([read_measurement_set(tmp_path)], lambda line: None)
    assert len(np.unique(diagnosis.problem.configuration)) == 1
    squares = diagnosis.question.holdout_squares(diagnosis.baseline, diagnosis.kept)
    # One group alone would be drawn again and again, and make an interval of no width.
    assert len(squares) == diagnosis.kept.sum() > 5
    assert squares.sum() == pytest.approx(np.sum(diagnosis.baseline.held_out[diagnosis.kept] ** 2))
