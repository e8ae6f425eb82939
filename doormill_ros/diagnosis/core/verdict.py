"""The words of a verdict and the measure it rests on, for every kind of data."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from doormill_ros.arrays import BoolArray, FloatArray

CONSISTENT, EXPLAINED = "consistent", "explained"
PARTLY_EXPLAINED, UNEXPLAINED = "partly_explained", "unexplained"


def rmse(residual: FloatArray, kept: BoolArray, components: int = 3) -> float:
    """Root mean square over all measured components of the trials that count, in the unit of the residual.

    Args:
        residual: Shape (n, m).
        kept: Shape (n,).
        components: By how many components of a trial the sum is divided; 1 for the length of a whole residual.
    """
    return float(np.sqrt(np.sum(residual[kept] ** 2) / (components * max(int(kept.sum()), 1))))


def spoken_verdict(verdict: str, names: str, micrometres: Sequence[str], off_by: str, held_out: str) -> str:
    """The verdict and what it rests on, in one line.

    Args:
        verdict: One of the four words.
        names: Established causes, those that are tied with each included.
        micrometres: What is off before and after, and the noise.
        off_by: What the model in question is off by.
        held_out: The same of trials left out.
    """
    before, after, noise = micrometres
    if verdict == CONSISTENT:
        return f"{verdict}: the {off_by} of {before} um is the measurement noise ({noise} um)"
    if verdict == UNEXPLAINED:
        return f"{verdict}: {before} um against {noise} um of noise, and no known cause earns its place"
    return f"{verdict}: {names}; held-out {held_out} {before} -> {after} um, noise {noise} um"
