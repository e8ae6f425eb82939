"""A series whose residuals are a linear function of all unknowns: its normal equations, and the placement alone.

Most coefficients turn one of few joints: the derivative by such a one is a number times the motion of the target for a
turn of that joint. So products of derivatives are products of those numbers, weighed by products of few motions.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from doormill_ros.arrays import FloatArray, IntArray
from doormill_ros.diagnosis.core.ridge import Block, Solution
from doormill_ros.diagnosis.pose.placement import HUBER

#: Neighbouring coefficients in one direction from which on only its motion is multiplied; derivatives by the others are
#: written out.
_WIDE = 20
#: Rows whose derivatives are multiplied at once: more do not stay near the processor.
_AT_ONCE = 1000
#: Damping of a placement: directions that the poses leave open stay where they are.
_WHISPER = 3e-5


@dataclass(frozen=True, eq=False)
class _Part:
    """Some unknowns that act in one direction.

    Attributes:
        direction: The direction.
        places: Of the unknowns among those that act in a series, shape (k,).
        basis: Displacement for a unit of each, shape (n, k).
    """

    direction: int
    places: IntArray
    basis: FloatArray

    @property
    def span(self) -> slice:
        """The places of neighbours."""
        return slice(int(self.places[0]), int(self.places[-1]) + 1)


@dataclass(frozen=True, eq=False)
class Linear:
    """Residuals of a series as a linear function of all unknowns.

    Attributes:
        series: Index of the series.
        error: Residuals where it was linearised, base axes, shape (n, 6).
        D: Motion of the target for a unit of every direction, shape (n, 6 J + 6, 6).
        bases: Index of the coefficients (k,) and displacement for a unit of each (n, k), by direction.
        x: All unknowns where it was linearised, steps of placements zero, shape (size,).
        free: Directions of the placement.
        own: Unknowns of the placement, in that order, shape (9,) or (12,).
        scale: One over the standard deviation of every component of a residual, shape (6,).
        weight: Of the rows, 0 for gross errors, shape (n,).
        share: Part of the rows that count as independent.
        placing: Rows that place the series where it is left out, shape (k,).
        shared: Whether another series has the same placement.
    """

    series: int
    error: FloatArray
    D: FloatArray
    bases: Mapping[int, tuple[IntArray, FloatArray]]
    x: FloatArray
    free: Sequence[int]
    own: IntArray
    scale: FloatArray
    weight: FloatArray
    share: float
    placing: IntArray
    shared: bool

    @cached_property
    def ids(self) -> IntArray:
        """Unknowns that act here, ascending, shape (k,)."""
        return np.unique(np.concatenate([self.own, *(ids for ids, _ in self.bases.values())]))

    @cached_property
    def _parts(self) -> tuple[list[_Part], list[_Part]]:
        """Wide ones, of neighbouring coefficients that act in one direction and in no other, and the rest."""
        uses = np.bincount(np.concatenate([self.own, *(ids for ids, _ in self.bases.values())]))
        wide: list[_Part] = []
        narrow: list[_Part] = []
        for key, (ids, basis) in self.bases.items():
            for run in np.split(np.arange(len(ids)), np.flatnonzero(np.diff(ids) != 1) + 1):
                part = _Part(key, np.searchsorted(self.ids, ids[run]), basis[:, run[0] : run[-1] + 1])
                (wide if len(run) >= _WIDE and np.all(uses[ids[run]] == 1) else narrow).append(part)
        one = np.ones((len(self.error), 1))
        places = np.searchsorted(self.ids, self.own)
        narrow += [_Part(key, places[k : k + 1], one) for k, key in enumerate(self.free)]
        return wide, narrow

    @cached_property
    def _narrow(self) -> IntArray:
        """Places of the unknowns that are not in wide parts, shape (k,)."""
        return np.unique(np.concatenate([part.places for part in self._parts[1]]))

    def residuals(self, x: FloatArray, rows: IntArray) -> FloatArray:
        """What some solutions, shape (solutions, size), leave of rows, shape (solutions, len(rows), 6)."""
        step = (x - self.x).T
        twists = np.zeros((len(rows), self.D.shape[1], len(x)))
        for key, (ids, basis) in self.bases.items():
            twists[:, key] = basis[rows] @ step[ids]
        twists[:, self.free] += step[self.own]
        moved = np.swapaxes(twists, 1, 2) @ self.D[rows]
        result: FloatArray = self.error[rows] - np.swapaxes(moved, 0, 1)
        return result

    def effect(self, rows: IntArray, axes: int) -> FloatArray:
        """Derivatives of the first axes of the poses of rows by all unknowns, shape (len(rows), axes, size)."""
        A = np.zeros((len(rows), axes, len(self.x)))
        for key, (ids, basis) in self.bases.items():
            A[:, :, ids] += self.D[rows, key, :axes, None] * basis[rows][:, None, :]
        A[:, :, self.own] += np.swapaxes(self.D[rows][:, self.free, :axes], 1, 2)
        return A

    def normal_equations(self, rows: IntArray) -> Block:
        """Of rows, weighted."""
        wide, at = self._parts[0], self._narrow
        H, g = np.zeros((len(self.ids), len(self.ids))), np.zeros(len(self.ids))
        for some in np.array_split(rows, 1 + len(rows) // _AT_ONCE):
            D, J, error = self._white(some)
            between, along = D @ np.swapaxes(D, 1, 2), D @ J
            bases = [part.basis[some] for part in wide]
            for a, (part, left) in enumerate(zip(wide, bases, strict=True)):
                for b in range(a, len(wide)):
                    H[part.span, wide[b].span] += left.T @ (bases[b] * between[:, a, b, None])
                H[part.span, at] += left.T @ along[:, a]
                g[part.span] += np.sum(D[:, a] * error, axis=1) @ left
            flat = J.reshape(-1, len(at))
            H[np.ix_(at, at)] += flat.T @ flat
            g[at] += error.ravel() @ flat
        for a, part in enumerate(wide):
            for other in wide[a + 1 :]:
                H[other.span, part.span] = H[part.span, other.span].T
            H[at, part.span] = H[part.span, at].T
        return Block(self.series, rows, self.ids, H, g + H @ self.x[self.ids])

    def pulls(self, x: FloatArray, blocks: Sequence[IntArray]) -> Iterator[tuple[FloatArray, FloatArray]]:
        """Descent that some blocks have left at a solution, and its curvature along every unknown.

        Args:
            x: The solution, shape (size,).
            blocks: Their rows.

        Yields:
            Of the unknowns that act here, shapes (k,) and (k,).
        """
        for rows in blocks:
            pull, curvature = np.zeros(len(self.ids)), np.zeros(len(self.ids))
            D, J, _ = self._white(rows)
            left = self.residuals(x[None], rows)[0] * self._roots(rows)
            for a, part in enumerate(self._parts[0]):
                basis = part.basis[rows]
                pull[part.span] = np.sum(D[:, a] * left, axis=1) @ basis
                curvature[part.span] = np.sum(D[:, a] ** 2, axis=1) @ basis**2
            flat = J.reshape(-1, len(self._narrow))
            pull[self._narrow] = left.ravel() @ flat
            curvature[self._narrow] = np.sum(flat**2, axis=0)
            yield pull, curvature

    def _roots(self, rows: IntArray) -> FloatArray:
        """What makes residuals of rows white and weighted, shape (len(rows), 6)."""
        result: FloatArray = self.scale * np.sqrt(self.share * self.weight[rows])[:, None]
        return result

    def _white(self, rows: IntArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """White and weighted: motions of wide parts (n, k, 6), derivatives by the others (n, 6, k), errors (n, 6)."""
        root, (wide, narrow) = self._roots(rows), self._parts
        D = self.D[rows] * root[:, None, :]
        J = np.zeros((len(rows), 6, len(self._narrow)))
        for part in narrow:
            J[:, :, np.searchsorted(self._narrow, part.places)] += (
                D[:, part.direction, :, None] * part.basis[rows][:, None, :]
            )
        return D[:, [part.direction for part in wide]], J, self.error[rows] * root

    def variance(self, solution: Solution, rows: IntArray, placed: bool) -> FloatArray:
        """Of predicted positions of rows, shape (len(rows), 3) [m^2]; `placed` if marked rows alone place the series.

        Then the placement takes up a part of what is wrong in the coefficients, and adds the noise of those rows.
        """
        A, C = self.effect(rows, 3), solution.covariance
        noise = np.zeros((len(rows), 3))
        if placed and not self.shared:
            marked = self.effect(self.placing, 6) * self.scale[:, None]
            marked = marked.reshape(-1, len(solution.x))
            P = marked[:, self.own]
            unit = 1.0 / np.linalg.norm(P, axis=0)
            inverse = np.linalg.inv((P * unit).T @ (P * unit) + _WHISPER**2 * np.eye(len(unit)))
            inverse *= np.outer(unit, unit)
            own = A[:, :, self.own]
            noise = np.sum((own @ inverse) * own, axis=2)
            A = A - own @ (inverse @ (P.T @ marked))
            A[:, :, self.own] = 0.0
        used = np.flatnonzero(np.any(A, axis=(0, 1)))
        A = A[:, :, used]
        result: FloatArray = np.sum((A @ C[np.ix_(used, used)]) * A, axis=2) + noise
        return result

    def place(self, x: FloatArray) -> FloatArray:
        """Some solutions, shape (solutions, size), with the placement fitted to the rows that may place the series."""
        x = x.copy()
        x[:, self.own] = 0.0
        J = np.swapaxes(self.D[self.placing][:, self.free] * self.scale, 1, 2)
        flat = J.reshape(-1, len(self.own))
        start = self.residuals(x, self.placing) * self.scale
        whisper = np.broadcast_to(_WHISPER * np.eye(len(self.own)), (len(x), len(self.own), len(self.own)))
        for _ in range(3):
            error = start - (x[:, self.own] @ flat.T).reshape(start.shape)
            size = np.linalg.norm(error, axis=2)
            usual = np.median(size, axis=1)[:, None]
            root = np.sqrt(self.weight[self.placing] / np.maximum(1.0, size / (HUBER * usual)))
            # Base and target hardly differ in few poses: by orthogonal steps, which lose half the digits of a sum.
            A = (J * root[:, :, None, None]).reshape(len(x), -1, len(self.own))
            unit = 1.0 / np.linalg.norm(A, axis=1)
            Q, R = np.linalg.qr(np.concatenate([A * unit[:, None], whisper], axis=1))
            right = (error * root[:, :, None]).reshape(len(x), -1, 1)
            pull = np.swapaxes(Q[:, : A.shape[1]], 1, 2) @ right
            x[:, self.own] += unit * np.linalg.solve(R, pull)[..., 0]
        return x
