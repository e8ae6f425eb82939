"""How a pocket is cleared: in how many levels, and in how many contours each."""

from __future__ import annotations

import math

STEPOVER = 0.8  #: of the tool diameter; below 0.85 no wood is left in the corners of square rings


def levels(depth: float, step: float) -> list[float]:
    """Depths of the cuts: equal ones, none deeper than the step [m]."""
    count = max(1, math.ceil(depth / step - 1e-9))
    return [depth * (i + 1) / count for i in range(count)]


def rings(inset: float, half: float, radius: float) -> list[float]:
    """Insets of the contours that clear a pocket, the innermost first [m].

    Args:
        inset: Inset of the outermost contour.
        half: Half the width of the pocket.
        radius: Tool radius.
    """
    # The innermost contour must reach the middle; a tenth of the radius to spare.
    innermost = half - 0.9 * radius
    if innermost <= inset:
        return [inset]
    count = math.ceil((innermost - inset) / (STEPOVER * 2.0 * radius))
    return [inset + (innermost - inset) * i / count for i in range(count, -1, -1)]
