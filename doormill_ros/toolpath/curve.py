"""Straight lines and circular arcs in space: what a MoveL and a MoveC follow."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from doormill_ros.arrays import FloatArray


@dataclass(frozen=True, eq=False)
class Curve:
    """A straight line or an arc.

    Attributes:
        start: Shape (3,) [m].
        end: Shape (3,) [m].
        centre: Centre of an arc, shape (3,) [m]; None for a line.
        across: For an arc, the arm from the centre to the start, turned a quarter along the
            travel, shape (3,) [m].
        sweep: Angle of an arc, positive [rad]; 0 for a line.
    """

    start: FloatArray
    end: FloatArray
    centre: FloatArray | None = None
    across: FloatArray | None = None
    sweep: float = 0.0

    @property
    def is_arc(self) -> bool:
        """True for an arc."""
        return self.centre is not None

    @property
    def radius(self) -> float:
        """Radius of an arc [m]; infinite for a line."""
        return math.dist(self.start, self.centre) if self.is_arc else float("inf")

    @property
    def length(self) -> float:
        """Length along the curve [m]."""
        return self.sweep * self.radius if self.is_arc else math.dist(self.start, self.end)

    def points(self, fractions: FloatArray | Sequence[float]) -> FloatArray:
        """Points at fractions 0..1 of the length, shape (k,) -> (k, 3) [m]."""
        t = np.asarray(fractions, dtype=float)[:, None]
        if not self.is_arc:
            return self.start + t * (self.end - self.start)
        arm = self.start - self.centre
        points = self.centre + np.cos(t * self.sweep) * arm + np.sin(t * self.sweep) * self.across
        # The ends stay as given, so that neighbours join without a rounding error between them.
        return np.where(t == 0.0, self.start, np.where(t == 1.0, self.end, points))

    def part(self, first: float, last: float) -> Curve:
        """The stretch between two fractions of the length."""
        if not self.is_arc:
            way = self.end - self.start
            return Curve(self.start + first * way, self.start + last * way)
        start, end = self.points([first, last])
        # The direction of travel at the new start, as long as the radius.
        angle = first * self.sweep
        across = np.cos(angle) * self.across - np.sin(angle) * (self.start - self.centre)
        return Curve(start, end, self.centre, across, self.sweep * (last - first))

    def mapped(self, T_a_b: FloatArray) -> Curve:
        """The curve given in frame b, written in frame a."""
        R, p = T_a_b[:3, :3], T_a_b[:3, 3]
        ends = replace(self, start=R @ self.start + p, end=R @ self.end + p)
        if not self.is_arc:
            return ends
        return replace(ends, centre=R @ self.centre + p, across=R @ self.across)


def arc_about(start: FloatArray, centre: FloatArray, normal: FloatArray, sweep: float) -> Curve:
    """The arc that turns the start about an axis.

    Args:
        start: Shape (3,) [m].
        centre: Shape (3,) [m], in the plane of the arc.
        normal: Unit axis, shape (3,); the turn is right-handed for a positive sweep.
        sweep: Angle, of either sign [rad].
    """
    start, centre = np.asarray(start, dtype=float), np.asarray(centre, dtype=float)
    arm = start - centre
    across = np.cross(normal, arm) * np.sign(sweep)
    end = centre + np.cos(sweep) * arm + np.sin(abs(sweep)) * across
    return Curve(start, end, centre, across, abs(float(sweep)))


def points_of(curves: Sequence[Curve], index: FloatArray, fraction: FloatArray) -> FloatArray:
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
    centre = np.array([c.start if c.centre is None else c.centre for c in curves])
    across = np.array([np.zeros(3) if c.across is None else c.across for c in curves])
    round_ = np.array([c.is_arc for c in curves])[index] & (fraction != 0.0) & (fraction != 1.0)
    i = index[round_]
    angle = t[round_] * np.array([c.sweep for c in curves])[i, None]
    result[round_] = centre[i] + np.cos(angle) * (start - centre)[i] + np.sin(angle) * across[i]
    return result
