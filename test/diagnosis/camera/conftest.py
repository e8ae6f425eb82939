"""Fixtures of these tests; they stand in `support`, where several folders find them."""

from support.pictures.moved_door import photographed  # noqa: F401
