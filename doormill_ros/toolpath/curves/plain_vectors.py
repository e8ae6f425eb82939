"""Products of two vectors in plain numbers: of three numbers at a time numpy would take ten times as long."""

from __future__ import annotations

from collections.abc import Sequence


def plain_cross(a: Sequence[float], b: Sequence[float]) -> list[float]:
    """Vector product of two vectors of three numbers."""
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def plain_dot(a: Sequence[float], b: Sequence[float]) -> float:
    """Scalar product of two vectors of three numbers."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
