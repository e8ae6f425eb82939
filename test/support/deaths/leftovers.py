"""Judges at the controller's folder: whether a target file stands there longer than its run.

A result may be told a moment before the folder is cleared. By the next result there was a whole goal's time for it: a
file that stands then must not be of a run whose result was told before that goal was sent.
"""

from __future__ import annotations

from pathlib import Path

TARGET_FILE = "Hei2.txt"


class Leftovers:
    """Knows which runs have ended.

    Args:
        home: The controller's folder.

    Attributes:
        found: What stood there too long, a line each.
    """

    def __init__(self, home: Path) -> None:
        self._file = home / TARGET_FILE
        self._ended: set[str] = set()
        self._ended_before: set[str] = set()
        self.found: list[str] = []

    def sent(self) -> None:
        """A goal is sent."""
        self._ended_before = set(self._ended)

    def told(self, run_id: str) -> None:
        """Its result came, of a run if it got as far as one."""
        run = self._standing()
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
