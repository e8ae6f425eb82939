"""Which trials would tell the remaining candidates apart: expected information between fitted models."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.diagnosis.core.fit import Fit
from doormill_ros.diagnosis.core.ranking import first_largest, ranked
from doormill_ros.diagnosis.core.search import EQUAL
from doormill_ros.diagnosis.loading.diagnosis import LoadingDiagnosis
from doormill_ros.diagnosis.loading.problem import LoadingProblem
from doormill_ros.measurements.trials import Reflector, Trials
from doormill_ros.robot.kinematics import Kinematics
from doormill_ros.robot_model.elastic.causes.cause import Cause
from doormill_ros.statistics import uniform
from doormill_ros.units import rad_to_deg

PROPOSALS = 6  #: trials that are proposed
_POSTURES = 24  #: postures that are considered
HOPELESS = (
    0.1  #: log odds of all proposed trials below which they are none: forty times as many would not decide
)
DECIDED = 4.6  #: log odds at which two models count as told apart: 100 to 1
#: Loads considered, base axes.
_LOADS = np.vstack([np.eye(3), -np.eye(3)])
#: Where a reflector could be added: at the edge of the foot, or a hand's breadth off a link's frame [m].
_NEW_BASE, _NEW = np.array([0.5, 0.4, 0.1]), np.array([0.15, 0.1, 0.1])
_LOAD_NAMES = ("+x", "+y", "+z", "-x", "-y", "-z")


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
    pool, loads = _pool(diagnosis.problem.data, seed)
    mine, other = _predict(pool, favourite), _predict(pool, rival)
    chosen, gains = _choose(mine, other)
    trials = []
    for i, gain in zip(chosen, gains, strict=True):
        difference = float(np.linalg.norm(mine.value[i] - other.value[i]))
        trials.append(
            ProposedTrial(
                pool.q[i],
                _LOAD_NAMES[loads[i]],
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
        *names, tuple(trials), odds, _sentence(names, trials, odds, decided), _rows(pool, chosen)
    )


@dataclass(frozen=True, eq=False)
class _Forecast:
    """Whitened predictions (n, 3), their Jacobian (n, 3, p), covariance (p, p), and metres (n, 3)."""

    white: FloatArray
    jacobian: FloatArray
    covariance: FloatArray
    value: FloatArray


def _closest(diagnosis: LoadingDiagnosis) -> tuple[Fit[Cause], Fit[Cause], tuple[str, str]] | None:
    """The pair of models whose difference matters most for the verdict."""
    search, best = diagnosis.search, diagnosis.best
    options: list[tuple[float, Fit[Cause], Fit[Cause], tuple[str, str]]] = []
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


def _title(found: Fit[Cause]) -> str:
    return " + ".join(map(repr, found.members)) or "no cause at all"


def _pool(data: Trials, seed: int) -> tuple[Trials, FloatArray]:
    """Trials to choose from: postures within the tested range, six loads, two approaches, all reflectors."""
    low, high = data.q.min(axis=0), data.q.max(axis=0)
    middle, half = (low + high) / 2.0, np.maximum((high - low) / 2.0, 0.5)
    _, first = np.unique(data.configuration, return_index=True)
    postures = np.vstack([data.q[first][:8], middle + half * (2.0 * uniform((_POSTURES, 6), seed) - 1.0)])[
        :_POSTURES
    ]
    reflectors = dict(data.reflectors)
    carried = {reflector.link for reflector in reflectors.values()}
    for link in range(7):
        if link not in carried:
            reflectors[f"new on link {link}"] = Reflector(link, _NEW_BASE if link == 0 else _NEW)
    grid = np.array(
        [
            (posture, load, approach, reflector)
            for posture in range(len(postures))
            for load in range(6)
            for approach in (-1, 1)
            for reflector in range(len(reflectors))
        ]
    )
    q = postures[grid[:, 0]]
    force = float(np.median(np.linalg.norm(data.wrench[:, :3], axis=1)))
    axes = Kinematics(data.dh).forward(q)[:, :3, :3]
    angle = data.wrench_frame_rotation
    c, s = np.cos(angle), np.sin(angle)
    to_sensor = np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
    wrench = np.zeros((len(grid), 6))
    wrench[:, :3] = np.einsum("ij,nkj,nk->ni", to_sensor, axes.transpose(0, 2, 1), force * _LOADS[grid[:, 1]])
    names = np.array(list(reflectors))
    n = len(grid)
    return Trials(
        robot=data.robot,
        dh=data.dh,
        joint_stiffness=data.joint_stiffness,
        noise=data.noise,
        wrench_frame_rotation=data.wrench_frame_rotation,
        load_point=data.load_point,
        reflectors=reflectors,
        trial=np.arange(1, n + 1),
        time=np.full(n, float(np.median(data.time))),
        dt=np.full(n, float(np.median(data.dt))),
        temperature=np.full(n, np.nan),
        q=q,
        direction=np.repeat(grid[:, 2:3].astype(float), 6, axis=1),
        wrench=wrench,
        reflector=names[grid[:, 3]],
        displacement=np.zeros((n, 3)),
    ), grid[:, 1]


def _rows(pool: Trials, rows: list[int]) -> Trials:
    index = np.array(rows, dtype=int)
    per_trial = (
        "trial",
        "time",
        "dt",
        "temperature",
        "q",
        "direction",
        "wrench",
        "reflector",
        "displacement",
    )
    return replace(pool, **{name: getattr(pool, name)[index] for name in per_trial})


def _predict(pool: Trials, found: Fit[Cause]) -> _Forecast:
    problem = LoadingProblem(pool)
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
        f"reflector {first.reflector}: the two differ there by {1e6 * first.difference:.0f} um; "
        f"{len(trials)} such trials are proposed."
    )
