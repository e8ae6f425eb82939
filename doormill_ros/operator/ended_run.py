"""A run that has ended, as the page keeps it."""

from __future__ import annotations

from dataclasses import dataclass

from doormill_ros.cell.inspection import MILLED, NOT_MEASURED, OUT_OF_TOLERANCE, outcome

_CAME_TO = {MILLED: "milled", NOT_MEASURED: "not_measured", OUT_OF_TOLERANCE: "out_of_tolerance"}


@dataclass(frozen=True)
class EndedRun:
    """How a run ended; `ended` in seconds since the epoch, `message` the reason of a refusal.

    `measured`: the milled door was measured; without, nobody knows how it came out.
    """

    run_id: str
    door_id: str
    success: bool
    error_code: int
    message: str
    ended: float
    measured: bool = False

    @property
    def outcome(self) -> str:
        """What it came to in two or three words."""
        return outcome(self.success, self.error_code, self.measured)

    @property
    def came_to(self) -> str:
        """The same as a key of the page's texts, behind "outcome."."""
        return _CAME_TO.get(self.outcome, "refused")
