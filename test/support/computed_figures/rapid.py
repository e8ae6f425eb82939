"""What docs/rapid.md prints: where a RAPID number has no fourth decimal any more, and which numbers RAISE takes."""

from __future__ import annotations

import numpy as np

from doormill_ros.abb.target_file.line import DECIMALS, _decimals_of
from doormill_ros.simulation.controller.rapid.handlers import OWN_RAISES

FIRST_RAISE, LAST_RAISE = min(OWN_RAISES), max(OWN_RAISES)


def last_with_four_decimals() -> float:
    """Power of two [mm] below which coordinates are written with all their decimals."""
    most = DECIMALS[0][0]
    limits = 2.0 ** np.arange(5, 13)
    return float(limits[_decimals_of(limits - 0.123, most) == most].max())
