"""The localizer under two conditions at once: `python bench/bench_pairs.py [COUNT [SEED]]`.

Pairs of conditions of which each alone leaves both edges plain (test/support/pictures/pairs.py). Printed are the wrong
poses, as of bench_conditions.py, and what became of all pictures. Exit code 1 when a pose is wrong of a pair that can
be seen.
"""

from __future__ import annotations

import sys
import time
from collections import Counter
from pathlib import Path

import one_core  # noqa: F401  before numpy

# isort: split
import cv2
import numpy as np

ROOT = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT), str(ROOT / "bench"), str(ROOT / "test")]

# ruff: noqa: E402
from wrong_pose import distance, is_wrong

from doormill_ros.cell.places.layout import load_layout
from doormill_ros.localization.camera import load_camera
from doormill_ros.localization.errors import LocalizationError
from doormill_ros.localization.localizer import localize, prepare
from doormill_ros.simulation.picture.picture import render_picture
from doormill_ros.units import m_to_mm
from support.pictures.pairs import is_unseen, pairs

COUNT, SEED = 500, 7


def main() -> int:
    """Print what is wrong, and the sums."""
    given = [int(value) for value in sys.argv[1:3]]
    count, seed = (given + [COUNT, SEED][len(given) :])[:2]
    cv2.setNumThreads(1)
    camera, layout = load_camera(), load_layout()
    reasons: Counter[str] = Counter()
    wrong: Counter[bool] = Counter()
    accepted: Counter[bool] = Counter()
    times = []
    for (one, other), item in pairs(count, seed):
        scene, unseen = item.scene, is_unseen(one, other)
        picture = render_picture(scene, item.seed)
        prepare(camera, layout, scene.width, item.thickness)
        start = time.process_time()
        try:
            found = localize(picture, camera, layout, scene.width, item.thickness)
        except LocalizationError as reason:
            reasons[type(reason).__name__] += 1
            continue
        finally:
            times.append(1e3 * (time.process_time() - start))
        accepted[unseen] += 1
        if is_wrong(found, scene.offset):
            wrong[unseen] += 1
            known = ", known" if unseen else ""
            print(f"wrong by {m_to_mm(distance(found, scene.offset)):.3f} mm: {one}; {other}{known}")
    print(f"refused: {', '.join(f'{reason} {n}' for reason, n in reasons.most_common())}")
    for unseen, what in ((False, "that can be seen"), (True, "that cannot be seen")):
        print(f"pairs {what}: {wrong[unseen]} wrong of {accepted[unseen]} accepted")
    print(f"{sum(accepted.values())} of {count} pictures accepted")
    print(f"{float(np.median(times)):.1f} ms a picture in the median, {max(times):.0f} ms at most")
    return 1 if wrong[False] else 0


if __name__ == "__main__":
    sys.exit(main())
