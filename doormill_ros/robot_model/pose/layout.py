"""Where the coefficients of all causes stand in one vector, and the frame twists that they make."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from doormill_ros.arrays import FloatArray, IntArray
from doormill_ros.robot_model.pose.causes.cause import PoseCause
from doormill_ros.robot_model.pose.chain import AXES
from doormill_ros.robot_model.pose.view import SetView


@dataclass(frozen=True, eq=False)
class Layout:
    """Where the coefficients of every cause stand in the vector of all.

    Attributes:
        causes: All causes.
        start: First index of every cause, and the total at the end, shape (len(causes) + 1,).
        group: Group of every coefficient, shape (m,).
        typical: Largest plausible size, shape (m,).
    """

    causes: tuple[PoseCause, ...]
    start: IntArray
    group: IntArray
    typical: FloatArray

    @property
    def size(self) -> int:
        """Number of coefficients."""
        return int(self.start[-1])

    def part(self, index: int) -> slice:
        """Coefficients of a cause."""
        return slice(int(self.start[index]), int(self.start[index + 1]))


def lay_out(causes: Sequence[PoseCause]) -> Layout:
    """Put the coefficients of all causes in a row."""
    every = [cause.coefficients for cause in causes]
    flat = [coefficient for part in every for coefficient in part]
    names: dict[str, int] = {}
    return Layout(
        tuple(causes),
        np.concatenate([[0], np.cumsum([len(part) for part in every], dtype=int)]).astype(int),
        np.array([names.setdefault(c.group, len(names)) for c in flat], dtype=int),
        np.array([c.typical for c in flat], dtype=float),
    )


def design(view: SetView, layout: Layout) -> dict[int, tuple[IntArray, FloatArray]]:
    """Index of the coefficients (k,) and basis (n, k) by direction, for one series."""
    found: dict[int, list[tuple[IntArray, FloatArray]]] = {}
    for index, cause in enumerate(layout.causes):
        for columns in cause.columns(view):
            first = int(layout.start[index]) + columns.first
            ids = np.arange(first, first + columns.basis.shape[1])
            found.setdefault(columns.direction, []).append((ids, columns.basis))
    return {
        key: (np.concatenate([i for i, _ in parts]), np.concatenate([b for _, b in parts], axis=1))
        for key, parts in found.items()
    }


def frame_twists(
    bases: dict[int, tuple[IntArray, FloatArray]], x: FloatArray, n: int, joints: int
) -> FloatArray:
    """Twists of all frames of a robot of J joints, shape (n, J + 1, 6)."""
    twists = np.zeros((n, AXES * (joints + 1)))
    for key, (ids, basis) in bases.items():
        twists[:, key] = basis @ x[ids]
    return twists.reshape(n, joints + 1, AXES)
