"""Straight lines and circular arcs in space: what a MoveL and a MoveC follow."""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from doormill_ros.arrays import BoolArray, FloatArray, IntArray
from doormill_ros.frames import cross
from doormill_ros.toolpath.curves.plain_vectors import plain_cross, plain_dot


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

    @functools.cached_property
    def length(self) -> float:
        """Length [m]."""
        return math.dist(self.start, self.end)

    def points(self, fractions: FloatArray | Sequence[float]) -> FloatArray:
        """Points at fractions 0..1 of the length, shape (k,) -> (k, 3) [m]."""
        t = np.asarray(fractions, dtype=float)[:, None]
        return self.start + t * (self.end - self.start)

    def point(self, fraction: float) -> FloatArray:
        """One of `points`, shape (3,) [m]: to make arrays of one fraction takes longer than the point."""
        return self.start + fraction * (self.end - self.start)

    def tangent(self, fraction: float) -> FloatArray:
        """Unit direction of travel at a fraction of the length, shape (3,)."""
        return (self.end - self.start) / self.length

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

    @functools.cached_property
    def radius(self) -> float:
        """Radius [m]."""
        return math.dist(self.start, self.centre)

    @functools.cached_property
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

    def point(self, fraction: float) -> FloatArray:
        """One of `points`, shape (3,) [m]: to make arrays of one fraction takes longer than the point."""
        if fraction in (0.0, 1.0):
            return self.end if fraction else self.start
        angle = fraction * self.sweep
        return self.centre + math.cos(angle) * (self.start - self.centre) + math.sin(angle) * self.across

    def tangent(self, fraction: float) -> FloatArray:
        """Unit direction of travel at a fraction of the length, shape (3,)."""
        direction = self._across(fraction * self.sweep)
        return direction / math.hypot(*direction.tolist())

    def part(self, first: float, last: float) -> Arc:
        """The stretch between two fractions of the length."""
        start, end = self.point(first), self.point(last)
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
    first, chord = (via - start).tolist(), (end - start).tolist()
    normal = plain_cross(first, chord)
    squared = plain_dot(normal, normal)
    by_chord, by_first = 0.5 * plain_dot(chord, chord) / squared, 0.5 * plain_dot(first, first) / squared
    inwards, back = plain_cross(normal, first), plain_cross(chord, normal)
    arm = [-(by_chord * a + by_first * b) for a, b in zip(inwards, back, strict=True)]  # centre to start
    size = math.sqrt(squared)
    across = plain_cross([each / size for each in normal], arm)
    to_end = [a + b for a, b in zip(arm, chord, strict=True)]
    sweep = math.atan2(plain_dot(across, to_end), plain_dot(arm, to_end)) % (2.0 * math.pi)
    return Arc(start, end, start - np.array(arm), np.array(across), sweep)


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
    inner = (fraction != 0.0) & (fraction != 1.0)
    centre, arm, across, angle, round_ = _turns(curves, index, fraction, inner)
    result[round_] = centre + np.cos(angle) * arm + np.sin(angle) * across
    return result


def tangents_of(curves: Sequence[Curve], index: IntArray, fraction: FloatArray) -> FloatArray:
    """Unit directions of travel along many curves at once, shape (n, 3); arguments as of `points_of`."""
    result: FloatArray = np.array([c.end - c.start for c in curves])[index]
    _, arm, across, angle, round_ = _turns(curves, index, fraction, np.ones(len(index), dtype=bool))
    result[round_] = np.cos(angle) * across - np.sin(angle) * arm
    result /= np.sqrt((result**2).sum(axis=1))[:, None]
    return result


def _turns(
    curves: Sequence[Curve], index: IntArray, fraction: FloatArray, asked: BoolArray
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray, BoolArray]:
    """Centres, arms to the start, arms across and angles [rad] at points of arcs; which of those asked for these are.

    Shapes (r, 3) [m] three times, (r, 1) and (n,).
    """
    is_arc = np.array([c.is_arc for c in curves])
    arcs = [c for c in curves if isinstance(c, Arc)]
    centre, start, across = (
        np.array([getattr(c, name) for c in arcs]).reshape(-1, 3) for name in ("centre", "start", "across")
    )
    sweep = np.array([c.sweep for c in arcs])
    round_ = is_arc[index] & asked
    i = (is_arc.cumsum() - 1)[index[round_]]
    return centre[i], (start - centre)[i], across[i], fraction[round_, None] * sweep[i, None], round_
