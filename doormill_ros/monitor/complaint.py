"""Which runs a complaint of the diagnosis is about."""

from __future__ import annotations

import re
from collections.abc import Sequence


def complained_of(runs: Sequence[str], failure: str) -> list[str]:
    """Those of some runs whose folder, or a file in it, a sentence names; each was laid out under its run id."""
    return [run_id for run_id in runs if re.search(rf"/{re.escape(run_id)}(?=[/:,;\s]|$)", failure)]
