"""Fixtures of these tests; they stand in `support`, where several folders find them."""

from support.loading_sets import kinematics, make_set, robot  # noqa: F401
