"""Bags that today's software must still reproduce: they lie in a folder of the site, which every backup holds."""

from __future__ import annotations

import os
import re
import secrets
import shutil
from pathlib import Path

from doormill_ros.recording.bag_folders import bags_in, is_bag
from doormill_ros.recording.errors import AcceptedBagError
from doormill_ros.resources import ACCEPTED, site_folder


def accepted_bags() -> list[Path]:
    """Every accepted bag of this site, in the order of their names.

    Raises:
        AcceptedBagError: There is none.
    """
    folder = site_folder() / ACCEPTED
    found = [bag for bag in bags_in([folder]) if is_bag(bag)]
    if not found:
        raise AcceptedBagError(f"no bag lies in {folder}; name one, or accept one with replay --accept BAG")
    return found


def accept_bag(bag: Path, run_id: str) -> Path:
    """Copy a bag to the accepted ones of this site, at once: nobody finds half of it there.

    Args:
        bag: Its folder.
        run_id: Of its first run, which names the copy.

    Returns:
        The copy's folder.

    Raises:
        AcceptedBagError: It is accepted already, or cannot be copied.
    """
    # A run id comes from a bag, and may be anything.
    copy = site_folder() / ACCEPTED / (re.sub(r"[^A-Za-z0-9_-]", "_", run_id) or "run")
    if copy.exists():
        raise AcceptedBagError(f"{copy} is accepted already; remove it to accept {bag} in its place")
    beside = copy.with_name(f".{copy.name}.{secrets.token_hex(6)}.part")
    try:
        shutil.copytree(bag, beside)
        os.replace(beside, copy)
    except (OSError, shutil.Error) as error:
        raise AcceptedBagError(
            f"{bag} cannot be copied to {copy}: {error}; free the disk, or let its folder be written"
        ) from error
    finally:
        shutil.rmtree(beside, ignore_errors=True)
    return copy
