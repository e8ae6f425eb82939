"""Door localisation on a corpus of workshop pictures, beside plain OpenCV and the thesis.

`python bench/bench_localization.py [COUNT [SEED]]` prints the whole account; bench/run.py takes
the entries. Times are processor time on one core. A peer that finds no line is counted as
10 mm and 2 degrees off, the limits of where the door may stand.
"""

from __future__ import annotations

import sys
import time
from functools import partial
from pathlib import Path

import one_core  # noqa: F401  before numpy

# isort: split
import cv2
import numpy as np

ROOT = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT), str(ROOT / "bench"), str(ROOT / "test")]

# ruff: noqa: E402
from localization_peers import Strips, canny_hough, segments
from wrong_pose import WRONG_ANGLE, WRONG_PLACE

from doormill_ros.cell.places.layout import load_layout
from doormill_ros.localization.camera import load_camera
from doormill_ros.localization.errors import LocalizationError
from doormill_ros.localization.localizer import localize, prepare
from doormill_ros.localization.settings import load_settings
from doormill_ros.localization.view import face_view
from doormill_ros.simulation.picture.picture import render_picture
from doormill_ros.units import DEG, MM
from harness import Entry, entry
from support.pictures.corpus import corpus

COUNT, SEED = 300, 2018
THESIS_TIME = 0.8  # s, thesis table 4.7
LOST = np.array([10 * MM, 10 * MM, 2 * DEG])
OURS, HOUGH, LSD = "ours", "Canny + Hough", "OpenCV line segments"
# A pose is confidently wrong when it is wrong by its place or angle, or by six of its own standard deviations.
WRONG_SIGMA = 6.0


def timed(call, *args):
    start = time.process_time()
    out = call(*args)
    return out, time.process_time() - start


def look(count: int, seed: int) -> dict:
    """Localise every picture by every means."""
    camera, layout = load_camera(), load_layout()
    known = load_settings().picture_only()  # the corpus gives every door its true thickness and mounting
    errors, times = {k: [] for k in (OURS, HOUGH, LSD)}, {k: [] for k in (OURS, HOUGH, LSD)}
    account = {"acceptable": 0, "accepted": 0, "wrong": [], "refused": {}, "normalized": []}
    ours = partial(localize, settings=known)
    for i, item in enumerate(corpus(count, seed)):
        scene = item.scene
        picture = render_picture(scene, item.seed)
        true = np.array([scene.offset.y, scene.offset.z, scene.offset.rotation])
        prepare(camera, layout, scene.width, scene.thickness)  # as the peers' strips are, before the picture
        try:
            found, seconds = timed(ours, picture, camera, layout, scene.width, scene.thickness)
        except LocalizationError as reason:
            found = None
            account["refused"].setdefault(item.label, []).append(type(reason).__name__)
        if found:
            pose = np.array([found.offset.y, found.offset.z, found.offset.rotation])
            error = pose - true
            square = error @ np.linalg.solve(found.covariance, error)
            off = np.hypot(*error[:2]) > WRONG_PLACE or abs(error[2]) > WRONG_ANGLE
            if off or square > WRONG_SIGMA**2:
                account["wrong"].append((i, item.label, error, square))
        if not item.acceptable:
            continue
        account["acceptable"] += 1
        strips = Strips(camera, face_view(camera, layout, scene.width, scene.thickness))
        hough, hough_time = timed(canny_hough, picture, strips)
        lsd, lsd_time = timed(segments, picture, strips, pose if found else true)
        for name, result, spent in ((HOUGH, hough, hough_time), (LSD, lsd, lsd_time)):
            errors[name].append(LOST if result is None else np.minimum(np.abs(result - true), LOST))
            times[name].append(spent)
        if found:
            account["accepted"] += 1
            account["normalized"].append(square)
            errors[OURS].append(np.abs(error))
            times[OURS].append(seconds)
    account["errors"] = {k: np.array(v) for k, v in errors.items()}
    account["times"] = {k: float(np.median(v)) for k, v in times.items()}
    return account


def run(count: int = COUNT, seed: int = SEED) -> list[Entry]:
    """Entries of bench.json."""
    cv2.setNumThreads(1)
    account = look(count, seed)
    errors, times = account["errors"], account["times"]
    n = account["acceptable"]
    print(
        f"{account['accepted']} of {n} acceptable pictures accepted, {len(account['wrong'])} confident wrong poses"
    )
    for wrong in account["wrong"]:
        print("  confidently wrong:", *wrong)
    for label, reasons in account["refused"].items():
        print(f"  refused, {label}: " + ", ".join(f"{r} {reasons.count(r)}" for r in sorted(set(reasons))))
    normalized = np.array(account["normalized"])
    print(
        f"normalized squared error: mean {normalized.mean():.2f} (3 expected), above 7.81: "
        f"{100 * np.mean(normalized > 7.81):.1f} % (5 expected)"
    )
    for name in (OURS, HOUGH, LSD):
        place_um = 1e6 * np.hypot(errors[name][:, 0], errors[name][:, 1])
        angle_mrad = 1e3 * errors[name][:, 2]
        print(
            f"{name}: place off by {np.median(place_um):.1f} um median, {np.percentile(place_um, 95):.1f} um 95 %; "
            f"rotation {np.median(angle_mrad):.3f} mrad, {np.percentile(angle_mrad, 95):.3f} mrad; "
            f"{1e3 * times[name]:.1f} ms"
        )
    entries = []
    place = {k: float(np.percentile(np.hypot(e[:, 0], e[:, 1]), 95)) for k, e in errors.items()}
    angle = {k: float(np.percentile(e[:, 2], 95)) for k, e in errors.items()}
    for peer in (HOUGH, LSD):
        entries.append(entry("door place error, 95th percentile", place[OURS], "m", peer, place[peer], n))
        entries.append(
            entry("door rotation error, 95th percentile", angle[OURS], "rad", peer, angle[peer], n)
        )
        entries.append(entry("picture to pose", times[OURS], "s", peer, times[peer], n))
    entries.append(entry("picture to pose", times[OURS], "s", "thesis, table 4.7", THESIS_TIME, n))
    entries.append(
        entry("door place error, 95th percentile", place[OURS], "m", "thesis, table 4.7", 0.2 * MM, n)
    )
    return entries


if __name__ == "__main__":
    for item in run(*(int(v) for v in sys.argv[1:3])):
        print(f"{item.name}: {item.median:.4g} {item.unit}; {item.peer}: {item.peer_median:.4g}, n={item.n}")
