"""A run that has ended, as the page keeps it."""

from __future__ import annotations

from dataclasses import dataclass, replace

from doormill_ros.cell.errors import OutOfToleranceError
from doormill_ros.cell.output.inspection import MILLED, NOT_MEASURED, OUT_OF_TOLERANCE, MeasuredDoor, outcome

_CAME_TO = {MILLED: "milled", NOT_MEASURED: "not_measured", OUT_OF_TOLERANCE: "out_of_tolerance"}


@dataclass(frozen=True)
class EndedRun:
    """How a run ended; `ended` in seconds since the epoch, `message` the reason of a refusal.

    `measured`: the milled door was measured; without, nobody knows how it came out. `in_cell`: that was in the cell, so
    that no gauge counts. `gauged`: when a gauge measured it [s since the epoch]; 0: none did, or none told.
    """

    run_id: str
    door_id: str
    success: bool
    error_code: int
    message: str
    ended: float
    measured: bool = False
    in_cell: bool = False
    gauged: float = 0.0

    @property
    def outcome(self) -> str:
        """What it came to in two or three words."""
        return outcome(self.success, self.error_code, self.measured)

    def found(self, inspection: MeasuredDoor, at: float = 0.0, in_cell: bool = False) -> EndedRun:
        """The same run once its door was measured; one that was not milled stays as it is.

        Args:
            inspection: What was found.
            at: When a gauge measured [s since the epoch]: what was measured before tells nothing of it any more.
            in_cell: It was measured in the cell, which counts before every gauge.
        """
        milled = self.success or self.error_code == OutOfToleranceError.code
        earlier = not in_cell and (self.in_cell or at < self.gauged)
        if not milled or earlier or not inspection.measured:
            return self
        return replace(
            self,
            success=not inspection.out_of_tolerance,
            error_code=OutOfToleranceError.code if inspection.out_of_tolerance else 0,
            message=inspection.told_of(self.door_id, self._how()),
            measured=True,
            in_cell=in_cell,
            gauged=0.0 if in_cell else at,
        )

    def _how(self) -> str:
        """How it was milled, of a run that was; what is out of tolerance no longer says so."""
        how = self.message.removeprefix(f"door {self.door_id} milled: ")
        if not self.measured:
            return how.removesuffix(f"; {MeasuredDoor().sentence}")
        return (how.rpartition("; ")[0] if self.success else "") or "measured anew"

    @property
    def came_to(self) -> str:
        """The same as a key of the page's texts, behind "outcome."."""
        return _CAME_TO.get(self.outcome, "refused")
