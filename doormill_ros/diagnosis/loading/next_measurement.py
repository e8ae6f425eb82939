"""Which trials would tell the remaining candidates apart: expected information between fitted models."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.diagnosis.core.beam import EQUAL
from doormill_ros.diagnosis.core.fit import Fit
from doormill_ros.diagnosis.core.ranking import first_largest, ranked
from doormill_ros.diagnosis.loading.possible_trials import LOAD_NAMES, chosen_of, possible_trials
from doormill_ros.diagnosis.loading.problem import LoadingDiagnosis, LoadingProblem
from doormill_ros.measurements.trials import Trials
from doormill_ros.robot_model.elastic.causes.cause import ElasticCause
from doormill_ros.units import m_to_um, rad_to_deg

PROPOSALS = 6  #: trials that are proposed
#: Log odds of all proposed trials below which they are none: forty times as many would not decide
HOPELESS = 0.1
DECIDED = 4.6  #: log odds at which two models count as told apart: 100 to 1


#: What shows a cause without any loading of the robot.
_DIRECT = {
    "wrench_gain": "hang a known mass on the force sensor",
    "wrench_frame_rotation": "hang a known mass on the force sensor and turn the flange",
    "tracker_scale": "measure a scale bar of known length with the tracker",
    "tracker_frame_rotation": "measure three fixed points of the robot's base with the tracker",
    "thermal_drift": "measure a fixed point again and again without any load",
    "reflector_position": "turn the last joints and measure where the reflector sits",
    "joint_offset": "calibrate the zero positions of the joints",
    "base_compliance": "put reflectors on the foot of the robot",
    "joint_cross_compliance": "put reflectors on both sides of the joint's bearing",
    "link_bending": "put reflectors on both ends of the link",
    "tool_compliance": "put one reflector on the flange and one on the tool",
}
_OTHER = "load the joint alone, with small and large weights and from both sides"


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
    favourite, rival, names = pair
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
        return NextMeasurement(*names, (), odds, _hopeless(names), None)
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


def _closest(
    diagnosis: LoadingDiagnosis,
) -> tuple[Fit[ElasticCause], Fit[ElasticCause], tuple[str, str]] | None:
    """The pair of models whose difference matters most for the verdict."""
    search, best = diagnosis.search, diagnosis.best
    options: list[tuple[float, Fit[ElasticCause], Fit[ElasticCause], tuple[str, str]]] = []
    for finding in diagnosis.findings:
        for other, found in search.rivals(best, finding.cause):
            nested = other.where == finding.cause.where and finding.cause.name in (
                other.generalises,
                other.name,
            )
            if nested and other not in finding.confusable:
                continue
            options.append(
                (found.held_out_score - best.held_out_score, best, found, (repr(finding.cause), repr(other)))
            )
    if not options:
        for next_best in search.ranked(f for f in search.fits.values() if f is not best)[:1]:
            options.append((search.total(next_best), best, next_best, (_title(best), _title(next_best))))
    if not options:
        return None
    closest = ranked(options, lambda option: option[0], lambda option: search.order(option[2]))[0]
    return closest[1:]


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


def _hopeless(names: tuple[str, str]) -> str:
    """That no loading of this kind helps, and what would."""
    helps = dict.fromkeys(_DIRECT.get(name.split(" at ")[0], _OTHER) for name in names)
    return (
        f"No loading of this kind tells {names[0]} from {names[1]}: wherever the robot stands and however loaded, "
        f"both predict the same. What would help: {', or '.join(helps)}."
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
