"""The loop from doors to doors: `python bench/closed_loop.py --world FILE --doors 40 --accept 30 --out DIR`.

Mills a shift in the simulated cell, diagnoses its first doors, accepts the model that is found, mills the other doors
with it, and prints how doors of the same recipes came out before and after. No fit has seen the doors after; nor are
the doors before that are compared the ones that were corrected.
"""

from __future__ import annotations

import argparse
import itertools
import json
import logging
import shutil
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from doormill_ros.cell.run_folder import ShiftFolder
from doormill_ros.diagnosis.core.kind import run
from doormill_ros.diagnosis.parts.kind import Inspections
from doormill_ros.measurements.inspection import inspections_in, read_inspection
from doormill_ros.nodes.cell import CellOptions
from doormill_ros.nodes.shift import run_shift
from doormill_ros.robot_model.model_file import MODEL_FILE
from doormill_ros.units import m_to_um


def main() -> int:
    """Mill, diagnose, accept, mill, compare; 0 when no recipe came out worse than before."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--world", type=Path, required=True)
    parser.add_argument("--door", action="append", default=[], metavar="ID")
    parser.add_argument("--doors", type=int, default=40)
    parser.add_argument("--accept", type=int, default=30, help="doors after which the model is accepted")
    parser.add_argument("--out", type=Path, required=True)
    arguments = parser.parse_args()
    logging.disable(logging.WARNING)
    kinds = arguments.door or ["thesis_190_0deg", "thesis_1350_0deg"]
    doors = list(itertools.islice(itertools.cycle(kinds), arguments.doors))
    shift, before, after = (arguments.out / name for name in ("shift", "before", "after"))
    found = arguments.out / "diagnosis"

    def gather(numbers: range, folder: Path) -> None:
        shutil.rmtree(folder, ignore_errors=True)
        for number in numbers:
            source = ShiftFolder(shift.resolve()).run(number)
            if source.inspection.is_dir():
                (folder / source.root.name).mkdir(parents=True)
                for part in (source.inspection, source.bag):
                    (folder / source.root.name / part.name).symlink_to(part)

    def accepted(number: int) -> Path | None:
        if number < arguments.accept:
            return None
        if number == arguments.accept:
            gather(range(number), before)
            print(run(Inspections(), [before], [], found), flush=True)
        return (found / MODEL_FILE).resolve()

    run_shift(doors, shift, CellOptions({}), arguments.world, milled=_told, model=accepted)
    gather(range(arguments.accept, arguments.doors), after)
    print(run(Inspections(), [before], [after], arguments.out / "report"))
    document = json.loads((arguments.out / "report" / "diagnosis.json").read_text(encoding="utf-8"))
    for change in document["changes"]:
        print(
            f"{change['what']} at {change['where']}: {change['kind']} from {change['from_door']}, 95 %",
            end=" ",
        )
        print(" to ".join(change["from_door_ci95"]))
    worse = False
    late = [door.name for door in inspections_in(before)][
        arguments.accept - (arguments.doors - arguments.accept) :
    ]
    for kind in kinds:
        rows = []
        for folder, names in ((before, late), (after, [door.name for door in inspections_in(after)])):
            same = [name for name in names if doors[int(name.rsplit("_", 1)[1])] == kind]
            if not same:
                rows.append((np.inf, np.inf, 0))
                continue
            off = np.concatenate([read_inspection(folder / name / "inspection").deviation for name in same])
            rows.append((float(np.sqrt(np.mean(off**2))), float(np.abs(off).max()), len(same)))
        (rms, most, count), (rms_after, most_after, count_after) = rows
        worse |= rms_after > rms
        if not count or not count_after:
            print(f"{kind}: {count} doors before, {count_after} after; the others were refused")
            continue
        print(
            f"{kind}: {count} doors before {m_to_um(rms):.0f} um rms, {m_to_um(most):.0f} at most; "
            f"{count_after} after {m_to_um(rms_after):.0f} um rms, {m_to_um(most_after):.0f} at most"
        )
    return int(worse)


def _told(number: int, summary: object) -> None:
    print(f"door {number}: {getattr(summary, 'message', '')}", file=sys.stderr, flush=True)


if __name__ == "__main__":
    sys.exit(main())
