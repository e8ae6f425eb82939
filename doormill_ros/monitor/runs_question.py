"""What bags of runs are asked: whether the cell is still as it was, without a gauge."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from doormill_ros.monitor.question import DiagnosisQuestion


@dataclass(frozen=True)
class RunsQuestion(DiagnosisQuestion):
    """The last runs below a folder.

    Attributes:
        folder: Anywhere below it bags are.
        count: How many runs, the last ones.
        since: The first that counts; empty: all do.
        bags: Names of the bags that were written to last, below the folder, and their sizes [bytes].
    """

    kept = "runs_answer"

    folder: Path
    count: int
    since: str
    bags: tuple[tuple[str, int], ...]

    @property
    def asked(self) -> dict[str, Any]:
        """Which bags as they were, and which runs of them."""
        return {"count": self.count, "since": self.since, "bags": [[name, size] for name, size in self.bags]}

    @staticmethod
    def is_asked(asked: Any) -> bool:
        """A count, a run and a list."""
        count, since, bags = asked["count"], asked["since"], asked["bags"]
        return isinstance(count, int) and isinstance(since, str) and isinstance(bags, list)

    def lay_out(self, folder: Path) -> Sequence[str]:
        """Nothing: the diagnosis chooses among the bags where they lie."""
        since = ["--since", self.since] if self.since else []
        return ["--runs", str(self.folder.resolve()), "--last", str(self.count), *since]
