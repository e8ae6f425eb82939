"""Texts as long as the page shows them."""

from __future__ import annotations

LONGEST_TEXT = 2000  # characters


def short(text: str) -> str:
    """A text that is cut where it is longer than the page shows."""
    return text if len(text) <= LONGEST_TEXT else text[: LONGEST_TEXT - 1] + "…"
