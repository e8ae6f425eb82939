"""What a diagnosis leaves where everything is linear in its numbers: fixed columns of causes, and terms beside them."""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from typing import Any, Self

import numpy as np

from doormill_ros.arrays import FloatArray, IntArray
from doormill_ros.diagnosis.core.fitting.fit import Fit
from doormill_ros.diagnosis.core.fitting.problem import Prediction, make_folds
from doormill_ros.diagnosis.core.words.wording import METRES, Unit
from doormill_ros.robot_model.candidate import Candidate


class Established(Candidate[Any]):
    """Everything that a diagnosis has fitted already: it stays, and its numbers are fitted anew beside every law."""

    name = "established"

    def __init__(self, columns: FloatArray, coefficients: FloatArray, unsaid: FloatArray) -> None:
        """Keep what stays.

        Args:
            columns: Its columns, shape (n, c, p).
            coefficients: What they are of a fit's coefficients, shape (m, p).
            unsaid: Variance of these coefficients in directions of which no column speaks, shape (m,).
        """
        super().__init__("model")
        self.columns, self.coefficients, self.unsaid = columns, coefficients, unsaid
        count = columns.shape[2]
        self.scale, self.lower, self.upper = (np.full(count, v) for v in (1e3, -np.inf, np.inf))

    def effect(self, case: Any) -> FloatArray:
        """Its columns, shape (n, c, p)."""
        return self.columns

    def values(self, theta: FloatArray, case: Any) -> FloatArray:
        """The fit's coefficients, by which they change, shape (m,)."""
        return self.coefficients @ theta


def established(columns: FloatArray, sigma: FloatArray, reach: FloatArray) -> Established:
    """Columns of a fit, shape (n, c, p), less what its numbers are too small to say.

    Args:
        columns: For a unit of every number.
        sigma: Standard deviation of each component of a row, shape (c,).
        reach: Usual size of every number, shape (p,), infinite where nothing holds it.
    """
    n, c, p = columns.shape
    free = ~np.isfinite(reach)
    flat = (columns / sigma[:, None]).reshape(n * c, p)
    unit = np.where(free, 1.0 / np.maximum(np.linalg.norm(flat, axis=0), 1e-300), reach)
    coefficients, unsaid = [], np.zeros(p)
    # A direction whose whole usual size is less than its noise says nothing; free ones count if they are independent.
    for chosen, least in ((~free, 1.0), (free, 1e-7)):
        _, size, turned = np.linalg.svd(flat[:, chosen] * unit[chosen], full_matrices=False)
        clear = size > least
        part = np.zeros((p, int(clear.sum())))
        part[chosen] = np.sqrt(n) * unit[chosen][:, None] * turned[clear].T / size[clear]
        coefficients.append(part)
        if least == 1.0:
            unsaid[chosen] = unit[chosen] ** 2 * np.clip(1.0 - np.sum(turned[clear] ** 2, axis=0), 0.0, 1.0)
    M = np.hstack(coefficients)
    return Established(columns @ M, M, unsaid)


class LinearProblem:
    """A remainder that is linear in everything, for a search over laws.

    Attributes:
        target: What the model in question leaves, shape (n, c).
        case: What the terms look at.
        components, noise_floor, unit, configuration, folds: As of every problem.
    """

    def __init__(
        self,
        target: FloatArray,
        sigma: FloatArray,
        case: Any,
        configuration: IntArray,
        noise_floor: float,
        unit: Unit = METRES,
        rows: IntArray | None = None,
    ) -> None:
        """Keep what is to be explained.

        Args:
            target: What the model in question leaves, shape (n, c).
            sigma: Standard deviation of each component, shape (c,).
            case: What the terms look at.
            configuration: What is left out together, shape (n,).
            noise_floor: What noise leaves.
            unit: Of that.
            rows: Those that count, shape (m,); all of them without.
        """
        self._rows = np.arange(len(target)) if rows is None else rows
        target, configuration = target[self._rows], configuration[self._rows]
        self.target, self.sigma, self.case, self.configuration = target, sigma, case, configuration
        self.components, self.noise_floor, self.unit = target.shape[1], noise_floor, unit
        self.folds = make_folds(configuration)
        self._effects: dict[int, tuple[Any, FloatArray]] = {}

    def coarser(self, factor: float) -> Self:
        """The same with standard deviations that many times as large."""
        other = copy(self)
        other.sigma = factor * self.sigma
        return other

    def __len__(self) -> int:
        return len(self.target)

    def effect(self, member: Any) -> FloatArray:
        """Columns of a candidate, shape (n, c, p)."""
        if id(member) not in self._effects:
            # The member is kept beside its columns: its id must not be given to another one.
            self._effects[id(member)] = (member, self._effect(member))
        return self._effects[id(member)][1]

    def of_rows(self, values: FloatArray) -> FloatArray:
        """Values of all rows, shape (n,), of those that count, shape (m,)."""
        return values[self._rows]

    def _effect(self, member: Any) -> FloatArray:
        result: FloatArray = member.effect(self.case)[self._rows]
        return result

    def predict(self, members: Sequence[Any], theta: FloatArray, derivative: bool = False) -> Prediction:
        """Residuals, costs and derivatives at theta, shape (p,)."""
        none = np.zeros((*self.target.shape, 0))
        columns = np.concatenate([none, *(self.effect(member) for member in members)], axis=2)
        residual = self.target - columns @ theta
        white = residual / self.sigma
        jacobian = columns / self.sigma[:, None] if derivative else None
        return Prediction(residual, white, np.sum(white**2, axis=1), jacobian)

    def slope(self, cause: Any, theta: FloatArray) -> FloatArray:
        """Whitened columns of one candidate, shape (n, c, p)."""
        result: FloatArray = self._effect(cause) / self.sigma[:, None]
        return result

    def white(self, found: Fit[Any]) -> FloatArray:
        """What a model leaves of rows left out, in standard deviations, shape (n, c)."""
        return found.held_out / self.sigma

    def measured_part(self, white: FloatArray) -> FloatArray:
        """The residual, shape (n, c), of a whitened one."""
        return white * self.sigma
