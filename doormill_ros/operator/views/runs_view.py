"""What the page shows of the bags of runs alone."""

from __future__ import annotations

from dataclasses import asdict, dataclass, replace
from typing import Any

from doormill_ros.monitor.cell_change import CellChange
from doormill_ros.operator.views.short_text import short


@dataclass(frozen=True)
class RunsView:
    """The monitor's last word on them: in English, and as the data of which the page makes it in other languages.

    Attributes:
        sentence: The verdict; empty before the first, and where nobody asks.
        verdict: consistent, explained, partly_explained, unexplained or few; empty before the first.
        changes: What changed.
        questioned: Runs that it rests on.
        next_measurement: What to measure next; empty where nothing changed.
        left_aside: Bags of which not all was asked, and why.
        asking: A newer verdict is being worked out.
        error_code, message: What is wrong with the asking; 0 and empty when nothing is.
    """

    sentence: str = ""
    verdict: str = ""
    changes: tuple[CellChange, ...] = ()
    questioned: int = 0
    next_measurement: str = ""
    left_aside: tuple[str, ...] = ()
    asking: bool = False
    error_code: int = 0
    message: str = ""

    def shortened(self) -> RunsView:
        """With texts as long as the page shows them."""
        return replace(
            self,
            sentence=short(self.sentence),
            next_measurement=short(self.next_measurement),
            message=short(self.message),
            left_aside=tuple(map(short, self.left_aside)),
        )

    def document(self) -> dict[str, Any]:
        """JSON-able content."""
        changes = [
            {**asdict(change), "said_sizes": [asdict(size) for size in change.said_sizes]}
            for change in self.changes
        ]
        return {**asdict(self), "changes": changes}
