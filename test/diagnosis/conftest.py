"""Fixtures of these tests; they stand in `support`, where several folders find them."""

from support.effect_sets import dh, make_set, score  # noqa: F401
