"""The words of a verdict and the measure it rests on, for every kind of data."""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import BoolArray, FloatArray

CONSISTENT, EXPLAINED = "consistent", "explained"
PARTLY_EXPLAINED, UNEXPLAINED = "partly_explained", "unexplained"
#: Held-out error over noise up to which a model explains everything, where the noise is not that of independent rows.
AT_NOISE = 1.1
#: Share of the excess over the noise, squared, that causes explain together to be named where something remains.
MAIN_PART = 0.5


def rmse(residual: FloatArray, kept: BoolArray, components: int = 3) -> float:
    """Root mean square over all measured components of the trials that count, in the unit of the residual.

    Args:
        residual: Shape (n, m).
        kept: Shape (n,).
        components: By how many components of a trial the sum is divided; 1 for the length of a whole residual.
    """
    return float(np.sqrt(np.sum(residual[kept] ** 2) / (components * max(int(kept.sum()), 1))))


def judge(found: bool, silent: bool, quiet: bool, share: float, main_part: float) -> str:
    """The verdict.

    Args:
        found: Whether a cause may be named.
        silent: Whether the model in question is at the noise and nothing could be added to it.
        quiet: Whether the extended model is at the noise and holds all that was found.
        share: Of the excess over the noise, squared, that the causes explain.
        main_part: Share from which that counts where something remains.
    """
    if not found:
        return CONSISTENT if silent else UNEXPLAINED
    if quiet:
        return EXPLAINED
    return PARTLY_EXPLAINED if share > main_part else UNEXPLAINED
