"""The localizer with and without a picture of the empty clamp: `python bench/bench_empty_clamp.py [COUNT [SEED]]`.

One row a kind of picture (support/pictures/empty_clamps.py): how many were accepted and how many of those were wrong,
without that picture and with it. Wrong is any pose where no door stands, else as in wrong_pose.py. Exit code 1
when a pose is wrong that is accepted with the picture, or a good picture is refused because of it.
"""

from __future__ import annotations

import sys
import time
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
from wrong_pose import distance, is_wrong

from doormill_ros.cell.places.layout import load_layout
from doormill_ros.localization.errors import LocalizationError
from doormill_ros.localization.localizer import localize, prepare
from doormill_ros.simulation.picture.picture import render_picture
from doormill_ros.units import m_to_mm
from support.pictures.empty_clamps import CLAMPS, ClampPicture, clamp_pictures

COUNT, SEED = 60, 2027
HEAD = [
    "picture",
    "pictures",
    "accepted",
    "wrong",
    "accepted with",
    "wrong with",
    "worst, mm",
    "right ones lost",
]


@dataclass
class Row:
    """What became of the pictures of one kind; the first of each pair without a picture of the empty clamp."""

    count: int = 0
    accepted: list[int] = field(default_factory=lambda: [0, 0])
    wrong: list[int] = field(default_factory=lambda: [0, 0])
    lost: int = 0
    worst: float = 0.0
    times: list[float] = field(default_factory=list)

    def cells(self) -> list[str]:
        """What stands below `HEAD`, less the name."""
        pairs = zip(self.accepted, self.wrong, strict=True)
        worst = f"{m_to_mm(self.worst):.3f}" if self.worst else ""
        return [str(self.count), *(str(v) for pair in pairs for v in pair), worst, str(self.lost)]


def look(item: ClampPicture, row: Row) -> None:
    """Localize one picture both ways and enter it."""
    scene, layout = item.scene, load_layout()
    known, picture = item.camera(), render_picture(item.scene, item.seed)
    row.count += 1
    poses, right = [], False
    cameras = replace(known, empty=()), known
    for i, camera in enumerate(cameras):
        prepare(camera, layout, scene.width, scene.thickness)
        try:
            found = localize(picture, camera, layout, scene.width, scene.thickness)
        except LocalizationError:
            row.lost += i and right
            return
        poses.append((found.offset, found.covariance.tolist()))
        wrong = not item.stands or is_wrong(found, scene.offset)
        right = not wrong
        row.accepted[i] += 1
        row.wrong[i] += wrong
        if wrong and i and item.stands:
            row.worst = max(row.worst, distance(found, scene.offset))
    assert poses[0] == poses[1], "the picture of the empty clamp has changed a pose"
    spent = []
    for camera in cameras:  # now that both are warm
        start = time.process_time()
        for _ in range(3):
            localize(picture, camera, layout, scene.width, scene.thickness)
        spent.append((time.process_time() - start) / 3)
    row.times.append(spent[1] - spent[0])


def run(count: int = COUNT, seed: int = SEED) -> dict[str, Row]:
    """The table by kind."""
    cv2.setNumThreads(1)
    rows = {name: Row() for name in CLAMPS}
    for name, row in rows.items():
        for item in clamp_pictures(name, count, seed):
            look(item, row)
    return rows


def main() -> int:
    """Print the table."""
    rows = run(*(int(v) for v in sys.argv[1:3]))
    table = Table(*HEAD)
    for name, row in rows.items():
        table.add_row(name, *row.cells())
    Console(width=150).print(table)
    good = [row for name, row in rows.items() if CLAMPS[name].fair]
    everything = list(rows.values())
    print(
        f"wrong without {sum(row.wrong[0] for row in everything)}, "
        f"with {sum(row.wrong[1] for row in everything)} of {sum(row.count for row in everything)} pictures"
    )
    print(
        f"good pictures: {sum(row.accepted[0] - row.wrong[0] for row in good)} right without, "
        f"{sum(row.accepted[1] - row.wrong[1] for row in good)} with, of {sum(row.count for row in good)}"
    )
    times = [1e3 * spent for row in everything for spent in row.times]
    print(f"{float(np.median(times)):.2f} ms more a picture in the median")
    return 1 if any(row.wrong[1] or row.lost for row in everything) else 0


if __name__ == "__main__":
    sys.exit(main())
