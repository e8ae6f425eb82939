"""Where the next door will stand beside what was named: a level that may have stepped once, tried from every door on.

Which cause moved the doors, so few or such doors may not tell; where they stand they show all the same. The level is
that of Bayes' rule over the doors at which it may have stepped (Chernoff and Zacks, Estimating the current mean of a
normal distribution which is subjected to changes in time, 1964): no other is nearer to the next door on average.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.diagnosis.parts.fitting.course import InTime
from doormill_ros.diagnosis.parts.fitting.moved import moved
from doormill_ros.diagnosis.parts.fitting.place_scatter import place_error, scatter_between
from doormill_ros.diagnosis.parts.fitting.placement import seen_columns
from doormill_ros.diagnosis.parts.fitting.problem import DoorProblem
from doormill_ros.distributions import chi2_sf

_STAYS = 0.5  #: probability, before anything was measured, that the level never stepped
_CHANCE = 1e-3  #: to see a level where there is none


@dataclass(frozen=True, eq=False)
class Level:
    """Where doors stand beside where they were seen.

    Attributes:
        place: Along base y and z [m], and about x [rad]; shape (3,).
        covariance: Of that, shape (3, 3).
        corner: About which they turn, shape (3,) [m].
        since: Number of the door from which on they most likely do.
    """

    place: FloatArray
    covariance: FloatArray
    corner: FloatArray
    since: int

    @property
    def seen(self) -> bool:
        """Whether it is more than chance."""
        distance = float(self.place @ np.linalg.solve(self.covariance, self.place))
        return chi2_sf(distance, len(self.place)) < _CHANCE

    @property
    def size(self) -> float:
        """How far the corner stands elsewhere [m]."""
        return float(np.linalg.norm(self.place[:2]))

    def std(self, points: FloatArray) -> float:
        """Standard deviation of what it displaces, root mean square over points of shape (n, 3) [m]."""
        arm = points - self.corner
        turned = np.stack([-arm[:, 2], arm[:, 1]], axis=1)
        ways = np.concatenate([np.tile(np.eye(2), (len(arm), 1, 1)), turned[:, :, None]], axis=2)
        return float(np.sqrt(np.einsum("nai,ij,naj->", ways, self.covariance, ways) / len(arm)))


def level_beside(problem: DoorProblem, members: Sequence[InTime], theta: FloatArray) -> Level | None:
    """The level of what a model leaves; None where not every door was measured against its recorded pose.

    Args:
        problem: The doors.
        members: Of the model.
        theta: Its numbers, shape (p,).
    """
    placings = [door.placing for door in problem.doors if door.placing is not None]
    if len(placings) < len(problem.doors):
        return None
    stated = np.diag(np.mean(placings, axis=0))
    corner: FloatArray = np.mean([door.T_base_door[:3, 3] for door in problem.doors], axis=0)
    left = (problem.measured - moved(problem.case, members, theta)[0]) / problem.noise
    places, errors = [], []
    for number in range(len(problem.doors)):
        rows = problem.door == number
        columns = seen_columns(problem.points.point[rows], problem.points.normal[rows], corner)
        white = columns / problem.noise[rows, None]
        size = np.sqrt(stated)
        places.append(size * np.linalg.lstsq(white * size, left[rows], rcond=1e-6)[0])
        errors.append(place_error(white, stated))
    found, error = np.array(places), np.array(errors)
    own = scatter_between(found, [door.recipe for door in problem.doors], stated, error)
    place, covariance, since = current_level(found, error + np.diag(own), np.diag(stated))
    # The tool is as much on the other side of a door that moved.
    return Level(-place, covariance, corner, since)


def current_level(
    places: FloatArray, spread: FloatArray, prior: FloatArray
) -> tuple[FloatArray, FloatArray, int]:
    """The level at the last door: mean and covariance, shape (3,) and (3, 3), and since which door it most likely is.

    Args:
        places: Of the doors in order, shape (d, 3).
        spread: Covariance of each about the level, shape (d, 3, 3).
        prior: Covariance of a level, before it began to be seen and after a step, shape (3, 3).
    """
    count = len(places)
    chances = np.full(count, (1.0 - _STAYS) / max(count - 1, 1))
    chances[0] = _STAYS
    log, means, covariances = [], [], []
    for step in range(count):
        earlier = _level(places[:step], spread[:step], prior)[2]
        mean, covariance, evidence = _level(places[step:], spread[step:], prior)
        log.append(np.log(chances[step]) + earlier + evidence)
        means.append(mean)
        covariances.append(covariance)
    weight = np.exp(np.array(log) - max(log))
    weight /= weight.sum()
    each = np.array(means)
    mean = weight @ each
    away = each - mean
    within = np.einsum("k,kij->ij", weight, np.array(covariances))
    return mean, within + np.einsum("k,ki,kj->ij", weight, away, away), int(np.argmax(weight))


def _level(places: FloatArray, spread: FloatArray, prior: FloatArray) -> tuple[FloatArray, FloatArray, float]:
    """Mean, covariance and log evidence, less what every level has, of one that stays at some doors."""
    weight = np.linalg.inv(spread).reshape(-1, 3, 3)
    precision = np.linalg.inv(prior) + weight.sum(axis=0)
    covariance = np.linalg.inv(precision)
    mean = covariance @ np.einsum("dij,dj->i", weight, places)
    within = float(np.einsum("di,dij,dj->", places, weight, places))
    evidence = -0.5 * (within - mean @ precision @ mean + np.linalg.slogdet(prior @ precision)[1])
    return mean, covariance, float(evidence)
