"""How far a milled door may be from its recipe."""

from __future__ import annotations

TOLERANCE = 0.5e-3  #: section 1.3 of the thesis [m]
