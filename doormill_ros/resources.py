"""Find the files that ship with the package, in the source tree or in an install tree, and those of the site."""

from __future__ import annotations

import os
from pathlib import Path

PACKAGE = "doormill_ros"
SITE = "DOORMILL_SITE"  #: environment variable that names the site's folder
#: Folders of a site: files that go before the shipped, store of models, bags to be reproduced, who ordered what.
CONFIG, MODELS, ACCEPTED, AUDIT = "config", "models", "accepted", "audit"


def site_folder() -> Path:
    """What this site has of its own: recipes, models, accepted bags, audit log, and files of config/.

    $DOORMILL_SITE, or a folder among the user's data. It need not exist.
    """
    if os.environ.get(SITE):
        return Path(os.environ[SITE]).expanduser()
    data = os.environ.get("XDG_DATA_HOME") or str(Path.home() / ".local" / "share")
    return Path(data) / PACKAGE


def cache_folder() -> Path:
    """What this user's processes keep to be quicker and can make again. It need not exist.

    Raises:
        RuntimeError: The user has no home.
    """
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / PACKAGE


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
    """Path of a shipped file or folder, for example `resource("config/cell.yaml")`.

    A file of that name in the site's folder goes before it, so that an update leaves calibrations alone.

    Raises:
        FileNotFoundError: The file does not ship.
    """
    own = site_folder() / relative
    if own.is_file():
        return own
    path = share_directory() / relative
    if not path.exists():
        raise FileNotFoundError(f"{relative} does not ship with {PACKAGE} (looked at {path})")
    return path
