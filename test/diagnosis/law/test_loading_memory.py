"""What settles or remembers within a joint takes no name of its springs, and laws say where it is and predict it."""

import numpy as np
import pytest

from doormill_ros.diagnosis.core.diagnosis import diagnose_problem
from doormill_ros.diagnosis.law.search import LawSearch
from doormill_ros.diagnosis.loading.law_place import place_of
from doormill_ros.diagnosis.loading.problem import LoadingProblem
from doormill_ros.measurements.sets.measurement_set import read_measurement_set
from doormill_ros.robot_model.elastic.law.dictionary import dictionary
from support.law_worlds.world import draw


def measured(folder, seed):
    """A hidden law alone in a simulated lab: what was hidden, and the set."""
    world = draw(seed)
    world.write(folder)
    assert world.truth["named"] is None
    return world.truth, LoadingProblem(read_measurement_set(folder))


@pytest.mark.parametrize(
    ("seed", "law", "resembles"),
    [
        # Warm before most was measured: nearly all of it is a softer spring.
        (169, "warming", ["joint_stiffness"]),
        # Loops that a softer spring beside friction nearly follows; only the loadings before tell.
        (200, "hysteresis", ["joint_stiffness", "joint_friction"]),
    ],
)
def test_what_changes_with_clock_or_path_takes_no_name_of_a_spring(tmp_path, seed, law, resembles):
    truth, problem = measured(tmp_path, seed)
    assert truth["law"] == law
    diagnosis = diagnose_problem(problem)
    assert diagnosis.verdict == "unexplained"
    assert diagnosis.findings == ()
    refused = {cause.key for cause, _ in diagnosis.examination.refused}
    assert refused & {(name, truth["where"]) for name in resembles}


def test_loops_of_which_a_softer_spring_leaves_hardly_more_than_noise_take_no_name(tmp_path):
    truth, problem = measured(tmp_path, 936)
    assert (truth["law"], truth["where"]) == ("hysteresis", "joint 6")
    diagnosis = diagnose_problem(problem)
    softer = next(
        fit for fit in diagnosis.search.fits.values() if _names(fit) == ["joint_stiffness at joint 6"]
    )
    assert np.sqrt(np.mean(softer.held_out**2)) < 1.1 * truth["noise"]["floor"]
    assert (diagnosis.verdict, diagnosis.findings) == ("unexplained", ())
    assert {member.where for member in diagnosis.best.members if not member.named} == {"joint 6"}


def _names(fit):
    return [repr(member) for member in fit.members]


@pytest.mark.parametrize(
    ("seed", "law", "acts_on"),
    [
        (168, "hysteresis", "spring"),
        # Softer where the load opens the link, which no sign of a joint's torque says.
        (192, "one_sided_spring", "crack"),
        # Narrower than between two knots of a curve.
        (171, "worn_sector", "spring"),
    ],
)
def test_a_law_of_a_joint_or_link_is_told_by_its_own_driver(tmp_path, seed, law, acts_on):
    truth, problem = measured(tmp_path, seed)
    assert truth["law"] == law
    at_place = [
        term
        for term in dictionary(problem.case, ["ee", "tip", "elbow"])
        if term.where == truth["where"] and term.acts_on.split()[0] in ("spring", "hinge", "crack", "bending")
    ]
    search = LawSearch(problem, (), np.zeros(0), at_place, place_of)
    best = search.run()
    first = search.laws(best)[0]
    assert first.acts_on.startswith(acts_on)
    assert place_of(first).key == (truth["where"], truth["driver"])
    assert np.sqrt(np.mean(best.held_out**2)) < 1.1 * truth["noise"]["floor"]
