"""Whether an edge is straight, as far as the picture shows it.

A bow of 0.3 mm over 400 mm bends the 130 mm that show of the bottom edge by 0.03 mm, which a sawn edge leaves to be
told, and the 80 mm that show of the hinge edge by 0.01 mm, less than it wanders. An edge that wanders by s over a
length c leaves the rise over a length L open by s L^2 sqrt(11.25 sqrt(pi) c / l^5) of a piece l: the variance of the
second coefficient of a parabola through l / (sqrt(pi) c) independent points.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.special import stdtrit

from doormill_ros.arrays import FloatArray
from doormill_ros.localization.errors import BowedEdge
from doormill_ros.localization.lines.fit import LineFit
from doormill_ros.localization.settings import LocalizerSettings
from doormill_ros.units import m_to_mm

_CHANCE = 2.0e-3  # probability that a straight edge seems to bend so much
_SPENT = 4.0  # degrees of freedom of an edge's scatter that the arc and the pieces' overlap take


def unseen_bow(line: LineFit, settings: LocalizerSettings) -> float:
    """How far a bow may put an edge off the line of what shows of it, RMS [m], by what is known of doors and seen."""
    squared = settings.straightness_length**2 / 4.0
    known, seen = settings.straightness_deviation**2, line.bend_variance * squared**2
    if not known:
        return 0.0
    share = known / (known + seen)
    return float(np.sqrt(share * seen + (share * line.bend * squared) ** 2))


def check_straight(
    lines: dict[str, LineFit], drawn: Callable[[str], FloatArray], settings: LocalizerSettings
) -> None:
    """Whether what shows of the edges bends no more than straight ones that were sawn.

    Args:
        lines: By edge.
        drawn: Gives an edge in the picture, u, v [px], shape (n, 2).
        settings: Limits of refusal.

    Raises:
        BowedEdge: One bends, and would be further from straight than allowed over `straightness_length`; or doors may
            be bowed so much that it has to be seen, and too little shows of one.
    """
    squared = settings.straightness_length**2 / 4.0  # an arc rises by that much per bend over its length
    for edge, line in lines.items():
        rise, deviation = line.bend * squared, float(np.sqrt(line.bend_variance)) * squared
        open_by = unseen_bow(line, settings)
        if open_by > settings.straightness_limit:
            raise BowedEdge(
                f"doors of this cell are bowed by {m_to_mm(settings.straightness_deviation):.2f} mm (standard "
                f"deviation), and what shows of the {edge} edge leaves {m_to_mm(open_by):.2f} mm of it open, allowed "
                f"are {m_to_mm(settings.straightness_limit):.2f} mm; measure the door by another sensor",
                edge=edge,
                open=open_by,
                marks=((edge, drawn(edge)),),
            )
        if deviation > settings.straightness_limit:
            continue  # too little shows of it for a bow of that size to be told from grain
        # The scatter is learned from few pieces of an edge: Student's distribution.
        often = -float(stdtrit(max(line.freedom - _SPENT, 2.0), 0.5 * _CHANCE))
        sure = often * float(np.hypot(deviation, settings.straightness_deviation))
        if abs(rise) > max(sure, settings.straightness_limit):
            raise BowedEdge(
                f"the {edge} edge is bowed: over {m_to_mm(settings.straightness_length):.0f} mm what shows of it bends "
                f"by {m_to_mm(abs(rise)):.2f} mm (standard deviation {m_to_mm(deviation):.2f}), allowed are "
                f"{m_to_mm(settings.straightness_limit):.2f} mm, and the picture does not tell where the rest of it "
                "runs; straighten the door or mill it by hand; are straight ones refused too, calibrate the lens",
                edge=edge,
                rise=rise,
                deviation=deviation,
                marks=((edge, drawn(edge)),),
            )
