"""How uncertain a line along a wandering edge is, against many edges that are drawn."""

from __future__ import annotations

import numpy as np
import pytest

from doormill_ros.localization.lines.wander import EdgePieces

MM = 1e-3
LENGTHS = (80.0 * MM, 130.0 * MM)  # that show of a hinge edge and of a bottom edge
DRAWS = 600


def beyond(length: float, over: float, times: float = 2.0) -> int:
    """Of `DRAWS` lines along an edge that wanders, how many are further off than so many times what they state."""
    along = np.linspace(0.0, length, 400)
    lever = along - along.mean()
    together = np.exp(-(((along[:, None] - along) / over) ** 2)) + 1e-8 * np.eye(along.size)
    draw, root = np.random.default_rng(7), np.linalg.cholesky(together)
    found = 0
    for _ in range(DRAWS):
        across = 40e-6 * (root @ draw.standard_normal(along.size)) + 3e-6 * draw.standard_normal(along.size)
        slope = lever @ across / (lever @ lever)
        stated = EdgePieces(along, np.ones(along.size)).variance(across - across.mean() - slope * lever)
        found += int(across.mean() ** 2 > times**2 * stated / along.size)
    return found


@pytest.mark.parametrize("over", [(2.0 * MM,), (10.0 * MM, 15.0 * MM)], ids=["sawn", "waves"])
def test_lines_are_as_uncertain_as_they_state(over: tuple[float, ...]) -> None:
    found = sum(beyond(length, one) for length in LENGTHS for one in over)
    assert found / (DRAWS * len(LENGTHS) * len(over)) < 0.07  # 0.046 of normal ones


@pytest.mark.parametrize("length", LENGTHS)
def test_waves_that_look_like_another_line_seldom_leave_one_far_beyond_what_it_states(length: float) -> None:
    # By the pieces alone 86 and 24 of these 1200.
    assert sum(beyond(length, over, 5.0) for over in (20.0 * MM, 30.0 * MM)) < 20
