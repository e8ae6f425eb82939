"""What metadata.yaml says of a bag, read; `metadata.py` writes it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from doormill_ros.config import read_document
from doormill_ros.recording.errors import UnreadableBagError
from doormill_ros.recording.metadata import INFORMATION, METADATA


def information_of(folder: Path) -> dict[str, Any]:
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
