"""Names of the forms of what a run and a shift leave; without numpy, for who only looks."""

from __future__ import annotations

RUN = "doormill/run/1"  #: summary.json
SHIFT = "doormill/shift/1"  #: shift.json
