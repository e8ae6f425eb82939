"""A node in error, as the page shows it."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Fault:
    """What a node in error says of itself; `error_code` 0: it gave none."""

    message: str
    error_code: int = 0
