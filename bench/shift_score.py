"""Score the diagnosis of inspected doors on seeded shifts: `python bench/shift_score.py --sets 200`.

The worlds execute recorded commands and gauge the doors; they share no code with the diagnosis. A hidden cause is right
when it is named, or listed as confusable with what is. It is owed where it moves the points of the doors that have it
by twice the gauge's noise, root mean square; what is smaller is counted by itself.
"""

from __future__ import annotations

import argparse
import logging
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "test"))

from support.shift_worlds import NEAR, OWED, diagnosed, draw_shift, judged, sizes

RIGHT = 0.9  #: share of hidden causes that have to be right


def main() -> int:
    """Diagnose and compare; 1 when too few causes are right or one is wrong."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--sets", type=int, default=5)
    parser.add_argument("--first", type=int, default=0, help="seed of the first shift")
    parser.add_argument("--minutes", type=float, default=1e9, help="after which no further shift is begun")
    arguments = parser.parse_args()
    logging.disable(logging.WARNING)
    start = time.monotonic()
    verdicts: Counter[str] = Counter()
    by_cause: dict[str, Counter[str]] = {}
    weak: Counter[str] = Counter()
    wrong = 0
    for seed in range(arguments.first, arguments.first + arguments.sets):
        if time.monotonic() - start > 60.0 * arguments.minutes:
            break
        drawn, begin = draw_shift(seed), time.monotonic()
        with tempfile.TemporaryDirectory(prefix="shift-") as folder:
            shift = Path(folder) / "shift"
            found = judged(diagnosed(shift, drawn, seed), drawn.hidden)
            moved = sizes(shift, drawn, seed)
        verdicts[found.verdict] += 1
        wrong += len(found.wrong)
        for one, size in zip(drawn.hidden, moved, strict=True):
            count = by_cause.setdefault(one.cause, Counter()) if size >= OWED else weak
            count["hidden"] += 1
            count["right"] += one not in found.missed
            count["steps"] += one.from_door > 0
            count["near"] += one.from_door > 0 and one not in (*found.missed, *found.late)
        hidden = [
            f"{one.cause} {one.where} from {one.from_door} ({size:.1f} noise)"
            for one, size in zip(drawn.hidden, moved, strict=True)
        ]
        print(
            f"{seed}: {len(drawn.doors)} doors, hidden {', '.join(hidden) or 'nothing'}; "
            f"{found.verdict}: {', '.join(found.named)}; missed {[one.cause for one in found.missed]}, "
            f"wrong {list(found.wrong)}, far off {[one.cause for one in found.late]}; "
            f"{time.monotonic() - begin:.0f} s",
            flush=True,
        )
    print()
    for cause, row in sorted(by_cause.items()):
        print(f"{cause:28s} {row['right']} of {row['hidden']}, {row['near']} of {row['steps']} steps near")
    total = sum(by_cause.values(), Counter())
    print(
        f"{verdicts.total()} shifts: {total['right']} of {total['hidden']} hidden causes of {OWED:g} times the noise "
        f"right, {total['near']} of {total['steps']} of their steps within {NEAR} doors; {weak['right']} of "
        f"{weak['hidden']} smaller ones right; {wrong} wrong names; "
        + ", ".join(
            f"{verdicts[word]} {word}"
            for word in ("explained", "partly_explained", "unexplained", "consistent")
        )
    )
    return int(wrong > 0 or total["right"] < RIGHT * total["hidden"])


if __name__ == "__main__":
    sys.exit(main())
