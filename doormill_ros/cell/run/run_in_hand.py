"""A note of the run in hand on disk: whoever finds one after a restart knows which run was cut off."""

from __future__ import annotations

import json
from pathlib import Path

from doormill_ros.cell.errors import RunNoteError
from doormill_ros.files import write_atomically

NOTE = "run-in-hand.json"


class RunNote:
    """The note in one folder.

    Args:
        folder: Where it lies; made when it is missing.
    """

    def __init__(self, folder: Path) -> None:
        self._path = folder / NOTE

    def write(self, run_id: str, door_id: str) -> None:
        """A run begins.

        Raises:
            RunNoteError: The note cannot be written.
        """
        try:
            self._path.parent.mkdir(parents=True, exist_ok=True)
            write_atomically(self._path, json.dumps({"run_id": run_id, "door_id": door_id}) + "\n")
        except OSError as error:
            raise RunNoteError(
                f"{self._path} cannot be written ({error.strerror or error}); without it a restarted bridge would not "
                "know which door was in hand, so none is begun: check folder, rights and disk, or choose another "
                "with the parameter archive of /abb_bridge, note of /door_shares",
                path=str(self._path),
            ) from error

    def clear(self) -> None:
        """The run has ended, and everybody was told.

        Raises:
            OSError: The note cannot be removed.
        """
        self._path.unlink(missing_ok=True)

    def read(self) -> tuple[str, str] | None:
        """Run and door of a run that was cut off; None where there is none or nobody can read of it."""
        try:
            document = json.loads(self._path.read_text(encoding="utf-8"))
            return str(document["run_id"]), str(document["door_id"])
        except (OSError, ValueError, KeyError, TypeError):
            return None
