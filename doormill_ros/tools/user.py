"""Who sits at the terminal."""

from __future__ import annotations

import getpass


def user_name() -> str:
    """Name of the user, for what is stored with an author."""
    try:
        return getpass.getuser()
    except (KeyError, OSError):  # a user id without a name, as in some containers
        return "unknown"
