"""The fixture of these tests that stands in `support`, where several folders find it."""

from support.rapid_bench import door  # noqa: F401
