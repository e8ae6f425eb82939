"""How an effect follows what drives it: one entry a shape.

A shape turns the value of a driver into columns of which a law is the weighted sum. Its own numbers (waves a turn, a
time, a threshold, the knots of a curve) are fixed before the fit; the weights are fitted.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from doormill_ros.arrays import FloatArray

Numbers = Sequence[float]


KNOTS = 5  #: of a curve
_SECTOR = 0.2  #: half of a sector, over the range that a driver had
#: By which a rough number is refined, and by which parts of its width a sector is moved.
_FACTORS, _MOVES = (0.6, 0.85, 0.95, 1.05, 1.18, 1.7), (-0.4, -0.1, 0.1, 0.4)
#: Straight lines, and waves of which less than half of one was seen, are believed half as far again as they were seen.
_STRAIGHT = 0.5


def _largest(values: FloatArray) -> float:
    return max(float(np.abs(values).max()), 1e-9)


def _none(part: float, values: FloatArray) -> tuple[float, ...]:
    return ()


def _part_of_largest(part: float, values: FloatArray) -> tuple[float, ...]:
    return (float(part * _largest(values)),)


def _part_of_range(part: float, values: FloatArray) -> tuple[float, ...]:
    return (float((1.0 - part) * values.min() + part * values.max()),)


def _part_and_largest(part: float, values: FloatArray) -> tuple[float, ...]:
    largest = _largest(values)
    return (part * largest, largest)


def _least_positive(part: float, values: FloatArray) -> tuple[float, ...]:
    return (max(float(values.min()), 0.002 * _largest(values)),)


def _sector(part: float, values: FloatArray) -> tuple[float, ...]:
    return (_SECTOR * float(np.ptp(values)), float(values.min() + part * np.ptp(values)))


def _knots(part: float, values: FloatArray) -> tuple[float, ...]:
    return tuple(map(float, np.quantile(values, np.linspace(0.0, 1.0, KNOTS))))


def _as_it_is(numbers: tuple[float, ...]) -> list[tuple[float, ...]]:
    return []


def _scaled(numbers: tuple[float, ...]) -> list[tuple[float, ...]]:
    return [(factor * numbers[0], *numbers[1:]) for factor in _FACTORS]


def _scaled_and_moved(numbers: tuple[float, ...]) -> list[tuple[float, ...]]:
    return _scaled(numbers) + [(numbers[0], numbers[1] + part * numbers[0]) for part in _MOVES]


@dataclass(frozen=True)
class Shape:
    """A family of functions of one variable.

    Attributes:
        columns: Of values (n,) and the shape's own numbers: shape (n, m).
        told: The law in words, of what drives it, its unit, own numbers, and weights as texts.
        reach: By how much of the width of the values that were seen it goes on beyond them; farther out the last
            value stands.
        period: After which it repeats itself, of its own numbers.
        numbers: Its own for a rough part of how a driver was spread that took some values, shape (n,).
        refined: Own numbers a little smaller and larger than those of a rough choice; none where that was none.
        stiff: Whether it cannot bend after every posture: level, straight line, one step.
        constant: Whether it stays the same whatever drives it.
        closed: Whether it is a law in closed form, and no table.
    """

    columns: Callable[[FloatArray, Numbers], Sequence[FloatArray]]
    told: Callable[[str, str, Numbers, Sequence[str]], str]
    reach: float = 0.0
    period: Callable[[Numbers], float] = lambda p: np.inf
    numbers: Callable[[float, FloatArray], tuple[float, ...]] = _part_of_largest
    refined: Callable[[tuple[float, ...]], list[tuple[float, ...]]] = _as_it_is
    stiff: bool = False
    constant: bool = False
    closed: bool = True


def _curve(x: FloatArray, knots: Numbers) -> list[FloatArray]:
    """Cardinal natural splines: a weight is the value of the curve at its knot."""
    # Here, as it is half of the start of a path generator, whose model seldom has a curve.
    from scipy.interpolate import CubicSpline

    spline = CubicSpline(knots, np.eye(len(knots)), bc_type="natural")(x)
    return list(np.moveaxis(spline, -1, 0))


def _at(knots: Numbers, unit: str, w: Sequence[str]) -> str:
    return ", ".join(f"{value} at {knot:.4g} {unit}".rstrip() for knot, value in zip(knots, w, strict=True))


SHAPES: dict[str, Shape] = {
    "level": Shape(
        lambda x, p: [np.ones_like(x)],
        lambda d, u, p, w: f"{w[0]} throughout",
        numbers=_none,
        stiff=True,
        constant=True,
    ),
    "slope": Shape(
        lambda x, p: [x],
        lambda d, u, p, w: f"{w[0]} for each {u} of {d}" if u else f"{w[0]} times {d}",
        reach=_STRAIGHT,
        numbers=_none,
        stiff=True,
    ),
    "rise": Shape(
        lambda x, p: [x - p[0]],
        lambda d, u, p, w: f"{w[0]} for each {u} of {d} above {p[0]:.4g} {u}",
        reach=_STRAIGHT,
        numbers=_part_of_range,
        stiff=True,
    ),
    "line": Shape(
        lambda x, p: [np.ones_like(x), x - p[0]],
        lambda d, u, p, w: f"{w[0]} at {p[0]:.4g} {u} of {d} and {w[1]} for each {u} more",
        reach=_STRAIGHT,
        numbers=_part_of_range,
        stiff=True,
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
        refined=_scaled,
    ),
    "saturating": Shape(
        lambda x, p: [np.tanh(np.abs(x) / p[0])],
        lambda d, u, p, w: f"{w[0]} at large {d}, saturating from {p[0]:.4g} {u} on",
        refined=_scaled,
    ),
    "beyond": Shape(
        lambda x, p: [np.maximum(np.abs(x) - p[0], 0.0) / p[1]],
        lambda d, u, p, w: f"{w[0]} for each {p[1]:.4g} {u} of {d} beyond {p[0]:.4g} {u}",
        numbers=_part_and_largest,
        refined=_scaled,
    ),
    "opening": Shape(
        lambda x, p: [np.maximum(x - p[0], 0.0) / p[1]],
        lambda d, u, p, w: f"{w[0]} for each {p[1]:.4g} {u} of {d} beyond {p[0]:.4g} {u}",
        reach=np.inf,
        numbers=_part_and_largest,
        refined=_scaled,
    ),
    "limited": Shape(
        lambda x, p: [np.minimum(np.abs(x) / p[0], 1.0)],
        lambda d, u, p, w: f"{w[0]} from {p[0]:.4g} {u} of {d} on, in proportion below",
        refined=_scaled,
    ),
    "past": Shape(
        lambda x, p: [(np.abs(x) > p[0]).astype(float)],
        lambda d, u, p, w: f"{w[0]} once {d} is larger than {p[0]:.4g} {u}",
        numbers=lambda part, x: (float(np.quantile(np.abs(x), part)),),
        refined=_scaled,
        stiff=True,
    ),
    "positive": Shape(
        lambda x, p: [(x > 0.0).astype(float)],
        lambda d, u, p, w: f"{w[0]} where {d} is positive",
        numbers=_none,
    ),
    "negative": Shape(
        lambda x, p: [(x < 0.0).astype(float)],
        lambda d, u, p, w: f"{w[0]} where {d} is negative",
        numbers=_none,
    ),
    "sign": Shape(
        lambda x, p: [np.sign(x)],
        lambda d, u, p, w: f"{w[0]} times the sign of {d}",
        numbers=_none,
    ),
    "sector": Shape(
        lambda x, p: [0.5 + 0.5 * np.cos(np.pi * np.clip((x - p[1]) / p[0], -1.0, 1.0))],
        lambda d, u, p, w: f"{w[0]} at {p[1]:.4g} {u} of {d}, fading away within {p[0]:.4g} {u}",
        numbers=_sector,
        refined=_scaled_and_moved,
    ),
    "waves": Shape(
        lambda x, p: [np.sin(p[0] * x), np.cos(p[0] * x)],
        lambda d, u, p, w: f"{p[0]:.4g} waves a turn of {d}: sine {w[0]}, cosine {w[1]}",
        reach=_STRAIGHT,
        period=lambda p: 2.0 * np.pi / p[0],
        numbers=lambda part, x: (float(part),),
    ),
    "periods": Shape(
        lambda x, p: [np.sin(2.0 * np.pi * x / p[0]), np.cos(2.0 * np.pi * x / p[0])],
        lambda d, u, p, w: f"with a period of {p[0]:.4g} {u} of {d}: sine {w[0]}, cosine {w[1]}",
        refined=_scaled,
    ),
    "logarithm": Shape(
        lambda x, p: [np.log(np.maximum(x, 1e-9) / p[0])],
        lambda d, u, p, w: f"{w[0]} for each factor of e in {d}, from {p[0]:.4g} {u} on",
        numbers=_least_positive,
    ),
    "logarithmic line": Shape(
        lambda x, p: [np.ones_like(x), np.log(np.maximum(x, 1e-9) / p[0])],
        lambda d, u, p, w: f"{w[0]} at {p[0]:.4g} {u} of {d} and {w[1]} for each factor of e more",
        numbers=_least_positive,
    ),
    "creeping": Shape(
        lambda x, p: [np.log1p(np.abs(x) / p[0])],
        lambda d, u, p, w: f"{w[0]} for each factor of e in {d} after {p[0]:.4g} {u}",
        refined=_scaled,
    ),
    "settling": Shape(
        lambda x, p: [1.0 - np.exp(-np.abs(x) / p[0])],
        lambda d, u, p, w: f"{w[0]} in the end, settling with {d} in {p[0]:.4g} {u}",
        refined=_scaled,
    ),
    "curve": Shape(
        _curve,
        lambda d, u, p, w: f"a curve over {d}: {_at(p, u, w)}",
        numbers=_knots,
        closed=False,
    ),
}


def columns(shape: str, values: FloatArray, numbers: Numbers) -> FloatArray:
    """Columns of a shape at values of a driver, shape (n,), with the shape's own numbers; shape (n, m).

    Raises:
        KeyError: There is no such shape.
    """
    return np.stack(list(SHAPES[shape].columns(values, numbers)), axis=1)
