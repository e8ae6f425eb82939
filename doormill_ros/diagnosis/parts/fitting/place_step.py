"""The door from which on doors stand elsewhere by where they were cut: what a moved camera or clamp leaves.

What a wrong force or a gap makes of a place differs from recipe to recipe and is the same before and after; what warms
goes on. A step is what neither of them makes.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.distributions import chi2_sf

#: Chance to see a step where there is none, over all doors at which it could be.
_CHANCE = 1e-3
_FREE = 4  #: doors beyond what the places are described by
_CURVED = 12  #: doors from which on a drift may bend
_OWN = 1e-6  #: share of a step that must be its own, and not of recipes and drift


def place_step(places: FloatArray, recipes: Sequence[str]) -> int:
    """Number of the door from which on doors stand elsewhere; 0 where none does.

    Wilks' lambda of a step in three axes taken as independent, with Bartlett's approximation; the most likely door.

    Args:
        places: Place of each door, in order, shape (d, 3).
        recipes: What each of them is.
    """
    count = len(places)
    time = np.linspace(-1.0, 1.0, count) if count > 1 else np.zeros(count)
    names = np.unique(np.array(recipes), return_inverse=True)[1].ravel()
    columns = [*(np.eye(names.max() + 1)[names].T if count else []), time]
    if count >= _CURVED:
        columns.append(time**2)
    if count < len(columns) + _FREE:
        return 0
    basis = np.linalg.svd(np.column_stack(columns), full_matrices=False)[0]
    left = places - basis @ (basis.T @ places)
    before = np.sum(left**2, axis=0)
    steps = (np.arange(count)[:, None] >= np.arange(1, count)).astype(float)  # (d, d - 1)
    own = steps - basis @ (basis.T @ steps)
    size = np.sum(own**2, axis=0)
    seen = size > _OWN * np.sum(steps**2, axis=0)
    if not seen.any() or np.any(before <= 0.0):
        return 0
    taken = np.where(seen[:, None], (own.T @ left) ** 2 / np.where(seen, size, 1.0)[:, None], 0.0)
    free = count - len(columns) - 1.5
    statistic = -free * np.sum(np.log(np.maximum(1.0 - taken / before, 1e-12)), axis=1)
    best = int(np.argmax(statistic))
    return best + 1 if chi2_sf(statistic[best], 3) * (count - 1) < _CHANCE else 0
