"""Since when the camera is not where it was."""

from __future__ import annotations

import time

from doormill_ros.localization.marks.drift import Drift

IN_PLACE = 0.5  # share of the limit up to which the camera is taken to stand


class MarkWatch:
    """Remembers when the marks last said that the camera stands."""

    def __init__(self) -> None:
        self._stood: float | None = None

    def told(self, drift: Drift, stamp: float) -> str:
        """What has happened and since when, of a picture of that time [s since the epoch]; empty while it stands."""
        if drift.share <= IN_PLACE:
            self._stood = stamp
            return ""
        if self._stood is None:
            return f"{drift.sentence} since it was calibrated"
        return f"{drift.sentence} since {time.strftime('%H:%M', time.localtime(self._stood))}"
