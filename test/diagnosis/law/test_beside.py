"""Terms beside columns that are projected out: the fits, held-out rows and previews of the long way, to rounding."""

import numpy as np
import pytest

from doormill_ros.diagnosis.core.fitting.fit import fit
from doormill_ros.diagnosis.core.searching.preview import Preview
from doormill_ros.diagnosis.law.beside import Beside
from doormill_ros.diagnosis.law.linear import Established, LinearProblem
from doormill_ros.diagnosis.law.remainder import searched_once
from doormill_ros.robot_model.candidate import Candidate

ROWS, COMPONENTS, ESTABLISHED = 90, 3, 40


class Drawn(Candidate):
    """A term of given columns."""

    named = False

    def __init__(self, where, columns):
        super().__init__(where)
        self.name, self.columns = "drawn", columns
        size = columns.shape[2]
        self.scale, self.lower, self.upper = np.ones(size), np.full(size, -1e6), np.full(size, 1e6)

    def effect(self, case):
        return self.columns

    def values(self, theta, case):
        return theta


@pytest.fixture(params=["noise alone", "doubtful rows", "gross errors"])
def remainder(request):
    """Problem, established columns, and terms: strangers to the columns, and two that these all but replace."""
    rng = np.random.default_rng(4)

    def drawn(size):
        return rng.normal(size=(ROWS, COMPONENTS, size))

    columns, weak = drawn(ESTABLISHED), drawn(2)
    # What the established columns hardly say, the weak pull keeps them from following in full.
    columns[:, :, :2] = columns[:, :, 2:4] + 1e-3 * weak
    shapes = [drawn(1), drawn(3), drawn(2), columns[:, :, 8:10] + 1e-4 * drawn(2), weak + 1e-3 * drawn(2)]
    sigma = np.array([1.0, 2.0, 0.5]) * 1e-4
    noise = rng.normal(size=(ROWS, COMPONENTS))
    noise = (
        noise
        * {"noise alone": 1.0, "doubtful rows": rng.standard_t(2.0, (ROWS, 1)), "gross errors": 1.0}[
            request.param
        ]
    )
    if request.param == "gross errors":
        noise[::15] *= 60.0
    target = sigma * (noise + 0.7 * shapes[0][:, :, 0] + 3.0 * columns[:, :, 5])
    problem = LinearProblem(target, sigma, None, np.arange(ROWS) // 6, 1e-4)
    base = Established(sigma[:, None] * columns, np.eye(ESTABLISHED), np.zeros(ESTABLISHED))
    return problem, base, [Drawn(f"place {i}", sigma[:, None] * one) for i, one in enumerate(shapes)]


@pytest.mark.parametrize("chosen", [(), (0,), (1, 0), (3, 2, 1)])
def test_a_fit_is_that_of_all_columns_together(remainder, chosen):
    problem, base, terms = remainder
    members = (base, *(terms[i] for i in chosen))
    start = 0.1 * np.random.default_rng(len(chosen)).normal(size=sum(member.size for member in members))
    short, long = Beside(problem, base).fit(members, [start]), fit(problem, members, [start])
    assert short.members == long.members
    for name in ("theta", "weights", "held_out", "held_out_cost", "free"):
        one, other = getattr(short, name), getattr(long, name)
        assert one == pytest.approx(other, rel=1e-7, abs=1e-8 * np.max(np.abs(other))), name
    for name in ("residual", "white", "cost"):
        one, other = getattr(short.prediction, name), getattr(long.prediction, name)
        assert one == pytest.approx(other, rel=1e-7, abs=1e-8 * np.max(np.abs(other))), name
    assert (short.score, short.held_out_score) == pytest.approx((long.score, long.held_out_score), rel=1e-8)
    assert np.all(np.isnan(short.covariance)), "nobody may take what was not found for a number"


def test_a_preview_is_that_of_all_columns_together(remainder):
    problem, base, terms = remainder
    beside, preview = Beside(problem, base), Preview(problem, terms)
    for members in ((base,), (base, terms[1]), (base, terms[1], terms[2])):
        short, long = beside.fit(members), fit(problem, members)
        # What has joined gains nothing more but rounding.
        rest = [i for i, term in enumerate(terms) if term not in members]
        assert beside.gains(short, terms)[rest] == pytest.approx(preview.gains(long)[rest], rel=1e-5)


def test_the_worlds_are_what_they_are_called(remainder, request):
    problem, base, _ = remainder
    weights = fit(problem, (base,)).weights
    kind = request.node.callspec.params["remainder"]
    assert np.any(weights == 0.0) == (kind != "noise alone")
    assert np.any((weights > 0.0) & (weights < 1.0)) == (kind == "doubtful rows")


def test_a_model_without_the_columns_is_fitted_the_long_way(remainder):
    problem, base, terms = remainder
    short, long = Beside(problem, base).fit(terms[:1]), fit(problem, terms[:1])
    assert np.array_equal(short.theta, long.theta)
    assert np.array_equal(short.covariance, long.covariance)


def test_what_is_established_needs_no_other_terms(remainder):
    problem, base, _ = remainder
    found = searched_once(problem, base, [])
    assert found.best.members == (base,)
