"""Marks that stand still beside the door: white dots on black rings, section `marks` of a camera file."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.values import Finite, Positive, Section


@dataclass(frozen=True)
class Marks(Section):
    """Dots in one plane across base x, carried along y by the slider as the camera is.

    Attributes:
        x: Of their plane in base [m].
        radius: Of a white dot [m]; its black ring reaches to twice as far.
        deviation: Standard deviation of a dot's place [m].
        limit: Largest error in a door's y, z [m] and rotation [rad] that a moved camera may cause.
        places: y at a door width of zero and z of each dot in base [m].
    """

    x: Finite
    radius: Positive
    deviation: Positive
    limit: tuple[Positive, Positive, Positive]
    places: tuple[tuple[Finite, Finite], ...]

    def centres(self, width: float) -> FloatArray:
        """The dots in base, shape (n, 3) [m], the slider standing for a door of `width` [m]."""
        places = np.array(self.places, dtype=float).reshape(-1, 2)
        return np.column_stack([np.full(len(places), self.x), places[:, 0] - width / 2.0, places[:, 1]])
