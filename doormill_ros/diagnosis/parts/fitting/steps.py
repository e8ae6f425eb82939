"""Doors from which on something may have changed: proposed by a quick look, to be judged by the search.

Effects join one after the other, each with the course that gains most, to first order; the doors at which a chosen
course takes a step are worth a candidate, and the one from which on doors stand elsewhere. A step counts only if doors
of one recipe show it, or a mixture of many: one recipe before and another one after are no change.
"""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import BoolArray, FloatArray
from doormill_ros.diagnosis.core.course import CHANGES
from doormill_ros.diagnosis.core.fitting.gain import gain_of
from doormill_ros.diagnosis.core.fitting.price import price_of_number
from doormill_ros.diagnosis.core.searching.beam import ENTRY
from doormill_ros.diagnosis.parts.fitting.course import InTime
from doormill_ros.diagnosis.parts.fitting.problem import DOORS_OVER_TIME, DoorProblem
from doormill_ros.statistics import NORMAL_STD

MIXED, _FEW = 2.0 / 3.0, 4  #: share of the doors that recipes are more than, and how many, to be a mixture
MOST = 3  #: steps that are proposed
_SEEN = 1e-6  #: share of the best seen direction below which another is not seen
_ROUNDS = 6  #: effects that may join


def possible_steps(problem: DoorProblem) -> tuple[int, ...]:
    """Numbers of the doors from which on something may have changed."""
    count = len(problem.doors)
    if count < DOORS_OVER_TIME:
        return ()
    look = _Look(problem)
    found = [problem.door_places.step] if problem.door_places.step > 0 else []
    for _ in range(_ROUNDS):
        step = look.join_best()
        if step is None:
            break
        if step > 0 and step not in found:
            found.append(step)
    return tuple(sorted(found[:MOST]))


class _Look:
    """Least squares over effects and their courses, to first order."""

    def __init__(self, problem: DoorProblem) -> None:
        self._problem = problem
        effects = [effect for effect in problem.effects() if effect.named]
        self._columns = [
            (problem.derivative_alone(InTime(effect)), CHANGES in effect.courses) for effect in effects
        ]
        left = problem.predict((), np.zeros(0)).white[:, 0]
        limit = 6.0 * max(1.0, float(np.median(np.abs(left))) * NORMAL_STD)
        self._left = np.clip(left, -limit, limit)
        self._basis = np.zeros((len(problem), 0))
        self._price = price_of_number(len(problem))

    def join_best(self) -> int | None:
        """Let the best effect with the best course join: the door of its step, 0 for none; None if nothing gains."""
        best: tuple[float, int, FloatArray] | None = None
        for columns, changes in self._columns:
            for step, taken in self._courses(columns, changes):
                gain = gain_of(self._less(taken), self._left) - self._price * taken.shape[1]
                if step > 0:
                    gain -= 2.0 * np.log(len(self._problem.doors))
                if (
                    gain > ENTRY
                    and (best is None or gain > best[0])
                    and self._seen_in_one_recipe(columns, step)
                ):
                    best = (gain, step, taken)
        if best is None:
            return None
        basis, size, _ = np.linalg.svd(self._less(best[2]), full_matrices=False)
        new = basis[:, size > _SEEN * size[0]]
        self._basis = np.hstack([self._basis, new])
        self._left = self._left - new @ (new.T @ self._left)
        return best[1]

    def _courses(self, columns: FloatArray, changes: bool) -> list[tuple[int, FloatArray]]:
        """Step and whitened columns of every course of an effect; 0 for one without a step."""
        door, count = self._problem.door, len(self._problem.doors)
        late = door[:, None] / (count - 1.0)
        take = self._problem.nuisance.take
        if not changes:
            return [(0, take(columns))]
        found = [(0, take(columns)), (0, take(np.hstack([columns, columns * late])))]
        for step in range(1, count):
            after = columns * (door >= step)[:, None]
            taken = take(np.hstack([columns, after]))
            found += [(step, taken[:, columns.shape[1] :]), (step, taken)]
        return found

    def _less(self, columns: FloatArray) -> FloatArray:
        return columns - self._basis @ (self._basis.T @ columns)

    def _seen_in_one_recipe(self, columns: FloatArray, step: int) -> bool:
        """Whether doors of recipes that stand on both sides of a step show it by themselves."""
        if step == 0:
            return True
        rows = rows_on_both_sides(self._problem, step)
        if not rows.any():
            return False
        after = columns * (self._problem.door >= step)[:, None]
        take = self._problem.nuisance.take
        target, constant, change = (
            values[rows]
            for values in (self._left[:, None], self._less(take(columns)), self._less(take(after)))
        )
        basis, _ = np.linalg.qr(constant)
        target, change = (values - basis @ (basis.T @ values) for values in (target, change))
        return bool(_explained(target, change) > ENTRY / 2.0)


def _explained(target: FloatArray, columns: FloatArray) -> float:
    solution = np.linalg.lstsq(columns, target, rcond=1e-9)[0]
    return float(np.sum(target**2) - np.sum((target - columns @ solution) ** 2))


def rows_on_both_sides(problem: DoorProblem, step: int) -> BoolArray:
    """Points of doors whose recipe was milled before and after a step, shape (n,).

    Where no recipe was and nearly every door is another one, all of them count.
    """
    before = {door.recipe for door in problem.doors[:step]}
    after = {door.recipe for door in problem.doors[step:]}
    count, recipes = len(problem.doors), len(before | after)
    mixed = not before & after and min(len(before), len(after)) > 1 and recipes > max(MIXED * count, _FEW)
    both = np.array([mixed or door.recipe in before & after for door in problem.doors])
    result: BoolArray = both[problem.door]
    return result
