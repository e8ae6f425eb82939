"""Fixtures of these tests; they stand in `support`, where several folders find them."""

from support.seen_pictures import camera, layout, looked  # noqa: F401
