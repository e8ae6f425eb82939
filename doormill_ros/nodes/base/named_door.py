"""How a request names a door: by its id or by its bar code."""

from __future__ import annotations

from typing import Any

from doormill_ros.abb.link_errors import DoorNameError


def check_named_once(request: Any) -> None:
    """Refuse a request with both names of a door, which may be of two doors, or with none.

    Args:
        request: With the fields `door_id` and `bar_code`.

    Raises:
        DoorNameError: Not exactly one of them is given.
    """
    if bool(request.door_id) == bool(request.bar_code):
        raise DoorNameError(
            f"door_id is {request.door_id!r} and bar_code {request.bar_code!r}; exactly one of them is wanted"
        )
