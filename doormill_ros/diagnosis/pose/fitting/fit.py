"""Fits a set of causes to several series: placements, gross errors and typical sizes included."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from doormill_ros.arrays import FloatArray, IntArray
from doormill_ros.diagnosis.core.fitting.ridge import Block, Solution, add_up, learn
from doormill_ros.diagnosis.pose.fitting.linear import Linear
from doormill_ros.diagnosis.pose.fitting.noise import left_over
from doormill_ros.diagnosis.pose.fitting.placement import Seen, place_together
from doormill_ros.diagnosis.pose.fitting.problem import PoseProblem
from doormill_ros.measurements.sets.pose_set import PoseSet, placement_owners
from doormill_ros.robot_model.pose.causes.cause import PoseCause
from doormill_ros.robot_model.pose.chain import Placement, frames, per_axis
from doormill_ros.statistics import GROSS_SHARE
from doormill_ros.units import m_to_um

#: Contiguous blocks of a series, the units of cross-validation.
BLOCKS = 10
#: Every so many-th block of each series is left out together.
FOLDS = 5
#: Residuals beyond this many standard deviations lose weight, and beyond the second one all of it.
DOUBT, GROSS = 2.5, 7.0
#: Smallest part of the rows that is taken to be independent.
LEAST_SHARE = 0.02

Progress = Callable[[str], None]


@dataclass(eq=False)
class Fitted:
    """A fit and what cross-validation needs of it.

    Attributes:
        problem: Series, causes, current coefficients, placements and weights.
        learnt: Prior variances to begin with, shape (size,); None where nothing was learnt yet.
    """

    problem: PoseProblem
    learnt: FloatArray | None

    @cached_property
    def linear(self) -> list[Linear]:
        """Every series, linearised at the coefficients."""
        return [self.problem.linear(series) for series in range(len(self.problem.sets))]

    @cached_property
    def folds(self) -> list[list[Block]]:
        """Normal equations of what is left out together: of every series the blocks of a fold."""
        return [[one.normal_equations(fold(len(one.error), k)) for one in self.linear] for k in range(FOLDS)]

    @cached_property
    def whole(self) -> tuple[FloatArray, FloatArray]:
        """Normal equations of all rows, shapes (size, size) and (size,)."""
        return add_up((block for fold in self.folds for block in fold), self.problem.size)

    @cached_property
    def solution(self) -> Solution:
        """Coefficients with covariance and learnt sizes."""
        return learn(*self.whole, self.problem.layout, 4, self.learnt)


def contiguous(count: int) -> list[IntArray]:
    """Rows of the contiguous blocks of a series, shape (k,) each."""
    return [part for part in np.array_split(np.arange(count), BLOCKS) if len(part)]


def fold(count: int, number: int) -> IntArray:
    """Rows of a series that are left out together, shape (k,)."""
    return np.concatenate([np.zeros(0, dtype=int), *contiguous(count)[number::FOLDS]])


def place_nominally(sets: Sequence[PoseSet]) -> list[Placement]:
    """Placement of every series under the nominal model."""
    owner = placement_owners(sets)
    seen = [Seen(frames(data.view.transforms), data.position, data.rotation) for data in sets]
    found = {
        own: place_together([seen[i] for i, at in enumerate(owner) if at == own], (3e-4, 5e-4))
        for own in dict.fromkeys(owner)
    }
    return [found[own] for own in owner]


def fit_causes(
    sets: Sequence[PoseSet],
    causes: Sequence[PoseCause],
    placements: Sequence[Placement],
    passes: int = 3,
    progress: Progress = lambda line: None,
    start: Fitted | None = None,
) -> Fitted:
    """Iterate linearisation, learning of sizes, noise and weights.

    Args:
        sets: The series.
        causes: What may act.
        placements: Where to start.
        passes: Number of linearisations before the last one.
        progress: Told after every pass.
        start: An earlier fit whose weights and noise are good to begin with.
    """
    problem = PoseProblem(sets, causes, placements)
    if start is not None:
        problem.weights = [weight.copy() for weight in start.problem.weights]
        problem.sigmas = list(start.problem.sigmas)
        problem.share = start.problem.share
    solution: Solution | None = None
    for turn in range(passes):
        linear = [problem.linear(series) for series in range(len(sets))]
        H, g = add_up((one.normal_equations(np.arange(len(one.error))) for one in linear), problem.size)
        solution = learn(
            H, g, problem.layout, 3 if turn == 0 else 8, None if solution is None else solution.variance
        )
        problem.share = independent_share(linear, solution, problem.share)
        _move(problem, solution)
        errors = [problem.residual(series) for series in range(len(sets))]
        problem.sigmas = left_over(sets, errors)
        problem.weights = [
            weigh(error, sigma, one.oriented)
            for error, sigma, one in zip(errors, problem.sigmas, sets, strict=True)
        ]
        progress(
            f"pass {turn + 1} of {passes}: {problem.layout.size} coefficients, {_told(problem)} per axis left"
        )
    return Fitted(problem, None if solution is None else solution.variance)


def independent_share(linear: Sequence[Linear], solution: Solution, share: float) -> float:
    """Part of the rows that count as independent, from how far the blocks disagree with the common solution.

    With independent residuals the gradient of a block scatters by the square root of its own second derivative; where
    rows of a block err alike it scatters more, and every standard deviation with it.

    Args:
        linear: The series, weighted with `share`.
        solution: The common solution.
        share: Part of the rows that counted.
    """
    excess = []
    for one in linear:
        for pull, curvature in one.pulls(solution.x, contiguous(len(one.error))):
            acts = curvature > 1e-9 * curvature.max()
            excess.append(np.mean(pull[acts] ** 2 / curvature[acts]) / share)
    return float(np.clip(1.0 / max(np.mean(excess), 1e-12), LEAST_SHARE, 1.0))


def _told(problem: PoseProblem) -> str:
    """What is left, of series of different noise one after the other."""
    pairs = zip(problem.sigmas, problem.sets, strict=True)
    return ", ".join(
        dict.fromkeys(
            f"{m_to_um(sigma[0]):.0f} um" + (f" and {m_to_um(sigma[1]):.0f} urad" if data.oriented else "")
            for sigma, data in pairs
        )
    )


def _move(problem: PoseProblem, solution: Solution) -> None:
    problem.x = solution.x[: problem.layout.size].copy()
    problem.move(solution.x)


def deviation(error: FloatArray, sigma: tuple[float, float], oriented: bool) -> FloatArray:
    """Root mean square of the components measured, of six, in standard deviations, shape (n,)."""
    scale = per_axis(sigma, oriented)
    result: FloatArray = np.sqrt(np.sum((error * scale) ** 2, axis=1) / np.count_nonzero(scale))
    return result


def weigh(error: FloatArray, sigma: tuple[float, float], oriented: bool) -> FloatArray:
    """Weights of rows: 1 for ordinary ones, less for doubtful ones, 0 for gross errors, shape (n,)."""
    size = deviation(error, sigma, oriented)
    limit = max(GROSS, float(np.quantile(size, 1.0 - GROSS_SHARE)))
    weight = 1.0 / np.maximum(1.0, size / DOUBT) ** 2
    weight[size > limit] = 0.0
    return weight
