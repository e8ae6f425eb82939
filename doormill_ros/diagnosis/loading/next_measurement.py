"""Which trials would tell the remaining candidates apart: expected information between fitted models."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.diagnosis.core.fitting.fit import Fit
from doormill_ros.diagnosis.core.fitting.ranking import first_largest, ranked
from doormill_ros.diagnosis.core.searching.beam import EQUAL
from doormill_ros.diagnosis.loading.possible_trials import LOAD_NAMES, chosen_of, possible_trials
from doormill_ros.diagnosis.loading.problem import LoadingDiagnosis, LoadingProblem
from doormill_ros.measurements.trials import Trials
from doormill_ros.robot_model.elastic.causes.cause import ALONE, ElasticCause
from doormill_ros.units import m_to_um, rad_to_deg

PROPOSALS = 6  #: trials that are proposed
#: Log odds of all proposed trials below which they are none: forty times as many would not decide
HOPELESS = 0.1
DECIDED = 4.6  #: log odds at which two models count as told apart: 100 to 1


@dataclass(frozen=True, eq=False)
class ProposedTrial:
    """One loading worth doing.

    Attributes:
        q: Joint angles, shape (6,) [rad].
        load: Name of the load direction, base axes.
        force: Size of the force [N].
        wrench: The load in sensor axes, shape (6,) [N, N m].
        direction: Last motion of all joints, -1 or +1.
        reflector: Where to measure; a new one names its link.
        difference: What the two models disagree by there, root sum of squares [m].
        information: Expected log odds gained, natural units.
    """

    q: FloatArray
    load: str
    force: float
    wrench: FloatArray
    direction: int
    reflector: str
    difference: float
    information: float


@dataclass(frozen=True, eq=False)
class NextMeasurement:
    """What to measure next and why.

    Attributes:
        favourite, rival: What would be told apart.
        trials: Proposed, the most telling first; none where no loading helps.
        odds: Expected log odds of all proposed trials together.
        sentence: The same in one sentence.
        plan: All trials as a set without measured displacements.
    """

    favourite: str
    rival: str
    trials: tuple[ProposedTrial, ...]
    odds: float
    sentence: str
    plan: Trials | None


def plan_next(diagnosis: LoadingDiagnosis, seed: int = 0) -> NextMeasurement:
    """Choose the trials that separate the best model from its closest rival."""
    pair = _closest(diagnosis)
    if pair is None:
        return NextMeasurement("", "", (), 0.0, "Nothing is in doubt: no further trial is needed.", None)
    favourite, rival, names = pair.favourite, pair.rival, pair.names
    decided = rival.held_out_score > favourite.held_out_score + 3.0 * EQUAL
    pool, loads = possible_trials(diagnosis.problem.data, seed)
    finite = diagnosis.problem.finite
    mine, other = _predict(pool, favourite, finite), _predict(pool, rival, finite)
    chosen, gains = _choose(mine, other)
    trials = []
    for i, gain in zip(chosen, gains, strict=True):
        difference = float(np.linalg.norm(mine.value[i] - other.value[i]))
        trials.append(
            ProposedTrial(
                pool.q[i],
                LOAD_NAMES[loads[i]],
                float(np.linalg.norm(pool.wrench[i, :3])),
                pool.wrench[i],
                int(pool.direction[i, 0]),
                str(pool.reflector[i]),
                difference,
                gain,
            )
        )
    odds = float(sum(gains))
    if odds < HOPELESS:
        return NextMeasurement(*names, (), odds, _hopeless(pair), None)
    return NextMeasurement(
        *names, tuple(trials), odds, _sentence(names, trials, odds, decided), chosen_of(pool, chosen)
    )


@dataclass(frozen=True, eq=False)
class _Forecast:
    """Whitened predictions (n, 3), their Jacobian (n, 3, p), covariance (p, p), and metres (n, 3)."""

    white: FloatArray
    jacobian: FloatArray
    covariance: FloatArray
    value: FloatArray


@dataclass(frozen=True, eq=False)
class _Pair:
    """Two models, what tells them from each other in words, and what shows that without any loading."""

    favourite: Fit[ElasticCause]
    rival: Fit[ElasticCause]
    names: tuple[str, str]
    direct: tuple[str, str]

    @property
    def behind(self) -> float:
        """By how much the rival's score is larger."""
        return self.rival.held_out_score - self.favourite.held_out_score


def _closest(diagnosis: LoadingDiagnosis) -> _Pair | None:
    """The pair of models whose difference matters most for the verdict."""
    search, best = diagnosis.search, diagnosis.best
    options: list[_Pair] = []
    for finding in diagnosis.findings:
        for other, found in search.rivals(best, finding.cause):
            nested = other.where == finding.cause.where and finding.cause.name in (
                other.generalises,
                other.name,
            )
            if nested and other not in finding.confusable:
                continue
            names = (repr(finding.cause), repr(other))
            options.append(_Pair(best, found, names, _direct(finding.cause, other)))
    if not options:
        for next_best in search.ranked(f for f in search.fits.values() if f is not best)[:1]:
            names = (_title(best), _title(next_best))
            options.append(_Pair(best, next_best, names, _direct(_first(best), _first(next_best))))
    if not options:
        return None
    return ranked(options, lambda pair: pair.behind, lambda pair: search.order(pair.rival))[0]


def _direct(one: ElasticCause | None, other: ElasticCause | None) -> tuple[str, str]:
    """What shows each of two causes without any loading of the robot."""
    first, second = ((cause.direct if cause is not None else "") or ALONE for cause in (one, other))
    return first, second


def _first(found: Fit[ElasticCause]) -> ElasticCause | None:
    return found.members[0] if found.members else None


def _title(found: Fit[ElasticCause]) -> str:
    return " + ".join(map(repr, found.members)) or "no cause at all"


def _predict(pool: Trials, found: Fit[ElasticCause], finite: bool) -> _Forecast:
    problem = LoadingProblem(pool, finite)
    # Patterns are tied to the times and angles of the measured trials: leave them out of a forecast.
    members = tuple(cause for cause in found.members if cause.named)
    theta = np.concatenate([np.zeros(0)] + [found.theta[found.part(cause)] for cause in members])
    keep = np.concatenate(
        [np.zeros(0, dtype=int)] + [np.arange(len(found.theta))[found.part(c)] for c in members]
    )
    prediction = problem.predict(members, theta, derivative=True)
    jacobian = prediction.jacobian if prediction.jacobian is not None else np.zeros((len(pool), 3, 0))
    return _Forecast(-prediction.white, jacobian, found.covariance[np.ix_(keep, keep)], -prediction.residual)


def _choose(mine: _Forecast, other: _Forecast) -> tuple[list[int], list[float]]:
    """Greedy choice; after every trial the rival may adapt its numbers to what it would see."""
    shift = np.zeros(other.jacobian.shape[2])
    covariance = other.covariance.copy()
    own = mine.covariance
    chosen: list[int] = []
    gains: list[float] = []
    for _ in range(PROPOSALS):
        gap = mine.white - other.white - other.jacobian @ shift
        spread = np.eye(3) + other.jacobian @ covariance @ other.jacobian.transpose(0, 2, 1)
        spread += mine.jacobian @ own @ mine.jacobian.transpose(0, 2, 1)
        information = 0.5 * np.einsum("ni,ni->n", gap, np.linalg.solve(spread, gap[:, :, None])[:, :, 0])
        information[chosen] = -1.0
        i = first_largest(information)
        chosen.append(i)
        gains.append(float(information[i]))
        slope = other.jacobian[i]
        gain = covariance @ slope.T @ np.linalg.inv(np.eye(3) + slope @ covariance @ slope.T)
        shift = shift + gain @ gap[i]
        covariance = covariance - gain @ slope @ covariance
    return chosen, gains


def _hopeless(pair: _Pair) -> str:
    """That no loading of this kind helps, and what would."""
    return (
        f"No loading of this kind tells {pair.names[0]} from {pair.names[1]}: wherever the robot stands and however "
        f"loaded, both predict the same. What would help: {', or '.join(dict.fromkeys(pair.direct))}."
    )


def _sentence(names: tuple[str, str], trials: list[ProposedTrial], odds: float, decided: bool) -> str:
    first = trials[0]
    angles = ", ".join(f"{angle:.0f}" for angle in rad_to_deg(first.q))
    if odds < DECIDED:
        return (
            f"No loading of this kind tells {names[0]} from {names[1]} at once (the {len(trials)} best trials have odds"
            f" of {np.exp(min(odds, 20.0)):.1f} to 1): repeat these, or check one of them directly."
        )
    purpose = (
        f"No other candidate is left; to confirm {names[0]} against the closest, {names[1]},"
        if decided
        else f"To tell {names[0]} from {names[1]},"
    )
    return (
        f"{purpose} load {first.force:.0f} N along base {first.load} at joint angles "
        f"({angles}) deg with every joint last moved {'forwards' if first.direction > 0 else 'backwards'} and measure "
        f"reflector {first.reflector}: the two differ there by {m_to_um(first.difference):.0f} um; "
        f"{len(trials)} such trials are proposed."
    )
