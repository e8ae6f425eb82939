"""One decision of a diagnosis, and how far it was from going the other way."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

from doormill_ros.pages.page import Table


@dataclass(frozen=True)
class Margin:
    """What a decision was taken by.

    Attributes:
        decision: What was asked.
        value: What was found.
        threshold: At which the answer changes.
        quantity: "score" (squared standard deviations), "probability", "share" (of an effect) or "standard errors".
    """

    decision: str
    value: float
    threshold: float
    quantity: str

    def document(self) -> dict[str, Any]:
        """As it stands in diagnosis.json."""
        return asdict(self)


@dataclass(frozen=True)
class Check:
    """One thing that a model or one of its members has to stand, and what came of it.

    Attributes:
        fails: Whether it does not stand it.
        against: What is said of a member then.
        margins: What that was decided by.
    """

    fails: bool
    against: str = ""
    margins: tuple[Margin, ...] = ()


def margins_table(entries: Sequence[Margin]) -> Table:
    """The margins as a table of a page."""
    rows = [
        [
            one.decision.replace("_", " "),
            _plain(one.value),
            _plain(one.threshold),
            one.quantity,
        ]
        for one in entries
    ]
    return Table(("Decision", "Found", "The answer changes at", "Measured as"), rows)


def _plain(value: float) -> str:
    return f"{value:.0f}" if abs(value) >= 100.0 else f"{value:.3g}"
