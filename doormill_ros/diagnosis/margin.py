"""One decision of a diagnosis, and how far it was from going the other way."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any


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
