"""Straight lines and circular arcs in space: what a MoveL and a MoveC follow."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from doormill_ros.arrays import FloatArray, IntArray
from doormill_ros.frames import cross


@dataclass(frozen=True, eq=False)
class Line:
    """A straight line.

    Attributes:
        start: Shape (3,) [m].
        end: Shape (3,) [m].
    """

    start: FloatArray
    end: FloatArray
    is_arc: ClassVar[bool] = False

    @property
    def length(self) -> float:
        """Length [m]."""
        return math.dist(self.start, self.end)

    def points(self, fractions: FloatArray | Sequence[float]) -> FloatArray:
        """Points at fractions 0..1 of the length, shape (k,) -> (k, 3) [m]."""
        t = np.asarray(fractions, dtype=float)[:, None]
        return self.start + t * (self.end - self.start)

    def tangent(self, fraction: float) -> FloatArray:
        """Unit direction of travel at a fraction of the length, shape (3,)."""
        direction = self.end - self.start
        return direction / float(np.linalg.norm(direction))

    def part(self, first: float, last: float) -> Line:
        """The stretch between two fractions of the length."""
        way = self.end - self.start
        return Line(self.start + first * way, self.start + last * way)

    def backwards(self) -> Line:
        """The same line travelled the other way."""
        return Line(self.end, self.start)

    def mapped(self, T_a_b: FloatArray) -> Line:
        """The line given in frame b, written in frame a; T_a_b of shape (4, 4)."""
        R, p = T_a_b[:3, :3], T_a_b[:3, 3]
        return Line(R @ self.start + p, R @ self.end + p)


@dataclass(frozen=True, eq=False)
class Arc:
    """A circular arc.

    Attributes:
        start: Shape (3,) [m].
        end: Shape (3,) [m].
        centre: Shape (3,) [m].
        across: The arm from the centre to the start, turned a quarter along the travel, shape (3,) [m].
        sweep: Angle, positive [rad].
    """

    start: FloatArray
    end: FloatArray
    centre: FloatArray
    across: FloatArray
    sweep: float
    is_arc: ClassVar[bool] = True

    @property
    def radius(self) -> float:
        """Radius [m]."""
        return math.dist(self.start, self.centre)

    @property
    def length(self) -> float:
        """Length along the arc [m]."""
        return self.sweep * self.radius

    @property
    def height(self) -> float:
        """How far the arc leaves its chord [m]."""
        return self.radius * (1.0 - math.cos(0.5 * self.sweep))

    def points(self, fractions: FloatArray | Sequence[float]) -> FloatArray:
        """Points at fractions 0..1 of the length, shape (k,) -> (k, 3) [m]."""
        t = np.asarray(fractions, dtype=float)[:, None]
        arm = self.start - self.centre
        points = self.centre + np.cos(t * self.sweep) * arm + np.sin(t * self.sweep) * self.across
        # The ends stay as given, so that neighbours join without a rounding error between them.
        return np.where(t == 0.0, self.start, np.where(t == 1.0, self.end, points))

    def tangent(self, fraction: float) -> FloatArray:
        """Unit direction of travel at a fraction of the length, shape (3,)."""
        direction = self._across(fraction * self.sweep)
        return direction / float(np.linalg.norm(direction))

    def part(self, first: float, last: float) -> Arc:
        """The stretch between two fractions of the length."""
        start, end = self.points([first, last])
        return Arc(start, end, self.centre, self._across(first * self.sweep), self.sweep * (last - first))

    def backwards(self) -> Arc:
        """The same arc travelled the other way."""
        return Arc(self.end, self.start, self.centre, -self._across(self.sweep), self.sweep)

    def mapped(self, T_a_b: FloatArray) -> Arc:
        """The arc given in frame b, written in frame a; T_a_b of shape (4, 4)."""
        R, p = T_a_b[:3, :3], T_a_b[:3, 3]
        return Arc(R @ self.start + p, R @ self.end + p, R @ self.centre + p, R @ self.across, self.sweep)

    def _across(self, angle: float) -> FloatArray:
        """The direction of travel at an angle from the start, as long as the radius, shape (3,) [m]."""
        return math.cos(angle) * self.across - math.sin(angle) * (self.start - self.centre)


Curve = Line | Arc


def arc_about(start: FloatArray, centre: FloatArray, normal: FloatArray, sweep: float) -> Arc:
    """The arc that turns the start about an axis.

    Args:
        start: Shape (3,) [m].
        centre: Shape (3,) [m], in the plane of the arc.
        normal: Unit axis, shape (3,); the turn is right-handed for a positive sweep.
        sweep: Angle, of either sign [rad].
    """
    start, centre = np.asarray(start, dtype=float), np.asarray(centre, dtype=float)
    arm = start - centre
    across = cross(normal, arm) * np.sign(sweep)
    end = centre + np.cos(sweep) * arm + np.sin(abs(sweep)) * across
    return Arc(start, end, centre, across, abs(float(sweep)))


def arc_through(start: FloatArray, via: FloatArray, end: FloatArray) -> Arc:
    """The arc that a MoveC from `start` makes, all of shape (3,) [m], not on one line."""
    first, chord = via - start, end - start
    normal = np.cross(first, chord)
    squared = float(normal @ normal)
    centre = start + (
        float(chord @ chord) * np.cross(normal, first) + float(first @ first) * np.cross(chord, normal)
    ) / (2.0 * squared)
    axis = normal / math.sqrt(squared)
    arm, last = start - centre, end - centre
    sweep = math.atan2(float(axis @ np.cross(arm, last)), float(arm @ last)) % (2.0 * math.pi)
    return Arc(start, end, centre, np.cross(axis, arm), sweep)


def points_of(curves: Sequence[Curve], index: IntArray, fraction: FloatArray) -> FloatArray:
    """Points of many curves at once.

    Args:
        curves: The curves.
        index: Curve of each point, shape (n,).
        fraction: Fraction 0..1 of the curve's length, shape (n,).

    Returns:
        Shape (n, 3) [m].
    """
    start = np.array([c.start for c in curves])
    end = np.array([c.end for c in curves])
    t = fraction[:, None]
    result = np.where(t == 1.0, end[index], start[index] + t * (end - start)[index])  # (n, 3)
    nowhere = np.zeros(3)
    arcs = [(c.centre, c.across, c.sweep) if isinstance(c, Arc) else (nowhere, nowhere, 0.0) for c in curves]
    centre, across, sweep = (np.array(column) for column in zip(*arcs, strict=True))
    round_ = np.array([c.is_arc for c in curves])[index] & (fraction != 0.0) & (fraction != 1.0)
    i = index[round_]
    angle = t[round_] * sweep[i, None]
    result[round_] = centre[i] + np.cos(angle) * (start - centre)[i] + np.sin(angle) * across[i]
    return result
