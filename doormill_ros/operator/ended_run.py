"""A run that has ended, as the page keeps it."""

from __future__ import annotations

from dataclasses import dataclass, replace

from doormill_ros.cell.errors import OutOfToleranceError
from doormill_ros.cell.inspection import MILLED, NOT_MEASURED, OUT_OF_TOLERANCE, MeasuredDoor, outcome

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

    def found(self, inspection: MeasuredDoor) -> EndedRun:
        """The same run once its door was measured; one that was measured before, or was not milled, stays as it is."""
        if not self.success or self.measured or not inspection.measured:
            return self
        how = self.message.removeprefix(f"door {self.door_id} milled: ")
        return replace(
            self,
            success=not inspection.out_of_tolerance,
            error_code=OutOfToleranceError.code if inspection.out_of_tolerance else 0,
            message=inspection.told_of(self.door_id, how.removesuffix(f"; {MeasuredDoor().sentence}")),
            measured=True,
        )

    @property
    def came_to(self) -> str:
        """The same as a key of the page's texts, behind "outcome."."""
        return _CAME_TO.get(self.outcome, "refused")
