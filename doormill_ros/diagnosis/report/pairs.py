"""Two thin bars a row: before and after, with the noise as a line."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from html import escape

from doormill_ros.diagnosis.report.svg import AFTER, BEFORE

_LEFT, _RIGHT, _TOP, _STEP, _THIN = 92, 116, 34, 25, 9
_LONGEST = 13  #: letters of a label; the rest stands in its tool tip


@dataclass
class Pairs:
    """A horizontal bar chart with one or two bars a row.

    Attributes:
        title: Text above.
        unit: Shown behind the values.
        rows: Label and values of each row; the first value is before, the second after.
        mark: A value to mark with a vertical line, and its name.
        width: Of the drawing.
    """

    title: str
    unit: str
    rows: Sequence[tuple[str, tuple[float, ...]]]
    mark: tuple[str, float]
    width: int = 380

    def svg(self) -> str:
        """The chart."""
        bottom = _TOP + _STEP * len(self.rows)
        top = max([v for _, values in self.rows for v in values] + [self.mark[1], 1e-12])
        scale = (self.width - _LEFT - _RIGHT) / top
        line = _LEFT + self.mark[1] * scale
        parts = [
            f'<svg viewBox="0 0 {self.width} {bottom + 24}" role="img" aria-label="{escape(self.title)}">'
            f'<text x="4" y="16" class="t">{escape(self.title)}</text>'
        ]
        for i, (label, values) in enumerate(self.rows):
            y = _TOP + i * _STEP
            short = label if len(label) <= _LONGEST else label[: _LONGEST - 1] + "…"
            parts.append(
                f'<text x="{_LEFT - 6}" y="{y + 13}" text-anchor="end" class="l"><title>{escape(label)}</title>'
                f"{escape(short)}</text>"
            )
            for j, (value, colour) in enumerate(zip(values, (BEFORE, AFTER), strict=False)):
                size = _THIN if len(values) > 1 else 2 * _THIN
                parts.append(
                    f'<rect x="{_LEFT}" y="{y + 1 + j * (_THIN + 1)}" width="{max(value * scale, 0.5):.1f}" '
                    f'height="{size}" fill="{colour}"/>'
                )
            shown = f" {chr(0x2192)} ".join(f"{v:.3g}" for v in values)
            end = _LEFT + max(values) * scale
            parts.append(
                f'<text x="{end + 5:.1f}" y="{y + 13}" class="l h">{shown} {escape(self.unit)}</text>'
            )
        parts.append(
            f'<line x1="{line:.1f}" x2="{line:.1f}" y1="{_TOP - 4}" y2="{bottom}" stroke="#1d2327" '
            f'stroke-dasharray="3 3"/><text x="{line:.1f}" y="{bottom + 14}" text-anchor="middle" class="n">'
            f"{escape(self.mark[0])}</text>"
        )
        return "".join(parts) + "</svg>"
