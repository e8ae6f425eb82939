"""Decides which causes are real: by rows that no fit has seen."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from doormill_ros.arrays import BoolArray, FloatArray
from doormill_ros.diagnosis.core.fitting.held_out import gain_in_errors, gain_in_expected_errors
from doormill_ros.diagnosis.core.words.verdict import rmse
from doormill_ros.diagnosis.pose.fitting.validation import AXES_OF_POSITION, Validation, by_block
from doormill_ros.robot_model.pose.causes.cause import PoseCause

#: A cause earns its place when taking it away raises the held-out cost of the blocks by this many standard errors
#: and by this much altogether (a squared standard deviation is 1; tried causes are a few dozen).
SURE, WORTH = 3.0, 25.0
#: ... and by this share of what all causes together leave: beside much that has no name, little is believed.
SHARE = 7e-3

REAL = "real"
NO_GAIN = "does not help on blocks left out"
ONE_SERIES = "helps within one series only"
NOT_CARRIED = "helps on blocks, yet not on a series that was left out as a whole"
MATCHED = "does nothing that another cause does not do as well"
CONTRADICTED = "betters the rotation and spoils the position, which no cause of that name does"


@dataclass(frozen=True, eq=False)
class Score:
    """What taking a cause away costs on rows left out.

    Attributes:
        cause: The cause.
        gain: Fall of the cost by the cause with blocks left out, for every series, shape (series,).
        sure: The same in standard errors over the blocks, shape (series,).
        total, total_sure: Over all series.
        transfer: Fall of the cost with a whole series left out, by series; empty with a single series.
        position_sure: Fall of the position's part of the cost with blocks left out, in standard errors.
        rmse_without: Position error without the cause, blocks left out [m].
        status: REAL, ONE_SERIES, NOT_CARRIED, CONTRADICTED, MATCHED or NO_GAIN.
    """

    cause: PoseCause
    gain: FloatArray
    sure: FloatArray
    total: float
    total_sure: float
    transfer: FloatArray
    position_sure: float
    rmse_without: float
    status: str


def _position_rmse(errors: Sequence[FloatArray], kept: Sequence[BoolArray]) -> float:
    return rmse(np.concatenate(errors)[:, :3], np.concatenate(kept), 1)


def scores(validation: Validation, chosen: Sequence[int], left: float) -> list[Score]:
    """Score of some causes of a fit (by index) when each alone is taken away; all together leave a cost `left`."""
    layout = validation.fitted.problem.layout
    kept = [weight > 0.0 for weight in validation.fitted.problem.weights]
    sigma = np.array([position for position, _ in validation.fitted.problem.sigmas])
    every = [(layout.causes[index], np.arange(layout.size)[layout.part(index)]) for index in chosen]
    # What others imitate is asked once more without the part that they do as well.
    asked = [*every, *((cause, ids[cause.imitated :]) for cause, ids in every if cause.imitated)]
    none = np.zeros(0, dtype=int)
    in_blocks = validation.residuals_less(validation.blocks, [none, *(ids for _, ids in asked)])
    in_series = validation.residuals_less(
        validation.series, [none, *(ids for cause, ids in asked if cause.of_robot)]
    )
    unseen = next(in_blocks)
    full = validation.cost(unseen)
    full_position = validation.cost(unseen, AXES_OF_POSITION)
    full_series = validation.cost(next(in_series))

    def score_of(cause: PoseCause, errors: Sequence[FloatArray]) -> Score:
        change = by_block([a - b for a, b in zip(validation.cost(errors), full, strict=True)])
        gain = np.array([part.sum() for part in change])
        every = np.concatenate(change)
        if cause.timed:
            expected = by_block(validation.cost([a - b for a, b in zip(errors, unseen, strict=True)]))
            sure = np.array([gain_in_expected_errors(a, b) for a, b in zip(change, expected, strict=True)])
            total_sure = gain_in_expected_errors(every, np.concatenate(expected))
        else:
            sure = np.array([gain_in_errors(part) for part in change])
            total_sure = gain_in_errors(every)
        transfer = np.zeros(0)
        if cause.of_robot:
            costs = validation.cost(next(in_series))
            if validation.series:
                transfer = np.array([float(np.sum(a - b)) for a, b in zip(costs, full_series, strict=True)])
        position = by_block(
            [a - b for a, b in zip(validation.cost(errors, AXES_OF_POSITION), full_position, strict=True)]
        )
        position_sure = gain_in_errors(np.concatenate(position))
        score = Score(
            cause,
            gain,
            sure,
            float(every.sum()),
            total_sure,
            transfer,
            position_sure,
            _position_rmse(errors, kept),
            NO_GAIN,
        )
        return replace(score, status=_status(score, max(WORTH, SHARE * left), sigma))

    found = [score_of(cause, errors) for (cause, _), errors in zip(asked, in_blocks, strict=True)]
    own = {id(score.cause): score.status for score in found[len(every) :]}
    return [
        replace(score, status=MATCHED) if own.get(id(score.cause), REAL) != REAL else score
        for score in found[: len(every)]
    ]


def _status(score: Score, worth: float, sigma: FloatArray) -> str:
    """What becomes of a cause that has to gain so much; standard deviations of the series, shape (series,) [m]."""
    strong = (score.sure > SURE) & (score.gain > worth)
    if not (strong.any() or (score.total > worth and score.total_sure > SURE)):
        return NO_GAIN
    if score.position_sure < -SURE:
        return CONTRADICTED
    if not score.cause.of_robot or len(score.gain) == 1:
        return REAL
    # A property of the robot shows in every series that excites it; one voice among several is none, unless the others
    # are too noisy to be heard.
    helped = (score.gain > WORTH) & (score.sure > 2.0)
    heard = int(np.sum(np.max(score.gain * sigma**2) / sigma**2 > WORTH))
    if helped.sum() < (1 if heard == 1 else 2):
        return ONE_SERIES
    # A series at angles that no other visited may lose by it; where most lose, it is the others' habit. One series
    # alone teaches too little to judge by that, and the lengths and angles of a link are nobody's habit.
    if len(score.transfer) < 3 or score.cause.drawn_wrong:
        return REAL
    harmed = score.transfer.sum() < 0.0 and 2 * np.sum(score.transfer < 0.0) > len(score.transfer)
    return NOT_CARRIED if harmed else REAL
