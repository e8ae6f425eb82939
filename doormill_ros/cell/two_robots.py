"""What the two robots are called that share a door."""

from __future__ import annotations

FIRST, SECOND = "first", "second"
