"""Decides which causes are real: by rows that no fit has seen."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from doormill_ros.diagnosis.pose.causes.cause import PoseCause
from doormill_ros.diagnosis.pose.validation import Validation, by_block

#: A cause earns its place when taking it away raises the held-out cost of the blocks by this many standard errors
#: and by this much altogether (a squared standard deviation is 1; tried causes are a few dozen).
SURE, WORTH = 3.0, 25.0
#: ... and by this share of all that can be explained.
SHARE = 1e-4


@dataclass(frozen=True, eq=False)
class Score:
    """What taking a cause away costs on rows left out.

    Attributes:
        cause: The cause.
        gain: Fall of the cost by the cause with blocks left out, for every series, shape (series,).
        sure: The same in standard errors over the blocks, shape (series,).
        total, total_sure: Over all series.
        transfer: Fall of the cost with a whole series left out, by series; empty with a single series.
        rmse_without: Position error without the cause, blocks left out [m].
        status: "real", "one series", "no gain".
    """

    cause: PoseCause
    gain: np.ndarray
    sure: np.ndarray
    total: float
    total_sure: float
    transfer: np.ndarray
    rmse_without: float
    status: str


def position_rmse(errors: list[np.ndarray], kept: list[np.ndarray]) -> float:
    """Root mean square of the 3-D position error over all rows that count [m]."""
    every = np.concatenate([error[good, :3] for error, good in zip(errors, kept, strict=True)])
    return float(np.sqrt(np.mean(np.sum(every**2, axis=1)))) if len(every) else 0.0


def explained_cost(validation: Validation) -> float:
    """How much of the held-out cost all causes together take away."""
    size = validation.fitted.problem.layout.size
    full = validation.cost(validation.residuals(validation.blocks, np.zeros(0, dtype=int)))
    empty = validation.cost(validation.residuals(validation.blocks, np.arange(size)))
    return max(sum(float(np.sum(a - b)) for a, b in zip(empty, full, strict=True)), 1.0)


def scores(validation: Validation, chosen: Sequence[int], explained: float) -> list[Score]:
    """Score of some causes of a fit (by index) when each alone is taken away."""
    layout = validation.fitted.problem.layout
    kept = [weight > 0.0 for weight in validation.fitted.problem.weights]
    none = np.zeros(0, dtype=int)
    full = validation.cost(validation.residuals(validation.blocks, none))
    full_series = validation.cost(validation.residuals(validation.series, none)) if validation.series else []
    found = []
    for index in chosen:
        cause = layout.causes[index]
        ids = np.arange(layout.size)[layout.part(index)]
        errors = validation.residuals(validation.blocks, ids)
        change = by_block([a - b for a, b in zip(validation.cost(errors), full, strict=True)])
        gain = np.array([part.sum() for part in change])
        sure = np.array([_standard_errors(part) for part in change])
        every = np.concatenate(change)
        transfer = np.zeros(0)
        if validation.series and cause.transfers:
            costs = validation.cost(validation.residuals(validation.series, ids))
            transfer = np.array([float(np.sum(a - b)) for a, b in zip(costs, full_series, strict=True)])
        total, total_sure = float(every.sum()), _standard_errors(every)
        status = _status(cause, gain, sure, total, total_sure, max(WORTH, SHARE * explained))
        found.append(
            Score(cause, gain, sure, total, total_sure, transfer, position_rmse(errors, kept), status)
        )
    return found


def eliminate(validation: Validation, progress: Callable[[str], None]) -> tuple[list[Score], list[Score]]:
    """Take causes away that do not help, the least helpful half of them at a time.

    Returns:
        Scores of the causes that stay, and of those that went when they went.
    """
    layout = validation.fitted.problem.layout
    explained = explained_cost(validation)
    remaining = list(range(len(layout.causes)))
    now = dict(zip(remaining, scores(validation, remaining, explained), strict=True))
    gone: list[Score] = []
    while weak := sorted((i for i in remaining if now[i].status != "real"), key=lambda i: now[i].total):
        leave = weak[: (len(weak) + 1) // 2]
        gone += [now[i] for i in leave]
        remaining = [i for i in remaining if i not in leave]
        validation.remove(np.concatenate([np.arange(layout.size)[layout.part(i)] for i in leave]))
        left = [i for i in remaining if i in weak]
        now.update(zip(left, scores(validation, left, explained), strict=True))
        progress(f"{len(gone)} of {len(layout.causes)} causes do not earn their place")
    return [now[i] for i in remaining], gone


def _standard_errors(change: np.ndarray) -> float:
    """Sum over its standard error, taken from the scatter of the blocks."""
    if len(change) < 2:
        return 0.0
    return float(change.sum() / max(change.std(ddof=1) * np.sqrt(len(change)), 1e-9))


def _status(
    cause: PoseCause, gain: np.ndarray, sure: np.ndarray, total: float, total_sure: float, worth: float
) -> str:
    strong = (sure > SURE) & (gain > worth)
    if not (strong.any() or (total > worth and total_sure > SURE)):
        return "no gain"
    if not cause.transfers or len(gain) == 1:
        return "real"
    # A property of the robot shows in every series that excites it; one voice among several is none.
    helped = (gain > WORTH) & (sure > 2.0)
    return "real" if helped.sum() >= 2 else "one series"
