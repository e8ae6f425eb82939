"""Score the diagnosis of inspected doors on seeded shifts: `python bench/shift_score.py --sets 200`.

The worlds execute recorded commands and gauge the doors; they share no code with the diagnosis. A hidden cause is right
when it is named, or listed as confusable with what is. It is owed where it moves the points of the doors that have it
by twice the gauge's noise, root mean square; what is smaller is counted by itself.

Then the loop is closed: the model that the doors leave plans the next ones, which no fit has seen. Their walls are
compared, as gauged, with what is left where everything is as assumed, with what the springs alone would have left, and
with what a plan leaves that is told the world's own figures: less no model could. A shift that warms up has its next
doors at once, in the warmth that it has by then, and once more after a night, in the cold.
"""

from __future__ import annotations

import argparse
import logging
import multiprocessing
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "test"))


from loop_words import print_loops, print_sum, walls_of

from support.shift_loop import LoopWorth, knowing, loop_worth
from support.shift_worlds import NEAR, OWED, DrawnShift, Judged, diagnosed, draw_shift, judged, sizes

#: Share of hidden causes that have to be right, and of loops that may leave no more than they should
RIGHT = 0.9
GAP, WARM, REST = "shifts with a gap", "shifts that warm up", "all other shifts"
MORNING = "the morning after shifts that warm up"
#: Shifts that are counted by themselves: where a gap closes the mill steps aside, and what is warm changes by the door.
APART = {GAP: "joint_backlash", WARM: "thermal_growth"}


@dataclass(frozen=True)
class ScoredShift:
    """A shift, what was said of it and what that was worth; `loops` by what is counted by itself."""

    seed: int
    drawn: DrawnShift
    found: Judged
    moved: tuple[float, ...]
    loops: dict[str, LoopWorth]
    seconds: float


def scored(seed: int) -> ScoredShift:
    """Draw, mill, gauge and question a shift, and mill the doors after it."""
    logging.disable(logging.WARNING)  # in each process
    drawn, begin = draw_shift(seed), time.monotonic()
    with tempfile.TemporaryDirectory(prefix="shift-") as folder:
        shift = Path(folder) / "shift"
        diagnosis = diagnosed(shift, drawn, seed)
        found = judged(diagnosis, drawn.hidden)
        moved = sizes(shift, drawn, seed)
        causes = {one.cause for one in drawn.hidden}
        label = next((label for label, cause in APART.items() if cause in causes), REST)
        loops = {label: loop_worth(shift, diagnosis, len(drawn.doors), seed, knowing())}
        if APART[WARM] in causes:
            loops[MORNING] = loop_worth(shift, diagnosis, len(drawn.doors), seed, knowing(), morning=True)
    return ScoredShift(seed, drawn, found, moved, loops, time.monotonic() - begin)


def _scored_by(workers: int, seeds: Sequence[int]) -> Iterator[ScoredShift]:
    """In the order of the seeds, by that many processes."""
    if workers == 1:
        yield from map(scored, seeds)
        return
    with multiprocessing.get_context("spawn").Pool(workers) as pool:
        yield from pool.imap(scored, seeds)


def main() -> int:
    """Diagnose and compare; 1 when too few causes are right or one is wrong, or when the loop leaves too much."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--sets", type=int, default=5)
    parser.add_argument("--first", type=int, default=0, help="seed of the first shift")
    parser.add_argument("--minutes", type=float, default=1e9, help="after which no further shift is begun")
    parser.add_argument("--workers", type=int, default=1, help="processes that share the shifts")
    arguments = parser.parse_args()
    logging.disable(logging.WARNING)
    start = time.monotonic()
    verdicts: Counter[str] = Counter()
    by_cause: dict[str, Counter[str]] = {}
    weak: Counter[str] = Counter()
    loops: dict[str, list[LoopWorth]] = {GAP: [], WARM: [], MORNING: [], REST: []}
    wrong = 0
    seeds = range(arguments.first, arguments.first + arguments.sets)
    for shift in _scored_by(arguments.workers, seeds):
        seed, drawn, found, moved, found_loops = (
            shift.seed,
            shift.drawn,
            shift.found,
            shift.moved,
            shift.loops,
        )
        for label, loop in found_loops.items():
            loops[label].append(loop)
        verdicts[found.verdict] += 1
        wrong += len(found.wrong)
        for one, size in zip(drawn.hidden, moved, strict=True):
            count = by_cause.setdefault(one.cause, Counter()) if size >= OWED else weak
            count["hidden"] += 1
            count["right"] += one not in found.missed
            count["listed"] += one in found.listed
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
            f"{', in the morning '.join(walls_of(loop) for loop in found_loops.values())}; "
            f"{shift.seconds:.0f} s",
            flush=True,
        )
        if time.monotonic() - start > 60.0 * arguments.minutes:
            break
    print()
    for cause, row in sorted(by_cause.items()):
        print(
            f"{cause:28s} {row['right']} of {row['hidden']}, {row['near']} of {row['steps']} steps near, "
            f"{row['listed']} only listed as confusable"
        )
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
    for label, some in loops.items():
        print_loops(label, some)
    every = [loop for some in loops.values() for loop in some]
    kept, worse = print_sum(every)
    return int(wrong + worse > 0 or total["right"] < RIGHT * total["hidden"] or kept < RIGHT * len(every))


if __name__ == "__main__":
    sys.exit(main())
