"""A series whose residuals are a linear function of all unknowns, and its normal equations.

Most coefficients turn one of few joints: the derivative by such a one is a number times the motion of the target for a
turn of that joint. So products of derivatives are products of those numbers, weighed by products of few motions.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from doormill_ros.arrays import FloatArray, IntArray
from doormill_ros.diagnosis.core.fitting.ridge import Block

#: Neighbouring coefficients in one direction from which on only its motion is multiplied; derivatives by the others are
#: written out.
_WIDE = 20
#: Rows whose derivatives are multiplied at once: more do not stay near the processor.
_AT_ONCE = 1000


@dataclass(frozen=True, eq=False)
class _Part:
    """Some unknowns that act in one direction.

    Attributes:
        direction: The direction.
        places: Of the unknowns among those that act in a series.
        basis: Displacement for a unit of each, shape (n, k).
    """

    direction: int
    places: slice
    basis: FloatArray


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
    def _wide(self) -> list[_Part]:
        """Neighbouring coefficients that act in one direction and in no other."""
        uses = np.bincount(np.concatenate([self.own, *(ids for ids, _ in self.bases.values())]))
        found = []
        for key, (ids, basis) in self.bases.items():
            for run in np.split(np.arange(len(ids)), np.flatnonzero(np.diff(ids) != 1) + 1):
                if len(run) >= _WIDE and np.all(uses[ids[run]] == 1):
                    first = int(np.searchsorted(self.ids, ids[run[0]]))
                    columns = basis[:, run[0] : run[-1] + 1]
                    found.append(_Part(key, slice(first, first + len(run)), columns))
        return found

    @cached_property
    def _narrow(self) -> tuple[IntArray, IntArray, FloatArray]:
        """Whatever else acts, in one direction or several: places ascending, directions, displacements (n, k)."""
        wide = np.concatenate([np.zeros(0, dtype=int), *(self.ids[part.places] for part in self._wide)])
        places, directions = [np.searchsorted(self.ids, self.own)], [np.array(self.free)]
        columns = [np.ones((len(self.error), len(self.own)))]
        for key, (ids, basis) in self.bases.items():
            rest = np.flatnonzero(~np.isin(ids, wide))
            places.append(np.searchsorted(self.ids, ids[rest]))
            directions.append(np.full(len(rest), key))
            columns.append(basis[:, rest])
        at = np.concatenate(places)
        order = np.argsort(at, kind="stable")
        return at[order], np.concatenate(directions)[order], np.concatenate(columns, axis=1)[:, order]

    @cached_property
    def _rest(self) -> IntArray:
        """Places of the unknowns that are not in wide parts, shape (k,)."""
        return np.unique(self._narrow[0])

    def residuals(self, x: FloatArray, rows: IntArray) -> FloatArray:
        """What some solutions, shape (solutions, size), leave of rows, shape (solutions, len(rows), 6).

        All are told by how far they are from the first, so that what is the same leaves the same to the last digit.
        """
        first = self.error[rows] - self._moved(x[:1] - self.x, rows)
        result: FloatArray = np.concatenate([first, first - self._moved(x[1:] - x[0], rows)])
        return result

    def _moved(self, step: FloatArray, rows: IntArray) -> FloatArray:
        """By how much some steps, shape (steps, size), move the poses of rows, shape (steps, len(rows), 6)."""
        twists = np.zeros((len(rows), self.D.shape[1], len(step)))
        for key, (ids, basis) in self.bases.items():
            twists[:, key] = _taken(basis, rows) @ step[:, ids].T
        twists[:, self.free] += step[:, self.own].T
        result: FloatArray = np.swapaxes(np.swapaxes(twists, 1, 2) @ self.D[rows], 0, 1)
        return result

    def effect(self, rows: IntArray, axes: int) -> FloatArray:
        """Derivatives of the first axes of the poses of rows by all unknowns, shape (len(rows), axes, size)."""
        A = np.zeros((len(rows), axes, len(self.x)))
        for key, (ids, basis) in self.bases.items():
            A[:, :, ids] += self.D[rows, key, :axes, None] * basis[rows][:, None, :]
        A[:, :, self.own] += np.swapaxes(self.D[rows][:, self.free, :axes], 1, 2)
        return A

    def normal_equations(self, rows: IntArray) -> Block:
        """Of rows, shape (n,), weighted."""
        wide, rest = self._wide, self._rest
        at = np.cumsum([0, *(part.basis.shape[1] for part in wide)])
        H, g = np.zeros((len(self.ids), len(self.ids))), np.zeros(len(self.ids))
        for some in np.array_split(rows, 1 + len(rows) // _AT_ONCE):
            D, J, error = self._white(some)
            between, along = D @ np.swapaxes(D, 1, 2), D @ J
            bases = [_taken(part.basis, some) for part in wide]
            right = np.empty((len(some), at[-1] + len(rest)))
            for a, (part, left) in enumerate(zip(wide, bases, strict=True)):
                own = left * np.sqrt(between[:, a, a, None])
                H[part.places, part.places] += own.T @ own
                for b in range(a + 1, len(wide)):
                    np.multiply(bases[b], between[:, a, b, None], out=right[:, at[b] : at[b + 1]])
                right[:, at[-1] :] = along[:, a]
                products = left.T @ right[:, at[a + 1] :]
                for b in range(a + 1, len(wide)):
                    H[part.places, wide[b].places] += products[:, at[b] - at[a + 1] : at[b + 1] - at[a + 1]]
                H[part.places, rest] += products[:, at[-1] - at[a + 1] :]
                g[part.places] += np.sum(D[:, a] * error, axis=1) @ left
            flat = J.reshape(-1, len(rest))
            H[np.ix_(rest, rest)] += flat.T @ flat
            g[rest] += error.ravel() @ flat
        for a, part in enumerate(wide):
            for other in wide[a + 1 :]:
                H[other.places, part.places] = H[part.places, other.places].T
            H[rest, part.places] = H[part.places, rest].T
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
            for a, part in enumerate(self._wide):
                basis = _taken(part.basis, rows)
                pull[part.places] = np.sum(D[:, a] * left, axis=1) @ basis
                curvature[part.places] = np.sum(D[:, a] ** 2, axis=1) @ basis**2
            flat = J.reshape(-1, len(self._rest))
            pull[self._rest] = left.ravel() @ flat
            curvature[self._rest] = np.sum(flat**2, axis=0)
            yield pull, curvature

    def _roots(self, rows: IntArray) -> FloatArray:
        """What makes residuals of rows white and weighted, shape (len(rows), 6)."""
        result: FloatArray = self.scale * np.sqrt(self.share * self.weight[rows])[:, None]
        return result

    def _white(self, rows: IntArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """White and weighted: motions of wide parts (n, k, 6), derivatives by the rest (n, 6, k), errors (n, 6)."""
        root, (places, directions, columns) = self._roots(rows), self._narrow
        D = self.D[rows] * root[:, None, :]
        J = np.swapaxes(D, 1, 2)[:, :, directions] * columns[rows][:, None, :]
        if len(self._rest) < len(places):
            J = np.add.reduceat(J, np.searchsorted(places, self._rest), axis=2)
        return D[:, [part.direction for part in self._wide]], J, self.error[rows] * root


def _taken(values: FloatArray, rows: IntArray) -> FloatArray:
    """Some rows, ascending, of values: seen, and not copied, where they are neighbours."""
    if len(rows) and rows[-1] - rows[0] == len(rows) - 1:
        return values[rows[0] : rows[-1] + 1]
    return values[rows]
