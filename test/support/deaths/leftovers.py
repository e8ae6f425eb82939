"""Judges at the controller's folder: whether a target file stands there longer than its run.

A result may be told a moment before the folder is cleared, and a goal that names a dead node is refused within
milliseconds. So a file that stands when the next result comes, of a run whose result was told before that goal was
sent, is looked at again until it is gone or the patience is over; no other goal is sent meanwhile.
"""

from __future__ import annotations

import time
from pathlib import Path

TARGET_FILE = "Hei2.txt"
PATIENCE = 20.0  # s, of a machine with more to do than it can
LOOK = 0.01  # s


class Leftovers:
    """Knows which runs have ended.

    Args:
        home: The controller's folder.
        patience: How long a file of an ended run may stand while nothing else is asked of the cell [s].

    Attributes:
        found: What stood there too long, a line each.
    """

    def __init__(self, home: Path, patience: float = PATIENCE) -> None:
        self._file = home / TARGET_FILE
        self._patience = patience
        self._ended: set[str] = set()
        self._ended_before: set[str] = set()
        self.found: list[str] = []

    def sent(self) -> None:
        """A goal is sent."""
        self._ended_before = set(self._ended)

    def told(self, run_id: str) -> None:
        """Its result came, of a run if it got as far as one."""
        deadline = time.monotonic() + self._patience
        while (run := self._standing()) in self._ended_before and time.monotonic() < deadline:
            time.sleep(LOOK)
        if run in self._ended_before:
            self.found.append(f"the file of run {run} stands there after the goal that followed it")
        if run_id:
            self._ended.add(run_id)

    def _standing(self) -> str:
        """Run of the file that stands there; empty for none."""
        try:
            lines = self._file.read_text(encoding="ascii", errors="replace").splitlines()
        except OSError:
            return ""
        return next((line.partition(" ")[2] for line in lines if line.startswith("#run ")), "")
