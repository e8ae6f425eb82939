"""Score the diagnosis of shifts of which no two doors are alike: `python bench/random_shift_score.py --sets 50`.

Hidden effects are those of bench/shift_score; hinges, size and place of every door are drawn
(test/support/random_shift).
"""

from __future__ import annotations

import argparse
import logging
import multiprocessing
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT), str(ROOT / "test")]

from doormill_ros.diagnosis.parts.kind import Inspections  # noqa: E402
from support.random_shift import random_doors, random_shift  # noqa: E402
from support.shift_worlds import DrawnShift, Judged, draw_shift, judged  # noqa: E402

LONGEST = 40  # doors
SHARE = 0.9  # of the hidden causes that has to be right


def scored(seed: int) -> tuple[int, DrawnShift, Judged, float]:
    """Draw, plan, mill, gauge and question a shift."""
    logging.disable(logging.WARNING)
    drawn, begin = draw_shift(seed, longest=LONGEST), time.monotonic()
    with tempfile.TemporaryDirectory(prefix="shift-") as folder:
        doors = random_shift(Path(folder), drawn.world, random_doors(seed, len(drawn.doors)), seed)
    found = judged(Inspections().diagnose(doors, lambda line: None), drawn.hidden)
    return seed, drawn, found, time.monotonic() - begin


def main() -> int:
    """Compare; 1 when too few causes are right or one is wrong."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--sets", type=int, default=50)
    parser.add_argument("--first", type=int, default=100, help="seed of the first shift")
    parser.add_argument("--workers", type=int, default=1, help="processes that share the shifts")
    arguments = parser.parse_args()
    hidden = right = steps = near = wrong = 0
    with multiprocessing.get_context("spawn").Pool(arguments.workers) as pool:
        for seed, drawn, found, seconds in pool.imap(
            scored, range(arguments.first, arguments.first + arguments.sets)
        ):
            begun = [one for one in drawn.hidden if one.from_door > 0]
            hidden, right = hidden + len(drawn.hidden), right + len(drawn.hidden) - len(found.missed)
            steps, wrong = steps + len(begun), wrong + len(found.wrong)
            near += sum(one not in (*found.missed, *found.late) for one in begun)
            told = ", ".join(f"{one.cause} {one.where} from {one.from_door}" for one in drawn.hidden)
            print(
                f"{seed}: {len(drawn.doors)} doors, hidden {told or 'nothing'}; {found.verdict}: "
                f"{', '.join(found.named)}; missed {[one.cause for one in found.missed]}, wrong {list(found.wrong)}, "
                f"far off {[one.cause for one in found.late]}; {seconds:.0f} s",
                flush=True,
            )
    print()
    print(
        f"{arguments.sets} shifts: {right} of {hidden} hidden causes right, {near} of {steps} of their steps "
        f"within three doors; {wrong} wrong names"
    )
    return 0 if right >= SHARE * hidden and not wrong else 1


if __name__ == "__main__":
    sys.exit(main())
