"""Fixtures of these tests; they stand in `support`, where several folders find them."""

from support.door_cutting import cutting  # noqa: F401
from support.rapid_bench import (  # noqa: F401
    answer,
    arm,
    controller,
    door,
    load,
    machine,
    read_configuration,
    say,
    thesis_listings,
    thesis_module,
)
