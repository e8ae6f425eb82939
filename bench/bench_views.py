"""Doors in a second, independent world of pictures: `python bench/bench_views.py [COUNT [SEED [FEATURE ...]]]`.

Draws COUNT random views of a workshop, localizes each and prints what was accepted and what was wrong by what was in
the view; features that are named go into every view instead of random ones. Exit code 1 when a view in which a person
plainly sees both edges gave a wrong pose.
"""

from __future__ import annotations

import sys
import time
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import one_core  # noqa: F401  before numpy

# isort: split
import cv2

ROOT = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT), str(ROOT / "bench"), str(ROOT / "test")]

# ruff: noqa: E402
from wrong_pose import WRONG_ANGLE, WRONG_PLACE, WRONG_SIGMA, distance, error, is_wrong, sigma

from doormill_ros.cell.places.layout import load_layout
from doormill_ros.localization.camera import load_camera
from doormill_ros.localization.errors import LocalizationError
from doormill_ros.localization.localizer import localize, prepare
from doormill_ros.localization.result import Localization
from doormill_ros.units import DEG, m_to_mm, rad_to_deg
from support.views.plainness import is_plain
from support.views.render import render
from support.views.series import view_of
from support.views.view import View


@dataclass(frozen=True)
class Outcome:
    """What became of one view.

    Attributes:
        view: What was seen.
        plain: Whether a person plainly sees both edges.
        found: The pose; None where it was refused.
        refusal: Type of the refusal; empty for a pose.
    """

    view: View
    plain: bool
    found: Localization | None
    refusal: str = ""

    @property
    def distance(self) -> float:
        """Off in place [m]."""
        return 0.0 if self.found is None else distance(self.found, self.view.offset)

    @property
    def wrong(self) -> bool:
        """Whether the pose must not be milled."""
        return self.found is not None and is_wrong(self.found, self.view.offset)

    def __str__(self) -> str:
        """How far the pose is off."""
        assert self.found is not None
        y, z, rotation = error(self.found, self.view.offset)
        return (
            f"{m_to_mm(self.distance):.3f} mm (y {m_to_mm(y):+.3f}, z {m_to_mm(z):+.3f}), "
            f"{rad_to_deg(rotation):+.3f} deg, {sigma(self.found, self.view.offset):.1f} sigma"
        )


def outcomes(count: int, seed: int, features: tuple[str, ...] | None) -> Iterator[Outcome]:
    """Localize the first views of a series."""
    camera, layout = load_camera(), load_layout()
    prepared: set[tuple[float, float]] = set()
    for number in range(count):
        view = view_of(number, seed, features)
        picture, plain = render(view), is_plain(view)
        width, told = view.place.width, view.told_thickness
        if (width, told) not in prepared:
            prepare(camera, layout, width, told)
            prepared.add((width, told))
        try:
            found = localize(picture, camera, layout, width, told)
        except LocalizationError as refusal:
            yield Outcome(view, plain, None, type(refusal).__name__)
            continue
        yield Outcome(view, plain, found)


def row(name: str, those: list[Outcome]) -> str:
    """One line of the table."""
    accepted = [it for it in those if not it.refusal]
    worst = max((it.distance for it in accepted), default=0.0)
    refusals = Counter(it.refusal for it in those if it.refusal)
    why = ", ".join(f"{reason} {times}" for reason, times in refusals.most_common())
    plain = [it for it in those if it.plain]
    counts = (
        len(those),
        len(plain),
        len(accepted),
        sum(not it.refusal for it in plain),
        sum(it.wrong for it in those),
    )
    numbers = "".join(f"{value:9d}" for value in counts)
    return f"{name:20s}{numbers}{m_to_mm(worst):9.3f}  {why}"


def main() -> int:
    """Draw, localize, judge."""
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 300
    seed = int(sys.argv[2]) if len(sys.argv) > 2 else 1
    cv2.setNumThreads(1)
    begin, all_of_them = time.monotonic(), []
    for outcome in outcomes(count, seed, tuple(sys.argv[3:]) or None):
        all_of_them.append(outcome)
        if outcome.wrong:
            plain, features = "plain" if outcome.plain else "not plain", ", ".join(outcome.view.features)
            print(
                f"wrong: view {outcome.view.number}, {outcome}, {plain}: {features or 'nothing'}", flush=True
            )
    print(f"\n{'in the view':20s}    views    plain accepted of plain    wrong worst mm  refusals")
    for size in range(5):
        those = [it for it in all_of_them if len(it.view.features) == size]
        print(row(f"features: {size}", those))
    for name in sorted({name for it in all_of_them for name in it.view.features}):
        print(row(name, [it for it in all_of_them if name in it.view.features]))
    print(row("plain", [it for it in all_of_them if it.plain]))
    print(row("not plain", [it for it in all_of_them if not it.plain]))
    print(row("all", all_of_them))
    print(f"{time.monotonic() - begin:.0f} s for {count} views, seed {seed}; wrong is more than", end=" ")
    print(f"{m_to_mm(WRONG_PLACE):.1f} mm, {WRONG_ANGLE / DEG:.1f} degrees or {WRONG_SIGMA:.0f} sigma")
    return 1 if any(it.wrong and it.plain for it in all_of_them) else 0


if __name__ == "__main__":
    sys.exit(main())
