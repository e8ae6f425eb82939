"""A law that says the same of a named cause in other words is no law beside it; one that leaves it no size is."""

from copy import copy

import numpy as np
import pytest

from doormill_ros.diagnosis.core.fitting.fit import fit
from doormill_ros.diagnosis.law.place import place_of
from doormill_ros.diagnosis.law.remainder import Searched
from doormill_ros.diagnosis.law.search import LawSearch
from doormill_ros.diagnosis.motion.diagnosis import diagnose_motions
from doormill_ros.diagnosis.motion.needless import not_the_same, size_gone
from doormill_ros.diagnosis.motion.remainder import remainder
from doormill_ros.measurements.sets.motion_set import read_motion_set
from doormill_ros.robot_model.motion.law.dictionary import dictionary
from support.motion_world import Recording, record


@pytest.fixture(scope="module")
def asked(tmp_path_factory):
    """A joint with dry friction, what is left to explain beside that name, and all terms."""
    hidden = Recording(seconds=6.0).with_gear(2, friction=400.0, bristle=1e-7)
    data = read_motion_set(record(tmp_path_factory.mktemp("dry") / "set", hidden, 6))
    finding = diagnose_motions([data]).joints[1]
    assert [cause.key for cause in finding.named] == [("joint_friction", "joint 2")]
    rows = finding.problem.counted(finding.extended.delay)
    problem, base = remainder(finding.problem, finding.named, finding.extended.delay, [data.motions], rows)
    return finding, problem, base, dictionary(problem.case)


def told(term):
    return term.acts_on, term.driver, term.shape


def test_what_is_friction_in_other_words_is_no_law_beside_friction(asked):
    finding, problem, _, terms = asked
    beside = not_the_same(finding, problem, finding.named, terms)
    gone = {told(term) for term in terms} - {told(term) for term in beside}
    assert gone
    assert all(acts_on.startswith("friction") for acts_on, _, _ in gone)
    assert len(beside) > 0.8 * len(terms)
    assert {term.driver for term in beside} == {term.driver for term in terms}
    # Without a name nothing is in other words.
    assert len(not_the_same(finding, problem, [], terms)) == len(terms)


@pytest.mark.parametrize(("driver", "goes"), [("direction", True), ("angle of joint 1", False)])
def test_a_cause_that_a_law_leaves_no_size_is_found(asked, driver, goes):
    """Friction of which the reading is freed by hand, so that a law has all of it."""
    finding, problem, base, terms = asked
    (term,) = [one for one in terms if told(one) == ("joint angle", driver, "slope")]
    search = LawSearch(problem, [base], np.zeros(base.size), [term], place_of)
    problem = copy(problem)
    if goes:
        size = finding.extended.x[0][0]
        freed = problem.target[:, 0] - problem.effect(base)[:, 0] @ fit(problem, (base,)).theta
        problem.target = (freed + size * problem.effect(term)[:, 0, 0])[:, None]
    found = Searched(problem, search, fit(problem, (base, term)))
    assert size_gone(finding, found) is (finding.named[0] if goes else None)
