"""One joint in all recordings made ready for fitting: columns, blocks, noise, and exact leave-out solutions."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from doormill_ros.arrays import BoolArray, FloatArray, IntArray
from doormill_ros.diagnosis.core.fitting.held_out import left_out, scatter_of
from doormill_ros.diagnosis.motion.model import JointFit, model_of, stiffness_of
from doormill_ros.diagnosis.motion.noise import chance_of, mean_square_of, no_slips, noise_floor, size_of
from doormill_ros.robot_model.motion.causes.cause import MotionCause
from doormill_ros.robot_model.motion.view import JointMotion, SeenMotion

EXTREME = 30.0  #: times the stiffness of the model in question, or that share of it, is no spring
#: Contiguous blocks a recording is cut into, and how many groups of them are left out in turn.
BLOCKS, FOLDS = 20, 10
SAMPLES = 3000  #: that laws are searched in, at most
_RIDGE = 1e-10  #: share of a column's own square
_FOLD_RIDGE = 1e-7  #: the same where a part of the rows is left out
_SETTLED, _STEPS = 1e-7, 4  #: s, and steps to there at most
FINEST = 1e-9  #: difference of two encoders that is noise whatever was read [rad]
_BEYOND = 1.5  #: how far outside its ends a state at the start may be fitted


@dataclass(eq=False)
class JointProblem:
    """One joint in all recordings.

    Attributes:
        motions: What was recorded, one a recording.
        noise: Standard deviation of link, motor [rad] and torque [N m]; None where not stated.
    """

    motions: tuple[JointMotion, ...]
    noise: tuple[float | None, float | None, float | None]
    _columns: dict[tuple[int, float], tuple[MotionCause, list[FloatArray], list[FloatArray]]] = field(
        default_factory=dict
    )

    @property
    def where(self) -> str:
        """Place."""
        return f"joint {self.motions[0].joint}"

    @property
    def stiffness(self) -> float:
        """Of the model in question [N m / rad]."""
        return self.motions[0].stiffness

    def __len__(self) -> int:
        return sum(map(len, self.motions))

    def seen(self, delay: float) -> tuple[SeenMotion, ...]:
        """The recordings as a link encoder sees them that is late by a delay [s]."""
        return tuple(motion.seen(delay) for motion in self.motions)

    @cached_property
    def recording(self) -> IntArray:
        """Recording of each sample, shape (n,)."""
        return np.repeat(np.arange(len(self.motions)), [len(motion) for motion in self.motions])

    @cached_property
    def block(self) -> IntArray:
        """Block of each sample, shape (n,): contiguous, BLOCKS a recording."""
        parts = [
            BLOCKS * i + np.minimum(np.arange(len(motion)) * BLOCKS // len(motion), BLOCKS - 1)
            for i, motion in enumerate(self.motions)
        ]
        return np.concatenate(parts)

    @cached_property
    def fold(self) -> IntArray:
        """What is left out together, shape (n,): every so many-th block of each recording."""
        return self.block % FOLDS

    @cached_property
    def difference(self) -> FloatArray:
        """Link minus motor angle, shape (n,) [rad]."""
        return np.concatenate([motion.link - motion.motor for motion in self.motions])

    @cached_property
    def kept(self) -> BoolArray:
        """Samples that are no slips of the reading, shape (n,)."""
        return np.concatenate([no_slips(motion) for motion in self.motions])

    def recorded(self, delay: float) -> BoolArray:
        """Samples that a delay [s] does not carry beyond the ends of their recording, shape (n,)."""
        return np.concatenate([one.recorded for one in self.seen(delay)])

    def counted(self, delay: float) -> IntArray:
        """Samples that a search over laws looks at, shape (m,): the others repeat them."""
        rows = np.flatnonzero(self.kept & self.recorded(delay))
        return rows[:: -(-len(rows) // SAMPLES)]

    @cached_property
    def floor(self) -> float:
        """Noise of the difference between encoders and spring [rad]."""
        return max(noise_floor(self.motions, self.noise), FINEST)

    def columns_of(self, cause: MotionCause, delay: float) -> tuple[list[FloatArray], list[FloatArray]]:
        """Shared and own columns of a cause in each recording, shapes (n, p)."""
        key = (id(cause), round(delay, 8))
        if key not in self._columns:
            seen = self.seen(delay)
            # The cause is kept beside its columns: its id must not be given to another one.
            self._columns[key] = (
                cause,
                [cause.columns(one) for one in seen],
                [cause.own_columns(one) for one in seen],
            )
        return self._columns[key][1:]

    def design(self, members: Sequence[MotionCause], delay: float) -> FloatArray:
        """All columns: an offset a recording, shared ones, then each member's own by recording, shape (n, p)."""
        count = len(self.motions)
        lengths = [len(motion) for motion in self.motions]
        starts = np.concatenate([[0], np.cumsum(lengths)])
        parts = [np.eye(count)[self.recording]]
        for cause in members:
            shared, _ = self.columns_of(cause, delay)
            parts.append(np.concatenate(shared))
        for cause in members:
            _, own = self.columns_of(cause, delay)
            for i, block in enumerate(own):
                if block.shape[1]:
                    whole = np.zeros((len(self), block.shape[1]))
                    whole[starts[i] : starts[i + 1]] = block
                    parts.append(whole)
        return np.concatenate(parts, axis=1)

    def target(self, delay: float) -> FloatArray:
        """What is left for causes to explain, shape (n,) [rad]."""
        predicted: FloatArray = np.concatenate([one.predicted for one in self.seen(delay)])
        return np.asarray(self.difference - predicted, dtype=float)

    def fit(self, members: Sequence[MotionCause], delay: float = 0.0) -> JointFit:
        """Least squares, with every fold also predicted by the others."""
        members = tuple(members)
        X, y = self.design(members, delay), self.target(delay)
        recorded = self.recorded(delay)
        weight = (self.kept & recorded).astype(float)
        size = np.sqrt(np.einsum("np,np,n->p", X, X, weight))
        size = np.where(size > 0.0, size, 1.0)
        A = X / size * weight[:, None]
        b = y * weight
        order = np.argsort(self.fold, kind="stable")
        edges = np.searchsorted(self.fold[order], np.arange(FOLDS + 1))
        grams, rights = [], []
        for low, high in itertools.pairwise(edges):
            part = A[order[low:high]]
            grams.append(part.T @ part)
            rights.append(part.T @ b[order[low:high]])
        G, g = np.sum(grams, axis=0), np.sum(rights, axis=0)
        # A column that vanishes in what is left would be free: hold it by a hair.
        free = np.eye(len(g))
        inverse = np.linalg.inv(G + _RIDGE * free)
        solution = inverse @ g
        residual = y - X @ (solution / size)
        held_out = residual.copy()
        parts = zip(grams, rights, strict=True)
        others = left_out(G, g, parts, lambda H, h: np.linalg.solve(H + _FOLD_RIDGE * free, h))
        for (low, high), without in zip(itertools.pairwise(edges), others, strict=True):
            rows = order[low:high]
            held_out[rows] = y[rows] - X[rows] @ (without / size)
        pulls = np.zeros((BLOCKS * len(self.motions), len(g)))
        np.add.at(pulls, self.block, A * (residual * weight)[:, None])
        std = scatter_of(pulls, inverse) / size
        residual, held_out = residual * recorded, held_out * recorded
        return self.unpacked(members, delay, solution / size, std, residual, held_out)

    def unpacked(
        self,
        members: tuple[MotionCause, ...],
        delay: float,
        solution: FloatArray,
        std: FloatArray,
        residual: FloatArray,
        held_out: FloatArray,
    ) -> JointFit:
        """A model of all its numbers in the order of `design`.

        Args:
            members: Causes.
            delay: At which the joint is seen [s].
            solution: Numbers, shape (p,).
            std: Their standard deviations, shape (p,).
            residual: What it leaves, shape (n,) [rad].
            held_out: The same predicted without the block, shape (n,) [rad].
        """
        at = len(self.motions)
        x, deviation = [], []
        for cause in members:
            count = self.columns_of(cause, delay)[0][0].shape[1]
            x.append(solution[at : at + count])
            deviation.append(std[at : at + count])
            at += count
        own, own_std = [], []
        for cause in members:
            mine, its = [], []
            for block in self.columns_of(cause, delay)[1]:
                mine.append(solution[at : at + block.shape[1]])
                its.append(std[at : at + block.shape[1]])
                at += block.shape[1]
            own.append(tuple(mine))
            own_std.append(tuple(its))
        return JointFit(
            members, delay, tuple(x), tuple(own), residual, held_out, tuple(deviation), tuple(own_std)
        )

    def left_out(self, members: Sequence[MotionCause], delay: float) -> float:
        """Sum over the recordings of the mean square that a fit to the others leaves, own constants fitted [rad^2]."""
        total = 0.0
        for i, motion in enumerate(self.motions):
            others = JointProblem(self.motions[:i] + self.motions[i + 1 :], self.noise)
            found = others.settled(members, delay)
            left = model_of(found, motion).residual(motion, kept=no_slips(motion))
            total += mean_square_of(left)
        return total

    def settled(self, members: Sequence[MotionCause], delay: float) -> JointFit:
        """The fit about the delay that it finds itself, its members with the shapes that they find."""
        found = self.fit(members, delay)
        for _ in range(_STEPS):
            index = found.skew
            stays = index is None or abs(float(found.x[index][0])) < _SETTLED
            stiffness = stiffness_of(found.members, found.x, self.stiffness)
            nearer = [cause.nearer(x, stiffness) for cause, x in zip(found.members, found.x, strict=True)]
            if stays and all(one is cause for one, cause in zip(nearer, found.members, strict=True)):
                break
            found = self.fit(nearer, found.delay if stays else round(found.late, 8))
        return found

    def plausible(self, found: JointFit, strictly: bool = True) -> bool:
        """Whether every coefficient is one that its cause can have.

        Args:
            found: A model.
            strictly: Also the spring's, which stands for much else as long as other causes are missing.
        """
        stiffness = stiffness_of(found.members, found.x, self.stiffness)
        if strictly and not 1.0 / EXTREME < stiffness / self.stiffness < EXTREME:
            return False
        return not self.impossible(found)

    def impossible(self, found: JointFit) -> list[MotionCause]:
        """Members that cannot have the coefficients that a model gives them."""
        stiffness = stiffness_of(found.members, found.x, self.stiffness)
        seen = self.seen(found.delay)
        every = zip(found.members, found.x, found.own, strict=True)
        return [
            cause
            for cause, part, own in every
            if not cause.allowed(part if len(part) else np.concatenate(own), stiffness, seen)
            # Bristles or teeth at the start of a recording lie somewhere between their two ends.
            or (len(part) and any(np.any(np.abs(one) > _BEYOND * abs(part[0])) for one in own))
        ]

    def cost(self, errors: FloatArray) -> float:
        """Sum of squares of the samples that count, of shape (n,)."""
        return float(np.sum(errors[self.kept] ** 2))

    def by_block(self, errors: FloatArray) -> FloatArray:
        """The same by block, shape (blocks,)."""
        squares = np.where(self.kept, errors, 0.0) ** 2
        found = np.bincount(self.block, weights=squares, minlength=BLOCKS * len(self.motions))
        return np.asarray(found, dtype=float)

    def rmse(self, errors: FloatArray) -> float:
        """Root mean square of the samples that count, of shape (n,) [rad]."""
        return size_of(np.where(self.kept, errors, 0.0))

    def unit(self, errors: FloatArray, shape: FloatArray) -> float:
        """Squared error that chance gives a shape, at least the noise's square.

        Args:
            errors: What a model leaves, shape (n,).
            shape: Effect in question, shape (n,).
        """
        rows = [self.recording == i for i in range(len(self.motions))]
        own, wanted = (np.where(self.kept, part, 0.0) for part in (errors, shape))
        return max(chance_of([own[one] for one in rows], [wanted[one] for one in rows]), self.floor**2)
