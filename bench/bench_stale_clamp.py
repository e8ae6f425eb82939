"""Whether a picture of the empty clamp is known to be stale: `python bench/bench_stale_clamp.py [COUNT [SEED]]`.

One row a kind of what happened since it was taken (support/pictures/stale_clamps.py): how many pictures of doors call
it stale, as moved, as changed or as lit otherwise, in how many too little background shows to tell where it is, by how
much it is said to lie elsewhere in the others, and what became of the poses: right ones and wrong ones without that
picture and with it. Exit code 1 when a fresh one is called stale, a right pose is lost, or there are more wrong ones
with it than without.
"""

from __future__ import annotations

import sys
import time
from collections import Counter
from dataclasses import dataclass, field, replace
from pathlib import Path

import one_core  # noqa: F401  before numpy

# isort: split
import cv2
import numpy as np

ROOT = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT), str(ROOT / "bench"), str(ROOT / "test")]

# ruff: noqa: E402
from rich.console import Console
from rich.table import Table
from wrong_pose import is_wrong

from doormill_ros.cell.places.layout import load_layout
from doormill_ros.localization.empty_clamp.stale_clamp import fit_clamp
from doormill_ros.localization.errors import LocalizationError
from doormill_ros.localization.localizer import localize
from doormill_ros.localization.view import face_view
from doormill_ros.simulation.picture.picture import render_picture
from support.pictures.empty_clamps import ClampPicture
from support.pictures.stale_clamps import SINCE, stale_pictures

COUNT, SEED = 20, 2029
REASONS = ("moved", "changed", "relit")
HEAD = ("since then", "pictures", "stale", *REASONS, "open", "median, px", "right", "with", "wrong", "with")


@dataclass
class StaleRow:
    """What became of the pictures of one kind; the first of each pair without a picture of the empty clamp."""

    count: int = 0
    stale: int = 0
    reasons: Counter[str] = field(default_factory=Counter)
    shifts: list[float] = field(default_factory=list)
    right: list[int] = field(default_factory=lambda: [0, 0])
    wrong: list[int] = field(default_factory=lambda: [0, 0])
    times: list[float] = field(default_factory=list)

    @property
    def open(self) -> int:
        """Pictures in which too little background shows to tell where it lies."""
        return self.count - len(self.shifts)

    def cells(self) -> list[str]:
        """What stands below `HEAD`, less the name."""
        shift = f"{float(np.median(self.shifts)):.2f}" if self.shifts else ""
        kinds = [self.count, self.stale, *(self.reasons[reason] for reason in REASONS), self.open]
        return [*(str(n) for n in kinds), shift, *(str(n) for n in (*self.right, *self.wrong))]


def look(item: ClampPicture, row: StaleRow) -> None:
    """Compare and localize one picture and enter it."""
    scene, layout = item.scene, load_layout()
    known, picture = item.camera(), render_picture(item.scene, item.seed)
    row.count += 1
    for i, camera in enumerate((replace(known, empty=()), known)):
        try:
            found = localize(picture, camera, layout, scene.width, scene.thickness)
        except LocalizationError:
            continue
        (row.wrong if not item.stands or is_wrong(found, scene.offset) else row.right)[i] += 1
    seen = face_view(known, layout, scene.width, scene.thickness)
    pose = np.array([scene.offset.y, scene.offset.z, scene.offset.rotation])
    fit_clamp(picture, known, known.empty[0], seen, pose)
    start = time.process_time()
    fit = fit_clamp(picture, known, known.empty[0], seen, pose)
    row.times.append(time.process_time() - start)
    if fit is None:
        return
    row.stale += fit.stale
    row.reasons.update(reason for reason in REASONS if getattr(fit, reason))
    if np.isfinite(fit.background.deviation):
        row.shifts.append(fit.background.moved)


def main() -> int:
    """Print the table."""
    count, seed, *_ = (*(int(v) for v in sys.argv[1:3]), *(COUNT, SEED)[len(sys.argv[1:3]) :])
    cv2.setNumThreads(1)
    rows = {name: StaleRow() for name in SINCE}
    for name, row in rows.items():
        for item in stale_pictures(name, count, seed):
            look(item, row)
    table = Table(*HEAD)
    for name, row in rows.items():
        table.add_row(name, *row.cells())
    Console(width=130).print(table)
    fresh = [row for name, row in rows.items() if not SINCE[name].stale]
    stale = [row for name, row in rows.items() if SINCE[name].stale]
    called = sum(row.stale for row in fresh)
    right, wrong = (
        np.sum([getattr(row, what) for row in rows.values()], axis=0).tolist() for what in ("right", "wrong")
    )
    print(f"fresh: {called} of {sum(row.count for row in fresh)} called stale")
    print(f"in {sum(row.open for row in stale)} of these too little background shows to tell where it lies")
    print(f"stale: {sum(row.stale for row in stale)} of {sum(row.count for row in stale)} noticed")
    print(
        f"right poses: {right[0]} without, {right[1]} with; wrong poses: {wrong[0]} without, {wrong[1]} with"
    )
    times = [1e3 * spent for row in rows.values() for spent in row.times]
    print(f"{float(np.median(times)):.2f} ms for the comparison in the median")
    return 1 if called or right[1] < right[0] or wrong[1] > wrong[0] else 0


if __name__ == "__main__":
    sys.exit(main())
