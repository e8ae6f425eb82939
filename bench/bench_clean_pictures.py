"""Spread of the door's pose over clean pictures, beside the least that noise and blur leave any estimator.

Each set of pictures shows one door under fresh noise; a ratio above `ALLOWED` fails the bench.
"""

from __future__ import annotations

import sys
from pathlib import Path

import cv2
import numpy as np

ROOT = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT), str(ROOT / "bench"), str(ROOT / "test")]

# ruff: noqa: E402
from doormill_ros.cell.places.layout import DoorOffset, load_layout
from doormill_ros.localization.camera import load_camera
from doormill_ros.localization.localizer import localize
from doormill_ros.localization.settings import load_settings
from doormill_ros.simulation.picture.optics import expose
from doormill_ros.simulation.picture.scene import PictureScene, Sensor
from doormill_ros.units import MM
from harness import Entry, limit
from support.pictures.bound import cramer_rao_deviations
from support.pictures.expected import expected_picture

COUNT, SEED = 200, 2018  # pictures of a set; the spread of 200 is known to 5 %
ALLOWED = 1.5
# Width and thickness of the door, where it stands, and the camera: point spread [px], noise [grey levels].
SCENES = (
    PictureScene(
        0.9, 0.05, DoorOffset(3.1 * MM, -4.2 * MM, 0.013), sensor=Sensor(blur=0.9, read_noise=2, gain=0)
    ),
    PictureScene(
        0.7, 0.04, DoorOffset(-6.4 * MM, 2.7 * MM, -0.021), sensor=Sensor(blur=1.4, read_noise=1, gain=0.02)
    ),
    PictureScene(
        1.2, 0.07, DoorOffset(5.3 * MM, 7.8 * MM, 0.006), sensor=Sensor(blur=2.0, read_noise=2, gain=0)
    ),
)


def errors(scene: PictureScene, count: int, seed: int) -> np.ndarray:
    """Errors of y, z [m] and rotation [rad] over pictures of one scene, shape (count, 3)."""
    camera, layout, rng = load_camera(), load_layout(), np.random.default_rng(seed)
    radiance, out = expected_picture(scene, 0) / np.float32(255.0), []
    for _ in range(count):
        picture = expose(radiance, scene.sensor, rng)
        found, true = localize(picture, camera, layout, scene.width, scene.thickness).offset, scene.offset
        out.append([found.y - true.y, found.z - true.z, found.rotation - true.rotation])
    return np.array(out)


def run(count: int = COUNT, seed: int = SEED) -> list[Entry]:
    """Entries of bench.json: spread over bound of y, z and rotation, for each scene."""
    cv2.setNumThreads(1)
    entries = []
    for i, scene in enumerate(SCENES):
        bound = cramer_rao_deviations(scene, load_settings().squareness)
        off = errors(scene, count, seed + i)
        spread, mean, sensor = off.std(axis=0, ddof=1), off.mean(axis=0), scene.sensor
        label = f"blur {sensor.blur:g} px, noise {sensor.read_noise:g} grey levels, gain {sensor.gain:g}"
        print(
            f"{label}: spread of y {1e6 * spread[0]:.2f}, z {1e6 * spread[1]:.2f} um, rotation "
            f"{1e6 * spread[2]:.1f} urad; bound {1e6 * bound[0]:.2f}, {1e6 * bound[1]:.2f} um, "
            f"{1e6 * bound[2]:.1f} urad; mean error {1e6 * mean[0]:+.2f}, {1e6 * mean[1]:+.2f} um, "
            f"{1e6 * mean[2]:+.1f} urad"
        )
        for name, ratio in zip(("y", "z", "rotation"), spread / bound, strict=True):
            item = f"clean pictures, spread of {name}, {label}"
            entries.append(limit(item, ratio, "times the Cramer-Rao bound", ALLOWED, count))
    return entries


if __name__ == "__main__":
    for item in run(*(int(v) for v in sys.argv[1:3])):
        print(f"{item.name}: {item.median:.3f} {item.unit}; {item.peer}: {item.peer_median:g}, n={item.n}")
