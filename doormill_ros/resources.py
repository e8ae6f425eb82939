"""Find the files that ship with the package: in the source tree or in an install tree."""

from __future__ import annotations

import os
from pathlib import Path

PACKAGE = "doormill_ros"


def share_directory() -> Path:
    """The folder that holds config/, rapid/, launch/ and bags/.

    The source tree wins when the package is imported from it, so that a developer sees the
    file just edited; otherwise the ament index of an installed package is asked.

    Raises:
        FileNotFoundError: Neither exists.
    """
    source = Path(__file__).resolve().parent.parent
    if (source / "package.xml").is_file():
        return source
    for prefix in os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep):
        share = Path(prefix) / "share" / PACKAGE
        if prefix and (share / "package.xml").is_file():
            return share
    raise FileNotFoundError(
        f"the share folder of {PACKAGE} is neither beside the package nor in AMENT_PREFIX_PATH; "
        "source the workspace's setup file, or '. ./activate' in the project"
    )


def resource(relative: str) -> Path:
    """Path of a shipped file, for example `resource("config/cell.yaml")`.

    Raises:
        FileNotFoundError: The file does not ship.
    """
    path = share_directory() / relative
    if not path.exists():
        raise FileNotFoundError(f"{relative} does not ship with {PACKAGE} (looked at {path})")
    return path
