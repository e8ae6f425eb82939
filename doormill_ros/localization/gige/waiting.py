"""How long a run has waited for its picture, and why there is none."""

from __future__ import annotations

SILENT = "the camera does not answer; check its cable, power and address"


class Waiting:
    """Of one run after the other. One thread asks, another one tells what became of the pictures.

    Attributes:
        reason: Why the latest picture did not come; as long as none comes it may have been wanted for a run before.
    """

    def __init__(self) -> None:
        self._run_id = self._taken = ""
        self._since = 0.0
        self.reason = SILENT

    def of(self, run_id: str, now: float) -> float:
        """How long that run has waited until `now` [s]; nothing where its picture was taken, or there is no run."""
        if run_id != self._run_id:
            self._run_id, self._since = run_id, now
        return 0.0 if run_id in ("", self._taken) else now - self._since

    def failed(self, reason: str) -> None:
        """A picture was asked for in vain."""
        self.reason = reason

    def taken(self, run_id: str) -> None:
        """That run's picture was sent."""
        self._taken, self.reason = run_id, SILENT
