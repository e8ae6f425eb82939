"""How sure the numbers of causes are where something remains: more than the scatter of a fit whose form is in doubt."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.diagnosis.motion.examination import JointFinding
from doormill_ros.diagnosis.motion.model import JointFit


def in_doubt(finding: JointFinding) -> JointFit:
    """The causes of a joint, with what one more candidate would move their numbers in their deviations.

    Whatever predicts rows left out better may be a part of what remains: another recording may show it, or not, and the
    numbers beside it are others. Where nothing remains they are as the fit says.
    """
    extended, search = finding.extended, finding.search
    if not finding.examiner.remains(extended):
        return extended
    larger = search.grown([extended], None, extended)
    return _spread(extended, (one for one in larger if search.gain(extended, one).score > 0.0))


def beside_remainder(beside: JointFit, alone: JointFit) -> JointFit:
    """Causes with numbers beside laws that leave more than noise, known no better than without these laws.

    Args:
        beside: The causes as they are told.
        alone: The same without laws.
    """
    moved = _spread(beside, (alone,))
    return _with_std(moved, alone, np.maximum)


def _spread(fit: JointFit, others: Iterable[JointFit]) -> JointFit:
    """A fit with the largest step to the numbers of others, which begin with its members, in its deviations."""
    steps = [_steps(fit, other) for other in others]
    if not steps:
        return fit
    largest = replace(
        fit,
        std=tuple(np.max(part, axis=0) for part in zip(*(shared for shared, _ in steps), strict=True)),
        own_std=tuple(
            tuple(np.max(one, axis=0) for one in zip(*part, strict=True))
            for part in zip(*(own for _, own in steps), strict=True)
        ),
    )
    return _with_std(fit, largest, np.hypot)


def _steps(fit: JointFit, other: JointFit) -> tuple[list[FloatArray], list[list[FloatArray]]]:
    """Distances of the numbers of two fits by member of the first, shared ones and own ones by recording."""
    late = other.delay - fit.delay
    shared = [
        np.abs(after - before + late * cause.of_delay)
        for cause, before, after in zip(fit.members, fit.x, other.x, strict=False)
    ]
    own = [
        [np.abs(after - before) for before, after in zip(mine, theirs, strict=True)]
        for mine, theirs in zip(fit.own, other.own, strict=False)
    ]
    return shared, own


def _with_std(
    fit: JointFit, other: JointFit, joined: Callable[[FloatArray, FloatArray], FloatArray]
) -> JointFit:
    """A fit with its deviations and those of another joined."""
    return replace(
        fit,
        std=tuple(joined(one, two) for one, two in zip(fit.std, other.std, strict=True)),
        own_std=tuple(
            tuple(joined(one, two) for one, two in zip(mine, theirs, strict=True))
            for mine, theirs in zip(fit.own_std, other.own_std, strict=True)
        ),
    )
