"""What docs/laws.md prints of the price of a choice."""

from __future__ import annotations

import math

from doormill_ros.robot_model.elastic.law.dictionary import WAVES


def price_of_waves() -> float:
    """What the best of so many numbers of waves gains in the score by chance."""
    return 2.0 * math.log(WAVES)
