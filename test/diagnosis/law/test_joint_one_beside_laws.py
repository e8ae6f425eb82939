"""A base that turns about joint 1 is that joint's spring in other words: neither hides a wrong spring beside a law."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from doormill_ros.diagnosis.core.diagnosis import diagnose_problem
from doormill_ros.diagnosis.core.fitting.fit import fit
from doormill_ros.diagnosis.loading import laws as loading_laws
from doormill_ros.diagnosis.loading.laws import with_laws
from doormill_ros.diagnosis.loading.other_words import acts, in_other_words
from doormill_ros.diagnosis.loading.problem import LoadingProblem
from doormill_ros.measurements.sets.measurement_set import read_measurement_set
from doormill_ros.measurements.trials import Reflector
from doormill_ros.robot_model.elastic.causes.joint_stiffness import JointStiffness
from doormill_ros.robot_model.elastic.law.dictionary import dictionary
from support.law_worlds.world import draw

JOINT_1 = "joint_stiffness", "joint 1"


@pytest.mark.parametrize(
    "seed",
    [
        # Joint 2 has a one-sided spring.
        52208,
        # Joint 3 gives way in waves; a base that turns by the angle of joint 3 hardly varies.
        52019,
    ],
)
def test_a_wrong_spring_of_joint_1_is_named_beside_a_law(tmp_path, seed):
    world = draw(seed)
    world.write(tmp_path)
    found = with_laws(diagnose_problem(LoadingProblem(read_measurement_set(tmp_path))))
    assert (found.verdict, [cause.key for cause in found.examination.named]) == (
        "partly_explained",
        [JOINT_1],
    )
    assert {law.where for law in found.characterised.laws} == {world.truth["where"]}
    (finding,) = found.findings
    true = world.truth["named"]["parameters"]["stiffness"]
    assert abs(finding.values[0] - true) < 4.0 * finding.std[0]


@pytest.fixture(scope="module")
def problem(tmp_path_factory):
    folder = tmp_path_factory.mktemp("joint_1")
    draw(52208).write(folder)
    return LoadingProblem(read_measurement_set(folder))


def test_what_turns_the_base_says_the_same_unless_a_reflector_stands_on_its_foot(problem):
    cause = JointStiffness("joint 1")

    def same(asked):
        terms = dictionary(asked.case, list(asked.data.reflectors))
        return {acts(term) for term in in_other_words(asked, fit(asked, (cause,)), cause, terms)}

    assert same(problem) == {("joint 1", "spring"), ("base", "base turn")}
    data = problem.data
    foot = replace(data, reflectors={**data.reflectors, "elbow": Reflector(0, np.array([0.5, 0.4, 0.1]))})
    assert same(LoadingProblem(foot)) == {("joint 1", "spring")}


@pytest.mark.parametrize(("acts_on", "mean"), [("base turn", True), ("base tilt", False)])
def test_the_name_may_be_the_mean_of_a_law_that_turns_the_base(problem, acts_on, mean):
    cause = JointStiffness("joint 1")
    terms = dictionary(problem.case, list(problem.data.reflectors))
    term = next(one for one in terms if (one.acts_on, one.driver) == (acts_on, "angle of joint 2"))
    diagnosis = SimpleNamespace(problem=problem, examination=SimpleNamespace(named=(cause,)))
    law = SimpleNamespace(where="base", terms=(term,))
    found = SimpleNamespace(laws=(law,), fit=fit(problem, (cause, term)))
    assert loading_laws._mean_parts(diagnosis, found, terms) == ([cause] if mean else [])
