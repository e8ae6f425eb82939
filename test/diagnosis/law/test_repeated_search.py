"""What a law of a loading test has to stand: a clock that numbers the postures, and a search that has not seen them."""

from dataclasses import replace

import numpy as np
import pytest

from doormill_ros.diagnosis.core.fitting.fit import fit
from doormill_ros.diagnosis.law.characterise import characterise
from doormill_ros.diagnosis.law.labels import without_labels
from doormill_ros.diagnosis.law.repeated import Repeated
from doormill_ros.diagnosis.law.search import LawSearch
from doormill_ros.diagnosis.law.some_rows import SomeRows
from doormill_ros.diagnosis.loading.law_place import place_of
from doormill_ros.diagnosis.loading.possible_trials import chosen_of
from doormill_ros.diagnosis.loading.problem import LoadingProblem
from doormill_ros.measurements.sets.measurement_set import read_measurement_set
from doormill_ros.robot_model.elastic.causes.registry import build_cause
from doormill_ros.robot_model.elastic.law.dictionary import dictionary
from support.law_worlds.law import Effect, Law
from support.law_worlds.session import REFLECTORS
from support.law_worlds.world import draw


def _pulled(session):
    """A hose about joint 6 that pulls beside the sensor."""
    reading = np.zeros((len(session.q), 6))
    reading[:, 0] = -40.0 * np.sin(session.q[:, 5])
    return Effect(reading=reading)


@pytest.fixture(scope="module")
def hose(tmp_path_factory):
    """A set in which every posture was visited twice."""
    folder = tmp_path_factory.mktemp("hose")
    law = Law("hose", "sensor", "angle of joint 6", _pulled, 1.0, {})
    replace(draw(2), law=law, size=1.0, named=None).write(folder)
    return read_measurement_set(folder)


@pytest.fixture(scope="module")
def once(hose):
    """The first visits alone, four trials each."""
    configuration = hose.configuration
    return chosen_of(hose, [i for i in range(len(hose)) if np.sum(configuration[:i] == configuration[i]) < 4])


def _terms(data):
    problem = LoadingProblem(data)
    return problem, without_labels(
        dictionary(problem.case, list(REFLECTORS)), problem.case, problem.configuration
    )


def _bent(terms):
    stiff = ("level", "slope", "line", "past")
    return [term for term in terms if term.driver == "time" and term.shape not in stiff]


def test_a_law_bends_over_time_only_where_postures_were_visited_again(hose, once):
    _, (terms, labels) = _terms(hose)
    assert _bent(terms)
    assert "time" not in labels
    _, (terms, labels) = _terms(once)
    assert not _bent(terms)
    assert "time" in labels
    # A drift or a slip may still be told, and what changes from trial to trial is no label.
    assert {term.shape for term in terms if term.driver == "time"} >= {"slope", "line", "past"}
    assert "time under load" not in labels


def test_some_rows_are_fitted_as_a_set_of_these_trials_alone(hose):
    rows = np.arange(len(hose)) % 3 > 0
    members = [build_cause("joint_stiffness", "joint 4"), build_cause("link_bending", "link 2")]
    own = fit(SomeRows(LoadingProblem(hose), rows), members)
    peer = fit(LoadingProblem(chosen_of(hose, list(np.flatnonzero(rows)))), members)
    np.testing.assert_allclose(own.theta, peer.theta, rtol=1e-9)
    np.testing.assert_allclose(own.held_out, peer.held_out, rtol=1e-9, atol=1e-15)


def test_a_pull_by_an_angle_is_told_and_what_stands_in_for_it_is_not(once):
    problem, (terms, _) = _terms(once)
    kept = np.ones(len(problem), dtype=bool)
    sensor = [term for term in terms if term.where == "sensor"]
    search = LawSearch(problem, (), np.zeros(0), sensor, place_of)
    best = search.run()
    (law,) = search.laws(best)
    assert (law.acts_on, law.driver) == ("force bias", "angle of joint 6")
    unseen = Repeated(search, kept).unseen_residual(search.most)
    assert np.sqrt(np.mean(unseen**2)) < 1.1 * problem.noise_floor
    # Without a word for it the circumstances of the postures fit what these leave, and predict no other posture.
    others = [term for term in terms if term.driver in ("time", "temperature")]
    search = LawSearch(problem, (), np.zeros(0), others, place_of)
    best = search.run()
    assert np.mean(best.held_out**2) < 0.8 * np.mean(search.starts()[0].held_out ** 2)
    assert Repeated(search, kept).unseen_residual(search.most) is None
    assert characterise(search, kept)[0] is None
