"""How far off a new pose is expected to be, and whether rows that no fit has seen were off by as much."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.diagnosis.pose.diagnosis import PoseDiagnosis
from doormill_ros.diagnosis.pose.fitting.validation import Split
from doormill_ros.statistics import root_mean_square

#: Standard deviations on either side that hold 95 of 100 normal errors.
NORMAL_95 = 1.96
#: Rows of a series that are looked at, and groups of them by what is expected.
_ROWS, _GROUPS = 400, 5


@dataclass(frozen=True, eq=False)
class Certainty:
    """What a fit expected of rows of one series that it had not seen, and what came.

    Attributes:
        name: Of the series.
        expected: Standard deviation of the position error, root of the sum over the axes, shape (n,) [m].
        off: Length of the position error, shape (n,) [m].
        within: Share of the components of the position error inside their intervals of 95 %.
    """

    name: str
    expected: FloatArray
    off: FloatArray
    within: float


def certainties(
    diagnosis: PoseDiagnosis, splits: Sequence[Split], errors: Sequence[FloatArray]
) -> list[Certainty]:
    """Expectation and outcome for every series; gross errors apart.

    A new pose is off by what is uncertain in the coefficients and by what the fit leaves of rows that it has seen.

    Args:
        diagnosis: The diagnosis.
        splits: Its fits with parts left out.
        errors: What they leave of the rows that they have not seen, shape (n, 6) for each series.
    """
    problem, validation = diagnosis.extended.problem, diagnosis.extended.validation
    found = []
    for series, (data, error) in enumerate(zip(problem.sets, errors, strict=True)):
        good = np.flatnonzero(~diagnosis.gross[series])
        chosen = good[np.unique(np.linspace(0, len(good) - 1, _ROWS).astype(int))]
        variance, miss = [], []
        for split in splits:
            rows = np.intersect1d(chosen, split.rows[series])
            if len(rows):
                variance.append(validation.variance(split, series, rows))
                miss.append(error[rows, :3])
        spread = np.concatenate(variance) + problem.sigmas[series][0] ** 2
        off = np.concatenate(miss)
        within = float(np.mean(np.abs(off) <= NORMAL_95 * np.sqrt(spread)))
        found.append(Certainty(data.name, np.sqrt(spread.sum(axis=1)), np.linalg.norm(off, axis=1), within))
    return found


def certainty_section(diagnosis: PoseDiagnosis) -> dict[str, list[dict[str, Any]]]:
    """The same for diagnosis.json, with blocks and with whole series left out."""
    validation, after = diagnosis.extended.validation, diagnosis.after
    parts = {"blocks_left_out": (validation.blocks, after.blocks)}
    if after.series:
        parts["series_left_out"] = (validation.series, after.series)
    return {
        name: [_told(one) for one in certainties(diagnosis, splits, errors)]
        for name, (splits, errors) in parts.items()
    }


def _told(one: Certainty) -> dict[str, Any]:
    order = np.array_split(np.argsort(one.expected, kind="stable"), _GROUPS)
    return {
        "set": one.name,
        "rows": len(one.off),
        "within_95": one.within,
        "expected_rmse": root_mean_square(one.expected),
        "rmse": root_mean_square(one.off),
        "groups": [
            {"expected_rmse": root_mean_square(one.expected[group]), "rmse": root_mean_square(one.off[group])}
            for group in order
            if len(group)
        ],
    }
