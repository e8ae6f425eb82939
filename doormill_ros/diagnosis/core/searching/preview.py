"""What candidates may gain, to first order: which of them are worth a fit."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Generic

import numpy as np

from doormill_ros.arrays import FloatArray, IntArray
from doormill_ros.diagnosis.core.fitting.fit import Fit
from doormill_ros.diagnosis.core.fitting.problem import C, Problem
from doormill_ros.diagnosis.core.fitting.ranking import QUANTUM, ranks
from doormill_ros.diagnosis.core.fitting.robust import trial_weights

_ALIKE = 1e-6  #: squared sine of the angle between two effects below which they are one


class Slopes(Generic[C]):
    """Derivatives of all candidates at all their starts, computed once for a set.

    Attributes:
        columns: Whitened, shape (c n, m), those of every candidate and start in a row.
    """

    def __init__(self, problem: Problem[C], candidates: Sequence[C]) -> None:
        """Derive every candidate, whitened."""
        self.problem, self.candidates = problem, candidates
        blocks, self._owner = [], []
        for index, cause in enumerate(candidates):
            for start in cause.starts(problem.case):
                blocks.append(problem.slope(cause, start).reshape(-1, cause.size))
                self._owner.append(index)
        # A problem that has nothing to propose still has a model in question.
        none = [] if blocks else [np.zeros((problem.predict((), np.zeros(0)).white.size, 0))]
        self.columns = np.hstack([*none, *blocks])
        ends = np.cumsum([0, *(block.shape[1] for block in blocks)])
        self._blocks = [slice(a, b) for a, b in pairwise(ends)]
        sizes = np.diff(ends)
        self._by_size = {int(size): np.flatnonzero(sizes == size) for size in np.unique(sizes)}

    def _at(self, size: int) -> IntArray:
        """Columns of the blocks of a size, shape (blocks, size)."""
        first = np.array([self._blocks[i].start for i in self._by_size[size]])
        result: IntArray = first[:, None] + np.arange(size)
        return result

    def grams(self, one: FloatArray, other: FloatArray) -> list[FloatArray]:
        """Products of the columns of every block, shape (blocks, size, size) for each size, of two (k, m)."""
        return [
            np.matmul(one[:, at].transpose(1, 2, 0), other[:, at].transpose(1, 0, 2))
            for at in map(self._at, self._by_size)
        ]

    def best(self, pull: FloatArray, grams: Sequence[FloatArray]) -> tuple[FloatArray, IntArray]:
        """By how much the score may fall when each candidate joins, at its best start, and the number of its block.

        Args:
            pull: Products of the columns and the target, shape (m,).
            grams: As `grams` gives them.
        """
        of_block = np.zeros(len(self._blocks))
        for (size, numbers), gram in zip(self._by_size.items(), grams, strict=True):
            own = pull[self._at(size)]
            # Not in place: the products of the columns may be wanted again.
            firm = gram + 1e-9 * (1.0 + np.einsum("bii->b", gram))[:, None, None] * np.eye(size)
            of_block[numbers] = np.einsum("bi,bi->b", own, np.linalg.solve(firm, own[:, :, None])[:, :, 0])
        gains = np.full(len(self.candidates), -np.inf)
        chosen = np.zeros(len(self.candidates), dtype=int)
        for number, (index, gain) in enumerate(zip(self._owner, of_block, strict=True)):
            if gain > gains[index] + QUANTUM:
                gains[index], chosen[index] = gain, number
        return gains, chosen


class Preview(Slopes[C], Generic[C]):
    """What every candidate may gain beside any model of the set."""

    def _left(self, found: Fit[C]) -> tuple[FloatArray, FloatArray]:
        """Residual (c n,) and derivatives (c n, m) less what the members can take over themselves."""
        white, own = found.prediction.white, found.prediction.jacobian
        # Trials set aside by the smaller model may be just those that a new cause explains.
        weights = np.sqrt(trial_weights(np.sum(white**2, axis=1), False, self.problem.components))
        target = (white * weights[:, None]).ravel()
        columns = self.columns * np.repeat(weights, white.shape[1])[:, None]
        if own is not None and found.size:
            base, _ = np.linalg.qr((own * weights[:, None, None]).reshape(len(target), -1))
            target = target - base @ (base.T @ target)
            columns = columns - base @ (base.T @ columns)
        return target, columns

    def gains(self, found: Fit[C]) -> FloatArray:
        """By how much the score may fall when each candidate joins, at its best start, shape (candidates,)."""
        return self._gains(*self._left(found))[0]

    def _gains(self, target: FloatArray, columns: FloatArray) -> tuple[FloatArray, IntArray]:
        """The gains and the number of the block that gave each."""
        return self.best(columns.T @ target, self.grams(columns, columns))

    def pairs(self, found: Fit[C]) -> tuple[IntArray, FloatArray]:
        """By how much the score may fall when two candidates join together.

        Two effects that hide each other show in no single candidate, so a search that adds one at a
        time walks past them.

        Returns:
            Numbers of the two candidates, shape (m, 2), and gains, shape (m,); the best first.
        """
        target, columns = self._left(found)
        _, chosen = self._gains(target, columns)
        count = len(self.candidates)
        widest = max(cause.size for cause in self.candidates)
        bases = np.zeros((len(target), count, widest))
        for index in range(count):
            basis, size, _ = np.linalg.svd(columns[:, self._blocks[chosen[index]]], full_matrices=False)
            firm = size > 1e-5 * max(float(size[0]), 1e-30)
            bases[:, index, : firm.sum()] = basis[:, firm]
        flat = bases.reshape(len(target), -1)
        pull = (flat.T @ target).reshape(count, widest)
        first, second = np.triu_indices(count, 1)
        cross = (flat.T @ flat).reshape(count, widest, count, widest).transpose(0, 2, 1, 3)[first, second]
        rest = pull[second] - np.einsum("mij,mi->mj", cross, pull[first])
        gram = np.eye(widest) * (1.0 + _ALIKE) - np.einsum("mij,mik->mjk", cross, cross)
        more = np.einsum("mi,mi->m", rest, np.linalg.solve(gram, rest[:, :, None])[:, :, 0])
        gains = np.sum(pull[first] ** 2, axis=1) + more
        order = ranks(-gains)
        return np.stack([first, second], axis=1)[order], np.minimum.accumulate(gains[order])
