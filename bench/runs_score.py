"""Score what bags alone tell of a changed cell: `python bench/runs_score.py --sets 200`.

Series of runs with none, one or two hidden changes are written as bags by a world that shares no code with the
diagnosis (test/support/run_series), with the load of the spindle, and questioned by `diagnose --runs`; read is only
diagnosis.json.
"""

from __future__ import annotations

import argparse
import contextlib
import resource
import sys
import tempfile
from collections import Counter
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT), str(ROOT / "test")]

from support.run_answers import RunAnswer, drawn_answer  # noqa: E402

FIRST = 1000


def one(seed: int) -> RunAnswer:
    """Draw, write and question a series."""
    with tempfile.TemporaryDirectory() as folder, contextlib.redirect_stdout(None):
        return drawn_answer(seed, Path(folder), spindle=True)


def main() -> int:
    """Print every series that went wrong, and what was right by kind of change."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--sets", type=int, default=40, help="series")
    parser.add_argument("--first", type=int, default=FIRST, help="seed of the first")
    parser.add_argument("--workers", type=int, default=1, help="processes")
    chosen = parser.parse_args()
    hidden, right, begun, wrong, loud, quiet = Counter(), Counter(), Counter(), 0, 0, 0
    with ProcessPoolExecutor(chosen.workers) as pool:
        for answer in pool.map(one, range(chosen.first, chosen.first + chosen.sets)):
            missed = answer.missed
            for change in answer.series.changes:
                hidden[change.kind] += 1
                right[change.kind] += change not in missed
                if not change.drift and change not in missed:
                    begun[any(answer.begins(entry, change) for entry in answer.steps())] += 1
            wrong += len(answer.wrong)
            quiet += not answer.series.changes
            loud += not answer.series.changes and not answer.is_quiet
            for line in [*answer.wrong, *(f"seed {answer.seed}: missed {change}" for change in missed)]:
                print(line, flush=True)
    print()
    for kind in sorted(hidden):
        print(f"{kind:20} {right[kind]:4} of {hidden[kind]:4}")
    used = sum(sum(resource.getrusage(who)[:2]) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    print(f"{chosen.sets} series: {right.total()} of {hidden.total()} changes named")
    print(f"steps found within a run or inside their interval: {begun[True]} of {begun.total()}")
    print(f"wrong names: {wrong}; quiet series called changed: {loud} of {quiet}")
    print(f"{used / chosen.sets:.1f} s a series")
    return 0 if not wrong and not loud and right.total() >= 0.9 * hidden.total() else 1


if __name__ == "__main__":
    sys.exit(main())
