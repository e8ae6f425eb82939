"""How well mill and drifts are known: what moves the points by hardly more could be anything and has no name."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.diagnosis.core.fitting.problem import split
from doormill_ros.diagnosis.core.words.margin import Check, Margin
from doormill_ros.diagnosis.parts.effects.case import CutCase
from doormill_ros.diagnosis.parts.fitting.course import InTime
from doormill_ros.diagnosis.parts.fitting.moved import moved
from doormill_ros.statistics import root_mean_square
from doormill_ros.units import m_to_um

#: Standard deviations of mill and drifts that an effect has to move the points by to be none of theirs.
SURE = 2.0
SHARE = 0.02  #: of what a drift moves the points by, to which its law in time is known


def moves_enough(
    case: CutCase, flank: float, members: Sequence[InTime], theta: FloatArray, *causes: InTime
) -> Check:
    """Whether a member of a model, or several together, move the points that they act on by more than that.

    Args:
        case: The points.
        flank: Standard deviation to which the flank of a mill is known [m].
        members: Of the model.
        theta: Its numbers, shape (p,).
        causes: The member, or several.
    """
    parts = split(members, theta)
    without = [
        np.zeros_like(part) if any(member is cause for cause in causes) else part for member, part in parts
    ]
    left = moved(case, members, np.concatenate(without))[0]
    moves = moved(case, members, theta)[0] - left
    acts = moves != 0.0
    size = root_mean_square(moves[acts]) if acts.any() else 0.0
    drifts = [member.effect.drifts or member.course.drifts for member in members]
    still = [np.zeros_like(part) if drift else part for drift, part in zip(drifts, without, strict=True)]
    drift = left - moved(case, members, np.concatenate(still))[0]
    known = float(np.hypot(flank, SHARE * np.sqrt(np.mean(drift**2))))
    margin = Margin(
        f"{' and '.join(map(repr, causes))} moves the points by multiples of what mill and drifts are known to",
        size / known,
        SURE,
        "share",
    )
    against = f"it moves the points by {m_to_um(size):.1f} um, and mill and drifts are known to {m_to_um(known):.1f} um"
    return Check(size <= SURE * known, against, (margin,))
