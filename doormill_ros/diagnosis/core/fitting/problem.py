"""What search and fit need to know of any kind of data: how well a list of candidates predicts it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Protocol, Self, TypeVar

import numpy as np

from doormill_ros.arrays import BoolArray, FloatArray, IntArray
from doormill_ros.diagnosis.core.words.margin import Check
from doormill_ros.diagnosis.core.words.wording import METRES, Unit
from doormill_ros.robot_model.candidate import Candidate

FOLDS = 10  #: at most; a fold is one or several whole configurations


#: Kind of candidate that a problem knows how to predict with.
C = TypeVar("C", bound=Candidate[Any])
_C = TypeVar("_C", bound=Candidate[Any], contravariant=True)


@dataclass(frozen=True, eq=False)
class Prediction:
    """What a model says about every trial.

    Attributes:
        residual: Measured minus predicted in the unit of the problem, shape (n, c) with as many columns as the
            problem likes: 3 for a displacement of which one or all components are measured.
        white: The same in standard deviations, shape (n, c).
        cost: -2 log likelihood of each trial (squared distance when nothing is hidden), shape (n,).
        jacobian: Derivative of the whitened prediction by theta, shape (n, c, p), or None.
        spread: Whitened pseudo-rows for undecided hidden states, shape (n, c), and their derivative.
    """

    residual: FloatArray
    white: FloatArray
    cost: FloatArray
    jacobian: FloatArray | None = None
    spread: tuple[FloatArray, FloatArray] | None = None

    @property
    def derived(self) -> FloatArray:
        """The Jacobian of a prediction that was asked for it, shape (n, c, p)."""
        assert self.jacobian is not None, "predict with derivative=True"
        return self.jacobian


class Problem(Protocol[_C]):
    """One set of trials made ready for fitting.

    Attributes:
        components: How many of the c columns of a residual are measured.
        noise_floor: Root mean square of the noise over all components.
        unit: Of residuals and noise floor.
        configuration: What is left out together, shape (n,).
        folds: Fold of each trial, shape (n,).
    """

    components: int
    noise_floor: float
    unit: Unit = METRES
    configuration: IntArray
    folds: IntArray

    def __len__(self) -> int: ...

    @property
    def case(self) -> Any:
        """What the candidates look at."""

    def predict(self, members: Sequence[_C], theta: FloatArray, derivative: bool = False) -> Prediction:
        """Residuals, likelihood and derivatives of a model of some candidates with their numbers theta, shape (p,)."""

    def slope(self, cause: _C, theta: FloatArray) -> FloatArray:
        """Whitened derivative of the prediction by one candidate alone, shape (n, c, p)."""

    def measured_part(self, white: FloatArray) -> FloatArray:
        """Residual in the units of measurement, shape (n, c), of a whitened one."""


class Examined(Problem[C], Protocol[C]):
    """A problem of which a whole diagnosis can be made.

    Attributes:
        resolution: Root mean square of residuals by which models have to differ to be told apart, however many trials
            there are; 0 where nothing but noise stands against it.
    """

    resolution: float = 0.0

    def candidates(self) -> list[C]:
        """Everything that may be wrong, and the patterns that may not be named."""

    def bent(self) -> Self | None:
        """The same trials by a finer model, where that could matter."""

    def cuts(self) -> dict[str, BoolArray]:
        """Ways to cut the trials in two by the words for them, each shape (n,); both halves have to say the same."""

    def groupings(self) -> Sequence[IntArray]:
        """Group of every trial, shape (n,): an effect sits together in few of them, slips of the hand do not."""

    def turning(self, residual: FloatArray, gross: BoolArray) -> tuple[str, float]:
        """What trials marked gross, shape (n,), point along most, and the chance that slips would as much."""

    def objections(self, members: Sequence[C], theta: FloatArray, cause: C) -> Sequence[Check]:
        """What the data have to say against one member of a model beside all that holds for any; theta (p,)."""
        return ()

    def labels(self) -> IntArray:
        """Numbers of the trials as the data give them, shape (n,)."""


def split(members: Sequence[C], theta: FloatArray) -> list[tuple[C, FloatArray]]:
    """Each cause with its part of theta, shape (p,)."""
    parts: list[tuple[C, FloatArray]] = []
    at = 0
    for cause in members:
        parts.append((cause, theta[at : at + cause.size]))
        at += cause.size
    return parts


def make_folds(configuration: IntArray, folds: int = FOLDS) -> IntArray:
    """Deal whole configurations to folds of similar size, shape (n,); lone trials when there is one only."""
    numbers, counts = np.unique(configuration, return_counts=True)
    if len(numbers) == 1:
        return np.arange(len(configuration)) % min(folds, len(configuration))
    load = np.zeros(min(folds, len(numbers)), dtype=int)
    fold_of = {}
    for i in np.argsort(-counts, kind="stable"):
        fold = int(np.argmin(load))
        fold_of[numbers[i]] = fold
        load[fold] += counts[i]
    return np.array([fold_of[c] for c in configuration])
