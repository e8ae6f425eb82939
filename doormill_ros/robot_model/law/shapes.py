"""How an effect follows what drives it: one line a shape.

A shape turns the value of a driver into columns of which a law is the weighted sum. Its own numbers (waves a turn, a
time, a threshold, the knots of a curve) are fixed before the fit; the weights are fitted.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from doormill_ros.arrays import FloatArray

Numbers = Sequence[float]


#: Shapes whose first own number may be refined once one of the dictionary's was taken.
_REFINED = (
    "periods", "fading", "saturating", "limited", "beyond", "opening", "past", "creeping", "settling", "sector",
)  # fmt: skip
#: By which it is, and by which parts of its width a sector is moved.
_FACTORS, _MOVES = (0.6, 0.85, 0.95, 1.05, 1.18, 1.7), (-0.4, -0.1, 0.1, 0.4)
#: Straight lines, and waves of which less than half of one was seen, are believed half as far again as they were seen.
_STRAIGHT = 0.5


@dataclass(frozen=True)
class Shape:
    """A family of functions of one variable.

    Attributes:
        columns: Of values (n,) and the shape's own numbers: shape (n, m).
        told: The law in words, of what drives it, its unit, own numbers, and weights as texts.
        reach: By how much of the width of the values that were seen it goes on beyond them; farther out the last
            value stands.
        period: After which it repeats itself, of its own numbers.
    """

    columns: Callable[[FloatArray, Numbers], Sequence[FloatArray]]
    told: Callable[[str, str, Numbers, Sequence[str]], str]
    reach: float = 0.0
    period: Callable[[Numbers], float] = lambda p: np.inf


def _curve(x: FloatArray, knots: Numbers) -> list[FloatArray]:
    """Cardinal natural splines: a weight is the value of the curve at its knot."""
    # Here, as it is half of the start of a path generator, whose model seldom has a curve.
    from scipy.interpolate import CubicSpline

    spline = CubicSpline(knots, np.eye(len(knots)), bc_type="natural")(x)
    return list(np.moveaxis(spline, -1, 0))


def _at(knots: Numbers, unit: str, w: Sequence[str]) -> str:
    return ", ".join(f"{value} at {knot:.4g} {unit}".rstrip() for knot, value in zip(knots, w, strict=True))


SHAPES: dict[str, Shape] = {
    "level": Shape(lambda x, p: [np.ones_like(x)], lambda d, u, p, w: f"{w[0]} throughout"),
    "slope": Shape(
        lambda x, p: [x],
        lambda d, u, p, w: f"{w[0]} for each {u} of {d}" if u else f"{w[0]} times {d}",
        reach=_STRAIGHT,
    ),
    "rise": Shape(
        lambda x, p: [x - p[0]],
        lambda d, u, p, w: f"{w[0]} for each {u} of {d} above {p[0]:.4g} {u}",
        reach=_STRAIGHT,
    ),
    "line": Shape(
        lambda x, p: [np.ones_like(x), x - p[0]],
        lambda d, u, p, w: f"{w[0]} at {p[0]:.4g} {u} of {d} and {w[1]} for each {u} more",
        reach=_STRAIGHT,
    ),
    "square": Shape(
        lambda x, p: [(x / p[0]) ** 2], lambda d, u, p, w: f"{w[0]} at {p[0]:.4g} {u} of {d}, as its square"
    ),
    "size": Shape(
        lambda x, p: [np.abs(x) / p[0]],
        lambda d, u, p, w: f"{w[0]} at {p[0]:.4g} {u} of {d}, in proportion to its size",
        reach=_STRAIGHT,
    ),
    "root": Shape(
        lambda x, p: [np.sqrt(np.abs(x) / p[0])],
        lambda d, u, p, w: f"{w[0]} at {p[0]:.4g} {u} of {d}, as its root",
    ),
    "fading": Shape(
        lambda x, p: [1.0 / (1.0 + np.abs(x) / p[0])],
        lambda d, u, p, w: f"{w[0]} at no {d}, half of it at {p[0]:.4g} {u}",
    ),
    "saturating": Shape(
        lambda x, p: [np.tanh(np.abs(x) / p[0])],
        lambda d, u, p, w: f"{w[0]} at large {d}, saturating from {p[0]:.4g} {u} on",
    ),
    "beyond": Shape(
        lambda x, p: [np.maximum(np.abs(x) - p[0], 0.0) / p[1]],
        lambda d, u, p, w: f"{w[0]} for each {p[1]:.4g} {u} of {d} beyond {p[0]:.4g} {u}",
    ),
    "opening": Shape(
        lambda x, p: [np.maximum(x - p[0], 0.0) / p[1]],
        lambda d, u, p, w: f"{w[0]} for each {p[1]:.4g} {u} of {d} beyond {p[0]:.4g} {u}",
        reach=np.inf,
    ),
    "limited": Shape(
        lambda x, p: [np.minimum(np.abs(x) / p[0], 1.0)],
        lambda d, u, p, w: f"{w[0]} from {p[0]:.4g} {u} of {d} on, in proportion below",
    ),
    "past": Shape(
        lambda x, p: [(np.abs(x) > p[0]).astype(float)],
        lambda d, u, p, w: f"{w[0]} once {d} is larger than {p[0]:.4g} {u}",
    ),
    "positive": Shape(
        lambda x, p: [(x > 0.0).astype(float)], lambda d, u, p, w: f"{w[0]} where {d} is positive"
    ),
    "negative": Shape(
        lambda x, p: [(x < 0.0).astype(float)], lambda d, u, p, w: f"{w[0]} where {d} is negative"
    ),
    "sign": Shape(lambda x, p: [np.sign(x)], lambda d, u, p, w: f"{w[0]} times the sign of {d}"),
    "sector": Shape(
        lambda x, p: [0.5 + 0.5 * np.cos(np.pi * np.clip((x - p[1]) / p[0], -1.0, 1.0))],
        lambda d, u, p, w: f"{w[0]} at {p[1]:.4g} {u} of {d}, fading away within {p[0]:.4g} {u}",
    ),
    "waves": Shape(
        lambda x, p: [np.sin(p[0] * x), np.cos(p[0] * x)],
        lambda d, u, p, w: f"{p[0]:.4g} waves a turn of {d}: sine {w[0]}, cosine {w[1]}",
        reach=_STRAIGHT,
        period=lambda p: 2.0 * np.pi / p[0],
    ),
    "periods": Shape(
        lambda x, p: [np.sin(2.0 * np.pi * x / p[0]), np.cos(2.0 * np.pi * x / p[0])],
        lambda d, u, p, w: f"with a period of {p[0]:.4g} {u} of {d}: sine {w[0]}, cosine {w[1]}",
    ),
    "logarithm": Shape(
        lambda x, p: [np.log(np.maximum(x, 1e-9) / p[0])],
        lambda d, u, p, w: f"{w[0]} for each factor of e in {d}, from {p[0]:.4g} {u} on",
    ),
    "logarithmic line": Shape(
        lambda x, p: [np.ones_like(x), np.log(np.maximum(x, 1e-9) / p[0])],
        lambda d, u, p, w: f"{w[0]} at {p[0]:.4g} {u} of {d} and {w[1]} for each factor of e more",
    ),
    "creeping": Shape(
        lambda x, p: [np.log1p(np.abs(x) / p[0])],
        lambda d, u, p, w: f"{w[0]} for each factor of e in {d} after {p[0]:.4g} {u}",
    ),
    "settling": Shape(
        lambda x, p: [1.0 - np.exp(-np.abs(x) / p[0])],
        lambda d, u, p, w: f"{w[0]} in the end, settling with {d} in {p[0]:.4g} {u}",
    ),
    "curve": Shape(_curve, lambda d, u, p, w: f"a curve over {d}: {_at(p, u, w)}"),
}


def refined(shape: str, numbers: tuple[float, ...]) -> list[tuple[float, ...]]:
    """Own numbers of a shape a little smaller and larger than those of a rough choice; none of one that is no such."""
    if shape not in _REFINED:
        return []
    found = [(factor * numbers[0], *numbers[1:]) for factor in _FACTORS]
    return found + [(numbers[0], numbers[1] + part * numbers[0]) for part in _MOVES if shape == "sector"]


def columns(shape: str, values: FloatArray, numbers: Numbers) -> FloatArray:
    """Columns of a shape at values of a driver, shape (n,), with the shape's own numbers; shape (n, m).

    Raises:
        KeyError: There is no such shape.
    """
    return np.stack(list(SHAPES[shape].columns(values, numbers)), axis=1)
