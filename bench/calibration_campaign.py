"""Whether calibrations keep what they state: `python bench/calibration_campaign.py [SESSIONS [MOUNTINGS [SEED]]]`.

Sessions are rendered pictures of uneven chessboards, a true camera each (test/support/pictures/uneven_boards.py).
Mountings are rendered pictures of a door moved by gauge blocks before a camera that was put up carelessly, of a focal
length known to 0.03 % and doors known to 0.05 mm; by four pictures of one door, and with a thick door as the fourth.
Counted is how often the truth lies within the stated 95 %, and of a mounting what it makes of the pose of a door,
worked out here by projecting the ideal edges through the true camera. Exit code 1 below LEAST.
"""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np

ROOT = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT), str(ROOT / "bench"), str(ROOT / "test")]

# ruff: noqa: E402
from doormill_ros.cell.places.layout import load_layout
from doormill_ros.frames import apply_twist, transform
from doormill_ros.localization.calibration.chessboard import Chessboard, find_corners
from doormill_ros.localization.calibration.errors import CalibrationError
from doormill_ros.localization.calibration.extrinsics import (
    Extrinsics,
    Knowledge,
    MovedDoor,
    calibrate_extrinsics,
)
from doormill_ros.localization.calibration.intrinsics import calibrate_intrinsics
from doormill_ros.localization.camera import CameraModel, load_camera
from doormill_ros.localization.sensors.corner_edges import PictureQuality
from doormill_ros.recipes.door import DoorSize
from doormill_ros.resources import resource
from doormill_ros.simulation.sensors.axis_vision import AxisVisionRig
from support.pictures.uneven_boards import session

SESSIONS, MOUNTINGS, SEED = 64, 24, 0
BOARD = Chessboard(9, 6, 0.020)
COVERED = 1.96  # standard deviations that hold 95 %
LEAST = 0.9
FOCAL, THICK = 3.0e-4, 5.0e-5  # how well focal length (share) and thickness [m] are known
WIDTH, HEIGHT, THIN, WIDE = 0.826, 2.04, 0.04, 0.1
QUALITY = PictureQuality(2.0, 25.0)
ALONG = np.linspace(0.002, 0.25, 125)  # m, places on the ideal edges
MARGIN = 14.0  # px from the picture's border


def sessions(count: int, seed: int) -> np.ndarray:
    """fx, fy, cx, cy, k1, k2, p1, p2 off the truth in stated standard deviations, shape (count, 8)."""
    rows = []
    for number in range(seed, seed + count):
        truth = session(number)
        corners = [find_corners(picture, BOARD) for picture in truth.pictures(number)]
        found = calibrate_intrinsics(corners, BOARD, truth.camera.shape[::-1])
        k = found.k
        numbers = np.array([k[0, 0], k[1, 1], k[0, 2], k[1, 2], *found.distortion[:4]])
        rows.append((numbers - truth.true) / [*found.k_deviation, *found.distortion_deviation[:4]])
    return np.array(rows)


def careless_rig() -> AxisVisionRig:
    """The face camera alone, a millimetre and a quarter of a degree off."""
    document = AxisVisionRig.load(resource("config/sensors/axis_vision.yaml")).document
    careless = {"position": 0.001, "rotation": 0.004}
    return AxisVisionRig(
        document | {"cameras": document["cameras"][:1], "mounting_deviation": careless}, load_layout()
    )


def calibrated(seed: int, thick: bool) -> tuple[Extrinsics, CameraModel, np.ndarray]:
    """A calibration from four pictures, the true camera and its true T_base_camera at a width of zero."""
    rng, known, camera = np.random.default_rng([seed, 77]), Knowledge(), load_camera()
    layout, rig = load_layout(), careless_rig()
    k = camera.k.copy()
    k[[0, 1], [0, 1]] *= 1.0 + FOCAL * rng.normal()
    rig = AxisVisionRig(rig.document | {"intrinsics": rig.document["intrinsics"] | {"k": k.tolist()}}, layout)
    misplaced = rng.normal(0, np.repeat([known.place, known.turn], 3))
    thicker = {THIN: THICK * rng.normal(), WIDE: THICK * rng.normal()}
    last = (WIDE, (0, 0, 0)) if thick else (THIN, (0, 0.01, 0.01))
    moved = []
    for number, (thickness, move) in enumerate(
        [(THIN, (0, 0, 0)), (THIN, (0, 0.01, 0)), (THIN, (0, 0, 0.01)), last]
    ):
        T_base_door = apply_twist(layout.T_base_door(WIDTH, thickness), misplaced)
        T_base_door[:3, 3] += np.array(move) + rng.normal(0, known.move, 3) * np.any(move)
        T_base_door[0, 3] -= thicker[thickness]
        picture = rig.take(T_base_door, WIDTH, HEIGHT, thickness, seed=1000 * seed + number, rig_seed=seed)
        door = DoorSize(width=WIDTH, height=HEIGHT, thickness=thickness)
        moved.append(MovedDoor(picture["1"], np.array(move, dtype=float), door))
    lens = np.zeros(9)
    lens[:2] = FOCAL * camera.k[[0, 1], [0, 1]]
    found = calibrate_extrinsics(moved, camera, layout, QUALITY, replace(known, lens=np.outer(lens, lens)))
    centre, axes = rig.stand(0, WIDTH, THIN, seed)
    return found, replace(camera, k=k), transform(axes, centre + np.array([0.0, WIDTH / 2, 0.0]))


def seems(found: CameraModel, truth: CameraModel, T_true: np.ndarray, thickness: float) -> np.ndarray:
    """y, z [m] and rotation [rad] by which a door seems off through the camera that was found, shape (3,).

    Args:
        found: As it was calibrated.
        truth: Its lens as it is.
        T_true: T_base_camera as it is, at a width of zero, shape (4, 4).
        thickness: Of the door [m].
    """
    slid = np.array([0.0, -WIDTH / 2, 0.0])
    corner = load_layout().T_base_door(WIDTH, thickness)[:3, 3]
    edges = [corner + np.outer(ALONG, axis) for axis in ([0, 0, 1], [0, 1, 0])]
    rows, off = [], []
    T_found = found.T_base_camera(WIDTH)
    for edge, points in enumerate(edges):
        ahead = (points - T_true[:3, 3] - slid) @ T_true[:3, :3]
        pixels, _ = cv2.projectPoints(ahead, np.zeros(3), np.zeros(3), truth.k, truth.distortion)
        pixels = pixels[:, 0]
        seen = np.all((pixels > MARGIN) & (pixels < np.array(truth.size) - MARGIN), axis=1)
        rays = found.undistort(pixels[seen])
        ways = np.column_stack([rays, np.ones(len(rays))]) @ T_found[:3, :3].T
        at = T_found[:3, 3] + ways * ((corner[0] - T_found[0, 3]) / ways[:, :1])
        y, z = (at - corner)[:, 1:].T
        # A door turned by a about x: its hinge edge stands at y - a z, its bottom edge at z + a y.
        off.append(y if edge == 0 else z)
        rows.append(
            np.column_stack([np.ones_like(y), np.zeros_like(y), -z])
            if edge == 0
            else np.column_stack([np.zeros_like(y), np.ones_like(y), y])
        )
    return np.linalg.lstsq(np.vstack(rows), np.concatenate(off), rcond=None)[0]


def mountings(count: int, seed: int, thick: bool) -> tuple[np.ndarray, np.ndarray]:
    """Doors of 40 and 100 mm off in stated standard deviations, and these, each (count, 6)."""
    off, stated = [], []
    for number in range(seed, seed + count):
        found, truth, T_true = calibrated(number, thick)
        deviations = [found.door_deviation.get(t, found.door_deviation[THIN]) for t in (THIN, WIDE)]
        errors = [seems(found.camera, truth, T_true, t) for t in (THIN, WIDE)]
        stated.append(np.concatenate(deviations))
        off.append(np.concatenate(errors) / stated[-1])
    return np.array(off), np.array(stated)


def held(off: np.ndarray) -> float:
    """Share within the stated 95 %, in percent."""
    return 100 * float(np.mean(np.abs(off) < COVERED))


def main(arguments: list[str]) -> int:
    """Print what held."""
    cv2.setNumThreads(1)
    given = [int(v) for v in arguments]
    session_count, mounting_count, seed = given + [SESSIONS, MOUNTINGS, SEED][len(given) :]
    shares = []
    try:
        off = sessions(session_count, seed)
        shares.append(held(off))
        print(
            f"{session_count} sessions: stated 95 % hold {shares[-1]:.0f} %, largest error "
            f"{np.abs(off).max():.1f} standard deviations",
            flush=True,
        )
        for thick in (False, True):
            off, stated = mountings(mounting_count, seed, thick)
            shares.append(held(off))
            z = [held(off[:, [i]]) for i in (1, 4)]
            print(
                f"{mounting_count} mountings {'with' if thick else 'without'} a thick door: stated 95 % hold "
                f"{shares[-1]:.0f} %, z at 40 mm {z[0]:.0f} %, at 100 mm {z[1]:.0f} %, largest error "
                f"{np.abs(off).max():.1f} standard deviations, stated in z at 100 mm "
                f"{1e6 * np.median(stated[:, 4]):.0f} um",
                flush=True,
            )
    except CalibrationError as error:
        print(f"refused: {error.message}")
        return 1
    return 1 if min(shares) < 100 * LEAST else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
