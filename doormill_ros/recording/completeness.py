"""Whether the files of a bag hold what its metadata.yaml says of them."""

from __future__ import annotations

from pathlib import Path

from doormill_ros.recording.bag_reader import bag_files
from doormill_ros.recording.errors import IncompleteBagError
from doormill_ros.recording.information import information_of
from doormill_ros.recording.mcap_index import messages_held
from doormill_ros.recording.mcap_scan import is_complete
from doormill_ros.recording.mcap_sums import check_sums


def check_whole(bag: Path) -> None:
    """Refuse a bag that lost messages since it was recorded: copied in half, damaged, or a file of it left behind.

    What a killed recorder left has no metadata.yaml, or one of its begin, and passes.

    Args:
        bag: Its folder, or a file of one, of which nothing says how much it held.

    Raises:
        IncompleteBagError: Its files hold fewer messages than it lists.
        UnreadableBagError: metadata.yaml cannot be read, or a file is damaged.
        OSError: A file cannot be read.
    """
    files = bag_files(bag) if bag.is_dir() else []
    count = information_of(bag).get("message_count") if files else 0
    listed = count if isinstance(count, int) else 0
    held = sum(messages_held(path) for path in files)
    if held < listed:
        raise IncompleteBagError(
            f"bag {bag} holds {held} of the {listed} messages that its metadata.yaml lists and is not used; "
            "copy it again from where it was recorded",
            bag=str(bag),
            held=held,
            listed=listed,
        )
    for path in files:
        if is_complete(path):
            check_sums(path)
