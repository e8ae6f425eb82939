"""Whether the files of a bag hold what its metadata.yaml says of them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from doormill_ros.config import read_document
from doormill_ros.recording.bag_reader import bag_files
from doormill_ros.recording.errors import IncompleteBagError, UnreadableBagError
from doormill_ros.recording.mcap_index import messages_held
from doormill_ros.recording.metadata import INFORMATION, METADATA


def check_whole(bag: Path) -> None:
    """Refuse a bag that lost messages since it was recorded: copied in half, or a file of it left behind.

    What a killed recorder left has no metadata.yaml, or one of its begin, and passes.

    Args:
        bag: Its folder, or a file of one, of which nothing says how much it held.

    Raises:
        IncompleteBagError: Its files hold fewer messages than it lists.
        UnreadableBagError: metadata.yaml cannot be read.
        OSError: A file cannot be read.
    """
    files = bag_files(bag) if bag.is_dir() else []
    count = _information(bag).get("message_count") if files else 0
    listed = count if isinstance(count, int) else 0
    held = sum(messages_held(path) for path in files)
    if held < listed:
        raise IncompleteBagError(
            f"bag {bag} holds {held} of the {listed} messages that its metadata.yaml lists and is not compared; "
            "copy it again from where it was recorded",
            bag=str(bag),
            held=held,
            listed=listed,
        )


def _information(folder: Path) -> dict[str, Any]:
    """What metadata.yaml says of a bag, by whomever it was written; nothing where it is missing.

    Raises:
        UnreadableBagError: It cannot be read.
    """
    path = folder / METADATA
    if not path.is_file():
        return {}
    document = read_document(path, UnreadableBagError, "take another copy of the bag")
    information = document.get(INFORMATION) if isinstance(document, dict) else None
    return information if isinstance(information, dict) else {}
