"""Small scatter and bar charts as SVG text."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from html import escape

import numpy as np

from doormill_ros.arrays import FloatArray

BEFORE = "#c2562d"
AFTER = "#1f6f8b"
OTHER = "#8a8f98"
GOOD = "#3b7d4f"
_WIDTH, _HEIGHT = 380, 250
_LEFT, _RIGHT, _TOP, _BOTTOM = 54, 12, 30, 40


@dataclass
class Scatter:
    """A scatter chart.

    Attributes:
        title, x_label, y_label: Texts; units belong in the labels.
        series: Name, colour, x and y of each cloud.
        lines: Name, colour, x and y of each polyline.
        band: Half height of a shaded band around zero, or None.
        square: Whether both axes show the same range.
        width: Of the drawing; give what the page gives it, or texts are blown up.
        limits: Range of the second axis, or None for that of the data.
    """

    title: str
    x_label: str
    y_label: str
    series: list[tuple[str, str, FloatArray, FloatArray]] = field(default_factory=list)
    lines: list[tuple[str, str, FloatArray, FloatArray]] = field(default_factory=list)
    band: float | None = None
    square: bool = False
    width: int = _WIDTH
    limits: tuple[float, float] | None = None

    def svg(self) -> str:
        """The chart."""
        clouds = [*self.series, *self.lines]
        x = np.concatenate([s[2] for s in clouds] or [np.zeros(1)])
        y = np.concatenate([s[3] for s in clouds] or [np.zeros(1)])
        if self.band is not None:
            y = np.append(y, [self.band, -self.band])
        x_range, y_range = _range(x), _range(y if self.limits is None else np.array(self.limits))
        if self.square:
            x_range = y_range = (min(x_range[0], y_range[0]), max(x_range[1], y_range[1]))
        frame = _Frame(x_range, y_range, self.width)
        parts = [frame.open(self.title, self.x_label, self.y_label)]
        if self.band is not None:
            top, bottom = frame.y(self.band), frame.y(-self.band)
            parts.append(
                f'<rect x="{_LEFT}" y="{top:.1f}" width="{self.width - _LEFT - _RIGHT}" '
                f'height="{bottom - top:.1f}" fill="#dfe7ea"/>'
            )
        parts.append(frame.grid())
        for name, colour, xs, ys in self.series:
            size = 2.6 if len(xs) < 400 else 1.8
            dots = "".join(
                f'<circle cx="{frame.x(a):.1f}" cy="{frame.y(b):.1f}" r="{size}"/>'
                for a, b in zip(xs, ys, strict=True)
            )
            parts.append(f'<g fill="{colour}" fill-opacity="0.65"><title>{escape(name)}</title>{dots}</g>')
        for name, colour, xs, ys in self.lines:
            points = " ".join(f"{frame.x(a):.1f},{frame.y(b):.1f}" for a, b in zip(xs, ys, strict=True))
            parts.append(
                f'<polyline points="{points}" fill="none" stroke="{colour}" stroke-width="1.6">'
                f"<title>{escape(name)}</title></polyline>"
            )
        names = list(dict.fromkeys((n, c) for n, c, *_ in clouds if n))
        parts.append(_legend(names, self.width))
        return "".join(parts) + "</svg>"


@dataclass
class Bars:
    """A horizontal bar chart.

    Attributes:
        title: Text above.
        unit: Shown behind each value.
        rows: Label, value and colour of each bar.
        mark: A value to mark with a vertical line, and its name.
    """

    title: str
    unit: str
    rows: Sequence[tuple[str, float, str]]
    mark: tuple[str, float] | None = None
    width: int = 2 * _WIDTH

    def svg(self) -> str:
        """The chart."""
        left, step = 270, 20
        height = _TOP + step * len(self.rows) + 26
        top = max([value for _, value, _ in self.rows] + [self.mark[1] if self.mark else 0.0, 1e-12])
        scale = (self.width - left - 90) / top
        parts = [
            f'<svg viewBox="0 0 {self.width} {height}" role="img" aria-label="{escape(self.title)}">'
            f'<text x="4" y="16" class="t">{escape(self.title)}</text>'
        ]
        for i, (label, value, colour) in enumerate(self.rows):
            y = _TOP + i * step
            parts.append(
                f'<text x="{left - 6}" y="{y + 12}" text-anchor="end" class="l">{escape(label)}</text>'
                f'<rect x="{left}" y="{y + 1}" width="{max(value * scale, 0.5):.1f}" '
                f'height="{step - 6}" fill="{colour}"/>'
                f'<text x="{left + value * scale + 5:.1f}" y="{y + 12}" class="l h">'
                f"{value:.3g} {escape(self.unit)}</text>"
            )
        if self.mark:
            x = left + self.mark[1] * scale
            bottom = _TOP + step * len(self.rows)
            parts.append(
                f'<line x1="{x:.1f}" x2="{x:.1f}" y1="{_TOP - 4}" y2="{bottom}" stroke="#333" stroke-dasharray="4 3"/>'
                f'<text x="{x:.1f}" y="{bottom + 14}" text-anchor="middle" class="l">{escape(self.mark[0])}</text>'
            )
        return "".join(parts) + "</svg>"


class _Frame:
    """Axes of a scatter chart."""

    def __init__(self, x: tuple[float, float], y: tuple[float, float], width: int) -> None:
        self.x_range, self.y_range, self.width = x, y, width

    def x(self, value: float) -> float:
        low, high = self.x_range
        return _LEFT + (value - low) / (high - low) * (self.width - _LEFT - _RIGHT)

    def y(self, value: float) -> float:
        low, high = self.y_range
        return _HEIGHT - _BOTTOM - (value - low) / (high - low) * (_HEIGHT - _TOP - _BOTTOM)

    def open(self, title: str, x_label: str, y_label: str) -> str:
        middle = (_TOP + _HEIGHT - _BOTTOM) / 2
        return (
            f'<svg viewBox="0 0 {self.width} {_HEIGHT}" role="img" aria-label="{escape(title)}">'
            f'<text x="4" y="16" class="t">{escape(title)}</text>'
            f'<text x="{(_LEFT + self.width) / 2}" y="{_HEIGHT - 6}" text-anchor="middle" class="l">'
            f"{escape(x_label)}</text>"
            f'<text x="12" y="{middle}" text-anchor="middle" class="l" transform="rotate(-90 12 {middle})">'
            f"{escape(y_label)}</text>"
        )

    def grid(self) -> str:
        parts = []
        for value in _ticks(*self.x_range):
            x = self.x(value)
            parts.append(
                f'<line x1="{x:.1f}" x2="{x:.1f}" y1="{_TOP}" y2="{_HEIGHT - _BOTTOM}" class="g"/>'
                f'<text x="{x:.1f}" y="{_HEIGHT - _BOTTOM + 14}" text-anchor="middle" class="n">{value:g}</text>'
            )
        for value in _ticks(*self.y_range):
            y = self.y(value)
            parts.append(
                f'<line x1="{_LEFT}" x2="{self.width - _RIGHT}" y1="{y:.1f}" y2="{y:.1f}" class="g"/>'
                f'<text x="{_LEFT - 5}" y="{y + 3.5:.1f}" text-anchor="end" class="n">{value:g}</text>'
            )
        return "".join(parts)


def _range(values: FloatArray) -> tuple[float, float]:
    values = values[np.isfinite(values)]
    low, high = (float(values.min()), float(values.max())) if len(values) else (0.0, 1.0)
    margin = 0.06 * (high - low) or 0.5 * abs(high) or 1.0
    return low - margin, high + margin


def _ticks(low: float, high: float) -> FloatArray:
    raw = (high - low) / 5.0
    size = 10.0 ** np.floor(np.log10(raw))
    step = size * min((m for m in (1.0, 2.0, 5.0, 10.0) if m * size >= raw), default=10.0)
    ticks = np.arange(np.ceil(low / step), np.floor(high / step) + 1.0) * step
    return np.round(ticks, 12) + 0.0


def _legend(names: Sequence[tuple[str, str]], width: int) -> str:
    x, parts = width - _RIGHT, []
    for name, colour in reversed(names):
        parts.append(
            f'<text x="{x}" y="27" text-anchor="end" class="n" style="fill:{colour}">&#9679; {escape(name)}</text>'
        )
        x -= int(6.0 * len(name)) + 18
    return "".join(parts)
