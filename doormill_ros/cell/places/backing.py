"""Boards that the clamp presses against the rear face of a door, so that a mill coming through tears no wood out."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np
from pydantic import StrictBool

from doormill_ros.arrays import FloatArray
from doormill_ros.values import Array, Name, Positive, Section

Range = Annotated[FloatArray, Array((2,))]


@dataclass(frozen=True, eq=False)
class Board(Section):
    """A row of blocks against the rear face; those that the door does not cover stay drawn back.

    Attributes:
        name: What a refusal calls it.
        thickness: [m].
        from_lock_edge: Where it begins and ends, counted from the lock edge of the door, shape (2,) [m].
        height: Where it begins and ends above the lower end of the door as it stands, shape (2,) [m].
    """

    name: Name
    thickness: Positive
    from_lock_edge: Range
    height: Range

    def box(self, size: FloatArray) -> tuple[FloatArray, FloatArray] | None:
        """Its lowest and highest corner behind a door, door frame, shape (3,) each [m]; None where it does not reach.

        Args:
            size: Extent of the door along x, y and z of its frame, shape (3,) [m].
        """
        low = np.array([size[0], size[1] - self.from_lock_edge[1], self.height[0]])
        high = np.array([size[0] + self.thickness, size[1] - self.from_lock_edge[0], self.height[1]])
        low[1:], high[1:] = np.maximum(low[1:], 0.0), np.minimum(high[1:], size[1:])
        return (low, high) if bool((high > low).all()) else None


@dataclass(frozen=True, eq=False)
class Backing(Section):
    """What backs the rear face.

    Attributes:
        measured: False for boards that somebody assumed.
        source: Where the figures come from.
        boards: The boards.
    """

    measured: StrictBool
    source: Name
    boards: tuple[Board, ...]
