"""What an accepted model is worth in each world: `python bench/loop_worlds.py`.

Nine doors of a shift are gauged and questioned; doors in no bag of that shift are planned without and with the model,
and milled by the world. Beside it what the loop leaves in the world that is as assumed: all that planner, program and
springs leave where nothing is wrong; and what a plan leaves that is told the world's own figures.
"""

from __future__ import annotations

import logging
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "test"))

from doormill_ros.pipeline.plan import load_setup
from doormill_ros.units import m_to_um
from support.loop_worlds import AS_ASSUMED, MORE, UNSEEN, WORLDS, milled, taught

TIMES = 1.5  #: what is left as assumed that may be left after the loop


def main() -> None:
    """Print a line for each world and door."""
    logging.disable(logging.WARNING)
    unaware = load_setup()
    least: dict[str, float] = {}
    print(
        "world                     door                walls before, after [um rms]  at most        of as assumed"
        "  told  of told"
    )
    for label, world in (WORLDS | MORE).items():
        with tempfile.TemporaryDirectory(prefix="loop-") as folder:
            loop = taught(Path(folder), world)
            aware = load_setup(model=str(loop.model))
            for name, program, offset in UNSEEN:
                before, after = (
                    milled(setup, loop.world, name, program, offset) for setup in (unaware, aware)
                )
                if label == AS_ASSUMED:
                    least[name] = after[0]
                told = milled(unaware, loop.world, name, program, offset, aware=True)
                ratio = after[0] / least[name]
                missed = ["beyond 1.5"] * (ratio > TIMES) + ["worse"] * (after[0] > before[0])
                rms, most = ([m_to_um(end[i]) for end in (before, after)] for i in (0, 1))
                print(
                    f"{label:25s} {name:18s} {rms[0]:6.0f} {rms[1]:6.0f} {most[0]:18.0f} {most[1]:6.0f} "
                    f"{ratio:12.2f} {m_to_um(told[0]):9.0f} {after[0] / told[0]:8.2f}  {', '.join(missed)}".rstrip(),
                    flush=True,
                )


if __name__ == "__main__":
    main()
