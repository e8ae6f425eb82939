"""Cracks that breathe: half way along a link, open while the load bends it one way, closed and sound the other way."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.robot_model.elastic.law.edges import EDGES, Edge
from doormill_ros.robot_model.elastic.law.parts import across, at_middle, moment_at_middle
from doormill_ros.robot_model.elastic.load_case import LoadCase
from doormill_ros.robot_model.law.parts import number_of
from doormill_ros.units import deg_to_rad

#: Steps between directions of cracks [deg]: those that are tried, and those between that may do better.
_ROUGH, _FINE = 15, 5


@dataclass(frozen=True)
class Crack:
    """A crack across a link, whichever.

    Attributes:
        way: Direction of the axis about which it opens, across the link's line [deg].
    """

    way: int
    kind: ClassVar[str] = "opening crack"

    @property
    def acts_on(self) -> str:
        """What a term acts on that opens it."""
        return f"crack at {self.way} deg"

    @property
    def driver(self) -> str:
        """What drives that."""
        return f"torque sign (moment that opens a crack at {self.way} deg)"

    @property
    def does(self) -> str:
        """What it does."""
        return f"opens at its middle at {self.way} deg about its line"

    def _axis(self, case: LoadCase, where: str) -> FloatArray:
        one, other = across(case, number_of(where))
        angle = deg_to_rad(self.way)
        axis: FloatArray = np.cos(angle) * one + np.sin(angle) * other
        return axis

    def motion(self, case: LoadCase, where: str) -> list[FloatArray]:
        """One radian about its axis, shape (n, 6)."""
        return [at_middle(case, number_of(where), self._axis(case, where))]

    def moment(self, case: LoadCase, link: int) -> FloatArray:
        """Moment of the load that opens it in a link (0 ... 5), shape (n,) [N m]; 0 where it presses it shut."""
        axis = self._axis(case, f"link {link + 1}")
        about = np.sum(axis * moment_at_middle(case, link), axis=1)
        result: FloatArray = np.maximum(about, 0.0)
        return result

    def beside(self) -> list[Crack]:
        """Those next to it that a model may have."""
        return [Crack((self.way + step) % 360) for step in (-_FINE, _FINE)]


#: All cracks by what a term acts on, those that are tried first, and all that opens one way.
CRACKS = {crack.acts_on: crack for crack in map(Crack, range(0, 360, _FINE))}
ROUGH_CRACKS = tuple(crack for crack in CRACKS.values() if crack.way % _ROUGH == 0)
OPENING: dict[str, Edge | Crack] = {**EDGES, **CRACKS}
