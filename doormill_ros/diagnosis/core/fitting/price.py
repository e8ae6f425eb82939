"""What a fitted number has to pay for itself: more of them always fit better."""

from __future__ import annotations

import math

#: That a number pays already where rows are left out, on average: it errs on them as much as it gains on its own.
LEFT_OUT = 2.0
LEAST = 1.0  #: that a number costs with ever so few rows


def price_of_number(rows: int) -> float:
    """Price of a number that is scored on rows left out: the logarithm of their count (BIC) less what it pays there.

    Args:
        rows: Components of all rows.
    """
    return max(math.log(rows) - LEFT_OUT, LEAST)
