"""Score the diagnosis of inspected doors on seeded shifts: `python bench/shift_score.py --sets 200`.

The worlds execute recorded commands and gauge the doors; they share no code with the diagnosis. A hidden cause is right
when it is named, or listed as confusable with what is.
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

from support.shift_worlds import diagnosed, draw_shift, judged

RIGHT = 0.9  #: share of hidden causes that have to be right


def main() -> int:
    """Diagnose and compare; 1 when too few causes are right or one is wrong."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--sets", type=int, default=5)
    parser.add_argument("--first", type=int, default=0, help="seed of the first shift")
    arguments = parser.parse_args()
    logging.disable(logging.WARNING)
    total: Counter[str] = Counter()
    by_cause: dict[str, Counter[str]] = {}
    for seed in range(arguments.first, arguments.first + arguments.sets):
        drawn, begin = draw_shift(seed), time.monotonic()
        with tempfile.TemporaryDirectory(prefix="shift-") as folder:
            found = judged(diagnosed(Path(folder), drawn, seed), drawn.hidden)
        total["hidden"] += len(drawn.hidden)
        total["right"] += len(drawn.hidden) - len(found.missed)
        total["wrong"] += len(found.wrong)
        total["steps"] += sum(one.from_door > 0 and one not in found.missed for one in drawn.hidden)
        total["late"] += len(found.late)
        total[found.verdict] += 1
        for one in drawn.hidden:
            row = by_cause.setdefault(one.cause, Counter())
            row["hidden"] += 1
            row["right"] += one not in found.missed
        hidden = ", ".join(f"{o.cause} {o.where} from {o.from_door}" for o in drawn.hidden) or "nothing"
        print(
            f"{seed}: {len(drawn.doors)} doors, hidden {hidden}; {found.verdict}: {', '.join(found.named)}; "
            f"missed {len(found.missed)}, wrong {list(found.wrong)}, far off {len(found.late)}; "
            f"{time.monotonic() - begin:.0f} s",
            flush=True,
        )
    print()
    for cause, row in sorted(by_cause.items()):
        print(f"{cause:28s} {row['right']} of {row['hidden']}")
    print(
        f"shifts: {total['right']} of {total['hidden']} hidden causes right, {total['wrong']} wrong names, "
        f"{total['steps'] - total['late']} of {total['steps']} steps within 3 doors; "
        + ", ".join(
            f"{total[word]} {word}" for word in ("explained", "partly_explained", "unexplained", "consistent")
        )
    )
    return int(total["wrong"] > 0 or total["right"] < RIGHT * total["hidden"])


if __name__ == "__main__":
    sys.exit(main())
