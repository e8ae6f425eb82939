"""The localizer under conditions that it was not made for: `python bench/bench_conditions.py [COUNT [SEED]]`.

One row a condition: pictures, how many were accepted, how many of those were wrong, by how much at most, and why the
others were refused. Wrong is a pose more than 0.1 mm, 0.1 degrees or 5 of its own standard deviations off. Exit code
1 when one is, or when a condition whose edges are plain to a person has so few pictures accepted as nine in ten would
leave by chance in one of twenty runs only. support/pictures/unseen.py says of which conditions either is known.
"""

from __future__ import annotations

import sys
import time
from collections import Counter
from dataclasses import dataclass, field
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
from scipy.stats import binom
from wrong_pose import distance, is_wrong

from doormill_ros.cell.places.layout import load_layout
from doormill_ros.localization.camera import load_camera
from doormill_ros.localization.errors import LocalizationError
from doormill_ros.localization.localizer import localize, prepare
from doormill_ros.simulation.picture.picture import render_picture
from doormill_ros.units import m_to_mm
from support.pictures.beams_beside import compare
from support.pictures.conditions import CONDITIONS, ConditionPicture, pictures
from support.pictures.marked_cell import marked_cameras
from support.pictures.unseen import DOUBTFUL, UNSEEN

COUNT, SEED = 100, 7
FAIR_SHARE, CHANCE = 0.9, 0.05


@dataclass
class Row:
    """What became of the pictures of one condition."""

    fair: bool = True
    count: int = 0
    wrong: int = 0
    worst: float = 0.0
    reasons: Counter[str] = field(default_factory=Counter)
    times: list[float] = field(default_factory=list)

    @property
    def accepted(self) -> int:
        """Pictures with a pose."""
        return self.count - self.reasons.total()

    @property
    def refusing(self) -> bool:
        """True when too many good pictures were refused."""
        return self.fair and float(binom.cdf(self.accepted, self.count, FAIR_SHARE)) < CHANCE


def look(item: ConditionPicture, row: Row) -> None:
    """Localize one picture and enter it."""
    camera = marked_cameras()[1] if item.marked else load_camera()
    layout, scene = load_layout(), item.scene
    picture = render_picture(scene, item.seed)
    prepare(camera, layout, scene.width, item.thickness)
    row.count += 1
    start = time.process_time()
    try:
        try:
            found = localize(picture, camera, layout, scene.width, item.thickness, settings=item.settings)
        finally:
            row.times.append(time.process_time() - start)
        if item.beams:
            compare(item, found)
    except LocalizationError as reason:
        row.reasons[type(reason).__name__] += 1
        return
    row.worst = max(row.worst, distance(found, scene.offset))
    row.wrong += is_wrong(found, scene.offset)


def run(count: int = COUNT, seed: int = SEED) -> dict[str, Row]:
    """The table by condition."""
    cv2.setNumThreads(1)
    rows = {name: Row(condition.fair) for name, condition in CONDITIONS.items()}
    for name, row in rows.items():
        for item in pictures(name, count, seed):
            look(item, row)
    return rows


def main() -> int:
    """Print the table."""
    rows = run(*(int(v) for v in sys.argv[1:3]))
    table = Table(
        "condition", "pictures", "accepted", "wrong", "worst, mm", "ms", "refused", title="Conditions"
    )
    for name, row in rows.items():
        why = ", ".join(f"{reason} {n}" for reason, n in row.reasons.most_common())
        spent = f"{1e3 * float(np.median(row.times)):.1f}, {1e3 * max(row.times):.0f}"
        wrong = f"[bold]{row.wrong}[/]" if row.wrong else "0"
        worst = f"{m_to_mm(row.worst):.3f}" if row.accepted else ""
        table.add_row(name, str(row.count), str(row.accepted), wrong, worst, spent, why)
    Console(width=200).print(table)
    wrong = {name for name, row in rows.items() if row.wrong}
    refusing = {name for name, row in rows.items() if row.refusing}
    for what, found, known in (("wrong poses", wrong, UNSEEN), ("refusing", refusing, DOUBTFUL | UNSEEN)):
        print(
            f"{what}: {', '.join(sorted(found - known)) or 'none'}; known: {', '.join(sorted(found & known)) or 'none'}"
        )
    seen = [row for name, row in rows.items() if name not in UNSEEN]
    fair = [row for row in seen if row.fair]
    plain, taken = sum(row.count for row in fair), sum(row.accepted for row in fair)
    print(f"{taken} of {plain} pictures with plain edges accepted, {100 * taken / plain:.1f} %")
    everything = list(rows.values())
    for what, some in (
        ("that can be seen", seen),
        ("that cannot be seen", [row for row in everything if row not in seen]),
    ):
        print(
            f"conditions {what}: {sum(row.wrong for row in some)} wrong "
            f"of {sum(row.accepted for row in some)} accepted, {sum(row.count for row in some)} pictures"
        )
    times = [1e3 * spent for row in everything for spent in row.times]
    print(f"{float(np.median(times)):.1f} ms a picture in the median, {max(times):.0f} ms at most")
    return 1 if wrong or refusing else 0


if __name__ == "__main__":
    sys.exit(main())
