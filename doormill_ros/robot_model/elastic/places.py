"""Where a robot may give way."""

from __future__ import annotations

JOINTS = tuple(f"joint {k}" for k in range(1, 7))
LINKS = tuple(f"link {k}" for k in range(1, 7))
