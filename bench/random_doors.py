"""Any door of the cell: is what is planned for it free of touches, and what is refused?

Not one of `make bench`: run `python bench/random_doors.py --doors 500 --robots 1 2 --search` by itself. Planner and
target file are taken as they come; the file's motions run on the simulated controller and are judged. With --search,
refusals are looked into by other means: whether there is a posture for the refused feature, and a way to it, and
whether the judge knows of a board behind a hole.
"""

from __future__ import annotations

import argparse
import sys
from collections import Counter
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent), str(HERE.parent / "test")]

from support.judged_doors import CONFIRMED, judge_doors, search  # noqa: E402


def run(robots: int, options: argparse.Namespace) -> bool:
    """Print a table of one robot or of two; True when nothing was touched and every refusal looked into is right."""
    outcomes, looked, open_ = [], Counter[str](), 0
    for number, outcome in enumerate(judge_doors(options.doors, options.seed, options.tools, robots)):
        outcomes.append(outcome)
        print(f"{robots}: {number}", end="\r", file=sys.stderr, flush=True)
        if outcome.verdict is not None and outcome.verdict.error is not None:
            print(f"{number}: {outcome.verdict.sentence}", flush=True)
        if options.search and outcome.refusal is not None:
            found = search(outcome)
            looked[f"{type(outcome.refusal).__name__}: {found}"] += 1
            if found not in CONFIRMED:
                open_ += 1
                print(
                    f"{number} ({outcome.robot} robot): refused, search: {found}: {outcome.refusal.message}",
                    flush=True,
                )
    refused = [o.refusal for o in outcomes if o.refusal is not None]
    judged = [o for o in outcomes if o.verdict is not None]
    touching = [o.verdict for o in judged if o.verdict is not None and o.verdict.error is not None]
    print(f"\nrobots                    {robots:6d}")
    print(f"doors                     {options.doors:6d}")
    print(f"programs asked for        {len(outcomes):6d}")
    print(f"accepted                  {len(judged):6d}")
    print(f"  without a touch         {len(judged) - len(touching):6d}")
    print(f"  touching                {len(touching):6d}")
    pairs = Counter(
        pair
        for verdict in touching
        for pair in {(t.body, t.obstacle) for t in verdict.touches}
        | ({("mill", "wood")} if verdict.gone else set())
    )
    for (body, obstacle), times in pairs.most_common():
        print(f"    {body} and {obstacle}".ljust(40) + f"{times:6d}")
    print(f"refused                   {len(refused):6d}")
    for (code, name), times in Counter((r.code, type(r).__name__) for r in refused).most_common():
        print(f"    {code} {name}".ljust(40) + f"{times:6d}")
    for found, times in looked.most_common():
        print(f"    {found}".ljust(70) + f"{times:6d}")
    if options.search:
        print(f"refused, not confirmed    {open_:6d}")
    for what in ("planning", "judging"):
        times_ = sorted(getattr(o, what) for o in judged)
        if times_:
            print(f"{what}: median {times_[len(times_) // 2]:.2f} s, longest {times_[-1]:.2f} s")
    return not touching and not open_


def main() -> int:
    """Print a table for each number of robots; 1 when a program touched anything or a refusal is not confirmed."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--doors", type=int, default=50, metavar="N", help="how many; default: 50")
    parser.add_argument("--seed", type=int, default=0, help="of the doors")
    parser.add_argument(
        "--tools",
        type=float,
        default=9.0,
        help="most tools of a program; default: 9, so that it refuses no door",
    )
    parser.add_argument(
        "--robots", type=int, choices=(1, 2), nargs="+", default=[1], help="2: a share of the door to each"
    )
    parser.add_argument("--search", action="store_true", help="look for postures and ways of what is refused")
    options = parser.parse_args()
    free = [run(robots, options) for robots in options.robots]
    return 0 if all(free) else 1


if __name__ == "__main__":
    sys.exit(main())
