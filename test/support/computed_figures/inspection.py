"""What docs/inspection.md prints besides the table of worlds."""

from __future__ import annotations

import re

from support.page_figures import RESULTS


def worse_with_the_thesis_program() -> float:
    """Walls of the thesis' program after a smaller force was learned, less those before [um]."""
    text = (RESULTS / "loop_worlds.txt").read_text(encoding="utf-8")
    ((before, after),) = re.findall(r"\nforce 30 % smaller\s+thesis_1350_2deg\s+(\d+)\s+(\d+)", text)
    return float(after) - float(before)
