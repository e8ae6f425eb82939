"""Fixtures of these tests; they stand in `support`, where several folders find them."""

from support.effect_sets import dh, make_set, score  # noqa: F401
from support.plain_robot import configurations, irb6600, link_pose  # noqa: F401
