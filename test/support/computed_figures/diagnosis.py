"""What docs/diagnosis.md prints of the example that lies beside it."""

from __future__ import annotations

import csv

from support.page_figures import number_of
from support.source_tree import ROOT

with (ROOT / "docs" / "diagnosis_example" / "trials.csv").open(encoding="utf-8", newline="") as _file:
    _ROWS = list(csv.DictReader(_file))

TRIALS = len(_ROWS)
POSTURES = len({tuple(row[f"q{k}"] for k in range(1, 7)) for row in _ROWS})


def noise() -> float:
    """Standard deviation of one recorded displacement [m]."""
    return number_of(r"docs/diagnosis_example/set.yaml#displacement: ([\d.]+e-\d+)")
