"""Score the diagnosis of shifts of which no two doors are alike: `python bench/random_shift_score.py --sets 50`.

Hidden effects are those of bench/shift_score; hinges, size and place of every door are drawn
(test/support/random_shift). Two more such doors are planned with the model that the shift leaves, milled and compared
as there.
"""

from __future__ import annotations

import argparse
import logging
import multiprocessing
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT), str(ROOT / "test")]

from loop_words import print_loops, print_sum, walls_of  # noqa: E402

from doormill_ros.diagnosis.parts.kind import Inspections  # noqa: E402
from support.random_shift import next_doors, random_doors, random_shift  # noqa: E402
from support.shift_loop import LoopWorth, knowing, loop_worth  # noqa: E402
from support.shift_worlds import DrawnShift, Judged, draw_shift, judged  # noqa: E402

LONGEST = 40  # doors
SHARE = 0.9  # of the hidden causes that has to be right, and of loops that may leave no more than they should
GAP = "joint_backlash"  #: loops of shifts that have one are counted by themselves, as in bench/shift_score


@dataclass(frozen=True)
class ScoredShift:
    """A shift, what was said of it and what that was worth."""

    seed: int
    drawn: DrawnShift
    found: Judged
    loop: LoopWorth
    seconds: float


def scored(seed: int) -> ScoredShift:
    """Draw, plan, mill, gauge and question a shift, and mill the doors after it."""
    logging.disable(logging.WARNING)
    drawn, begin = draw_shift(seed, longest=LONGEST), time.monotonic()
    with tempfile.TemporaryDirectory(prefix="shift-") as folder:
        shift, count = Path(folder), len(drawn.doors)
        doors = random_shift(shift, drawn.world, random_doors(seed, count), seed)
        diagnosis = Inspections().diagnose(doors, lambda line: None)
        loop = loop_worth(shift, diagnosis, count, seed, knowing(), doors=next_doors(seed))
    return ScoredShift(seed, drawn, judged(diagnosis, drawn.hidden), loop, time.monotonic() - begin)


def main() -> int:
    """Compare; 1 when too few causes are right or one is wrong, or when the loop leaves too much."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--sets", type=int, default=50)
    parser.add_argument("--first", type=int, default=100, help="seed of the first shift")
    parser.add_argument("--workers", type=int, default=1, help="processes that share the shifts")
    arguments = parser.parse_args()
    hidden = right = steps = near = wrong = listed = longest = 0
    with_gap: list[LoopWorth] = []
    others: list[LoopWorth] = []
    with multiprocessing.get_context("spawn").Pool(arguments.workers) as pool:
        for shift in pool.imap(scored, range(arguments.first, arguments.first + arguments.sets)):
            drawn, found = shift.drawn, shift.found
            (with_gap if any(one.cause == GAP for one in drawn.hidden) else others).append(shift.loop)
            begun = [one for one in drawn.hidden if one.from_door > 0]
            hidden, right = hidden + len(drawn.hidden), right + len(drawn.hidden) - len(found.missed)
            steps, wrong = steps + len(begun), wrong + len(found.wrong)
            listed, longest = listed + len(found.listed), max(longest, found.longest)
            near += sum(one not in (*found.missed, *found.late) for one in begun)
            told = ", ".join(f"{one.cause} {one.where} from {one.from_door}" for one in drawn.hidden)
            print(
                f"{shift.seed}: {len(drawn.doors)} doors, hidden {told or 'nothing'}; {found.verdict}: "
                f"{', '.join(found.named)}; missed {[one.cause for one in found.missed]}, wrong {list(found.wrong)}, "
                f"far off {[one.cause for one in found.late]}; {walls_of(shift.loop)}; {shift.seconds:.0f} s",
                flush=True,
            )
    print()
    print(
        f"{arguments.sets} shifts: {right} of {hidden} hidden causes right, {near} of {steps} of their steps "
        f"within three doors; {wrong} wrong names; {listed} of the causes only listed as confusable with the one "
        f"named, {longest} in the longest list"
    )
    print_loops("shifts with a gap", with_gap)
    print_loops("all other shifts", others)
    kept, worse = print_sum([*with_gap, *others])
    good = right >= SHARE * hidden and kept >= SHARE * arguments.sets
    return 0 if good and not wrong and not worse else 1


if __name__ == "__main__":
    sys.exit(main())
