"""What moved the base of a robot while a series was recorded: a step, a course that settles, both, or none of these.

Each form is laid beside everything else that may act, and predicts blocks that were left out: the one with few numbers
is taken unless a slow displacement of many numbers says clearly more.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from doormill_ros.arrays import FloatArray, IntArray
from doormill_ros.diagnosis.core.fitting.held_out import gain_in_expected_errors
from doormill_ros.diagnosis.core.fitting.ridge import Solution, learn
from doormill_ros.diagnosis.pose.fitting.fit import Fitted, contiguous
from doormill_ros.diagnosis.pose.fitting.validation import Split, Validation
from doormill_ros.diagnosis.pose.searching.selection import SHARE, SURE, WORTH
from doormill_ros.robot_model.pose.causes.cause import PoseCause
from doormill_ros.robot_model.pose.causes.hints import TimeCourse
from doormill_ros.robot_model.pose.causes.session_step import MARGIN, SessionStep
from doormill_ros.robot_model.pose.causes.settling import PoseSettling
from doormill_ros.robot_model.pose.causes.thermal_drift import PoseDrift
from doormill_ros.robot_model.pose.layout import Layout, design, lay_out
from doormill_ros.units import MM

#: Time constants that are tried, as shares of a series; a longer one is hardly told from a steady course.
DECAYS = np.geomspace(0.02, 1.0, 14)
#: Part of a short series at either end in which no step is looked for.
END = 0.1
#: Places of a step that are tried at first; those around the best follow.
PLACES = 40
#: Rows of a series by which forms are sought, about; what is found is judged by all.
SOUGHT = 1000
#: Rows whose derivatives stand in memory at once.
_AT_ONCE = 1000


@dataclass(frozen=True, eq=False)
class Moved:
    """What moved the base in one series.

    Attributes:
        causes: Its causes; none where no simple form is established.
        others: Forms of another name that the data hardly tell from these.
    """

    causes: tuple[PoseCause, ...] = ()
    others: tuple[PoseCause, ...] = ()


def find_moved(fitted: Fitted, series: int, validated: Callable[[], Validation]) -> Moved:
    """What moved the base in a series.

    Args:
        fitted: A fit in which nothing does.
        series: Index of the series.
        validated: Gives its solutions with blocks left out, which are asked for where something seems to have moved.
    """
    found = _Series(fitted, series)
    where = f"set {found.view.name}"
    step, settling = found.best_step(where), found.best_course(where)
    if max(step[1], settling[1]) < found.worth:
        return Moved()
    single: list[tuple[PoseCause, ...]] = [(step[0],), (settling[0],)]
    forms = [*single, (PoseDrift(where),), (step[0], settling[0])]
    splits = validated().blocks
    held: dict[tuple[PoseCause, ...], FloatArray] = {(): found.unseen(splits)}
    seen: dict[tuple[PoseCause, ...], float] = {}
    for form in forms:
        held[form], seen[form] = found.tried(form, splits)
    left = {form: found.cost(error) for form, error in held.items()}
    # Equally many numbers: all rows choose. What a block that is left out shows of a step is no more than its end.
    best = max(single, key=seen.__getitem__)
    for more in forms[2:]:
        better = left[best].sum() - left[more].sum(), seen[more] - seen[best]
        if min(better) > found.worth:
            best = more
    fall = left[()] - left[best]
    sure = gain_in_expected_errors(fall, found.cost(held[()] - held[best]))
    if fall.sum() < found.worth or sure < SURE:
        return Moved()
    names = {cause.name for cause in best}
    others = tuple(
        form[0]
        for form in forms[:3]
        if form[0].name not in names
        and (left[form].sum() < left[best].sum() + found.worth or seen[form] > seen[best] - found.worth)
    )
    return Moved(() if isinstance(best[0], PoseDrift) else best, others)


class _Series:
    """One series beside a fit: what a displacement of the base would explain of it."""

    def __init__(self, fitted: Fitted, series: int) -> None:
        self.fitted, self.series = fitted, series
        self.one, self.view = fitted.linear[series], fitted.problem.views[series]
        self.count = len(self.one.error)
        self.root = self.one.scale * np.sqrt(self.one.share * self.one.weight)[:, None]
        error = self.one.residuals(fitted.solution.x[None], np.arange(self.count))[0] * self.one.scale
        self.worth = max(WORTH, SHARE * float(self.cost(error).sum()))

    def best_step(self, where: str) -> tuple[PoseCause, float]:
        """The step that explains most, and the fall of the cost by it."""
        first = min(MARGIN, int(np.ceil(END * self.count)))
        inside = np.arange(first, self.count - first + 1)
        apart = max(1, len(inside) // PLACES)
        at = inside[::apart]
        gains = self._step_gains(at)
        if apart > 1 and gains.max() >= self.worth:
            at = inside[np.abs(inside - at[np.argmax(gains)]) <= apart]
            gains = self._step_gains(at)
        best = int(at[np.argmax(gains)])
        # A standard deviation off, twice the logarithm of the likelihood falls by one.
        likely = at[(gains.max() - gains) * self.one.share < 1.0]
        spread = max(1, *np.abs(likely - best))
        return SessionStep(where, int(self.view.row[best]), int(spread)), float(gains.max())

    def _step_gains(self, at: IntArray) -> FloatArray:
        return self.gains((np.arange(self.count)[:, None] >= at).astype(float))

    def best_course(self, where: str) -> tuple[PoseCause, float]:
        """The course that explains most, and the fall of the cost by it."""
        courses = [TimeCourse(float(decay)) for decay in (*DECAYS, np.inf)]
        gains = self.gains(np.stack([course.grown(self.view.elapsed) for course in courses], axis=1))
        best = int(np.argmax(gains))
        if 0 < best < len(DECAYS) - 1:
            courses[best] = _between(DECAYS[best - 1 : best + 2], gains[best - 1 : best + 2])
        return PoseSettling(where, courses[best]), float(gains[best])

    def gains(self, profiles: FloatArray) -> FloatArray:
        """Fall of the cost by a base that moves and turns as each of some profiles does, shape (n, k) to (k,)."""
        P, size, k = profiles, self.fitted.problem.size, profiles.shape[1]
        cross, own, pull = np.zeros((k, 6, size)), np.zeros((k, 6, 6)), np.zeros((k, 6))
        x = self.fitted.solution.x
        some = np.arange(0, self.count, max(1, self.count // SOUGHT))
        each = self.count / len(some)
        for rows in _parts(some):
            E, A = self._white(rows)
            left = self.one.residuals(x[None], rows)[0] * self.root[rows]
            cross += (P[rows].T @ (E @ A).reshape(len(rows), -1)).reshape(cross.shape)
            own += ((P[rows] ** 2).T @ (E @ np.swapaxes(E, 1, 2)).reshape(len(rows), -1)).reshape(own.shape)
            pull += P[rows].T @ np.einsum("nij,nj->ni", E, left)
        cross, own, pull = each * cross, each * own, each * pull
        through = (cross.reshape(-1, size) @ self.fitted.solution.covariance).reshape(cross.shape)
        M = own - through @ np.swapaxes(cross, 1, 2)
        M += np.eye(6) / MM**2  # as large as a millimetre or a milliradian
        z = np.linalg.solve(M, pull[:, :, None])[:, :, 0]
        result: FloatArray = np.sum(pull * z, axis=1) / self.one.share
        return result

    def unseen(self, splits: Sequence[Split]) -> FloatArray:
        """What the fit leaves of blocks left out, in standard deviations, shape (n, 6)."""
        found = np.zeros((self.count, 6))
        for split in splits:
            own = split.rows[self.series]
            found[own] = self.one.residuals(split.solution.x[None], own)[0]
        return found * self.one.scale

    def tried(self, form: Sequence[PoseCause], splits: Sequence[Split]) -> tuple[FloatArray, float]:
        """The same with some causes beside the fit, and the fall of the cost of all rows by them."""
        layout, bases = lay_out(form), design(self.view, lay_out(form))
        rows = [split.rows[self.series] for split in splits]
        parts = [self._equations(own, layout) for own in rows]
        total = [np.sum([part[i] for part in parts], axis=0) for i in range(3)]
        found = np.zeros((self.count, 6))
        for split, own, part in zip(splits, rows, parts, strict=True):
            z, through, _ = self._solved(
                [a - b for a, b in zip(total, part, strict=True)], split.solution, layout
            )
            moved = np.zeros((len(own), 6))
            for key, (ids, basis) in bases.items():
                moved += (basis[own] @ z[ids])[:, None] * self.one.D[own, key]
            found[own] = self.one.residuals((split.solution.x - z @ through)[None], own)[0] - moved
        return found * self.one.scale, self._solved(total, self.fitted.solution, layout)[2]

    def _solved(
        self, equations: Sequence[FloatArray], solution: Solution, layout: Layout
    ) -> tuple[FloatArray, FloatArray, float]:
        """Coefficients beside a solution, what each takes from it, and the fall of the cost by them."""
        cross, square, pull = equations
        through = cross @ solution.covariance
        M, b = square - through @ cross.T, pull - cross @ (solution.x - self.one.x)
        z = learn(M, b, layout, 8).x
        return z, through, float(2.0 * z @ b - z @ M @ z) / self.one.share

    def cost(self, error: FloatArray) -> FloatArray:
        """Weighted squares of errors in standard deviations, shape (n, 6), by block."""
        square = self.one.weight * np.sum(error**2, axis=1)
        return np.array([square[rows].sum() for rows in contiguous(self.count)])

    def _equations(self, rows: IntArray, layout: Layout) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Products of the effects of some causes with those of the fit, with themselves, and with the errors."""
        size, k = self.fitted.problem.size, layout.size
        cross, square, pull = np.zeros((k, size)), np.zeros((k, k)), np.zeros(k)
        bases = design(self.view, layout)
        for some in _parts(rows):
            _, A = self._white(some)
            B = np.zeros((len(some), 6, k))
            for key, (ids, basis) in bases.items():
                B[:, :, ids] += self.one.D[some, key, :, None] * basis[some][:, None, :]
            B *= self.root[some][:, :, None]
            flat = B.reshape(-1, k)
            cross += flat.T @ A.reshape(-1, size)
            square += flat.T @ flat
            pull += flat.T @ (self.one.error[some] * self.root[some]).ravel()
        return cross, square, pull

    def _white(self, rows: IntArray) -> tuple[FloatArray, FloatArray]:
        """White effects of the base's six directions, shape (n, 6, 6), and of all unknowns, shape (n, 6, size)."""
        root = self.root[rows]
        return self.one.D[rows, :6] * root[:, None, :], self.one.effect(rows, 6) * root[:, :, None]


def _parts(rows: IntArray) -> list[IntArray]:
    return np.array_split(rows, 1 + len(rows) // _AT_ONCE)


def _between(decays: FloatArray, gains: FloatArray) -> TimeCourse:
    """The best course of three neighbours, the middle one the best of them, and how sure its time constant is."""
    step = float(np.log(decays[1] / decays[0]))
    bend = float(gains[0] - 2.0 * gains[1] + gains[2])
    if bend >= 0.0:
        return TimeCourse(float(decays[1]))
    at = 0.5 * float(gains[0] - gains[2]) / bend
    # A standard deviation off, twice the logarithm of the likelihood falls by one.
    return TimeCourse(float(decays[1] * np.exp(at * step)), step * float(np.sqrt(-1.0 / bend)))
