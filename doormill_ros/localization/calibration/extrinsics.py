"""Where the camera stands, from a door that is moved by known steps (thesis section 3.7).

The thesis moves the door by 10 mm along both axes and divides by the pixels it went. That gives a
scale for one thickness and leaves the camera's tilt in it. Here every edge point of every picture
speaks: the camera is put where the rays of all edges, moved as they were, fit best.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.cell.places.layout import CellLayout
from doormill_ros.frames import transform, vector_from_rotation
from doormill_ros.localization.calibration.errors import PoorlySpread, TooFewPictures
from doormill_ros.localization.calibration.lens_share import by_lens, door_deviation
from doormill_ros.localization.calibration.move_test import check_moves
from doormill_ros.localization.calibration.moved_door import MovedDoor, SeenDoor
from doormill_ros.localization.calibration.thesis_scale import thesis_scale
from doormill_ros.localization.camera import R_BASE_CAMERA_NOMINAL, CameraModel
from doormill_ros.localization.checks import check_size
from doormill_ros.localization.sensors.corner_edges import PictureQuality, find_corner_edges
from doormill_ros.localization.sensors.edge_rays import depth, miss
from doormill_ros.localization.sensors.errors import SensorError
from doormill_ros.localization.sensors.fit import Linearised, check_agreement, solve_pose

_FEWEST = 3
APART = 0.03  #: Difference of two doors' thickness from which they count as different [m]
_THINNEST, _THICKEST = 0.03, 0.1  # doors that the cell mills [m]
# How far the camera may be from where its file has it, as a twist of the door [m, rad].
_TOLERANCE = np.array([0.004, 0.004, 0.004, 0.02, 0.02, 0.02])


@dataclass(frozen=True, eq=False)
class Knowledge:
    """How well the door is known, standard deviations [m, rad].

    Attributes:
        place: Of the reference place along each axis.
        turn: Of the door's rotation about each axis in the reference place.
        move: Of a move along each axis; gauge blocks are good to micrometres, the clamp is not.
        thickness: Of each door's thickness, which puts its face nearer or further off.
        roughness: RMS of the door's edges about their lines.
        correlation: Distance over which the roughness changes [m].
        lens: Covariance of fx, fy, cx, cy [px], k1, k2, p1, p2, k3 of the camera, shape (9, 9); None: known exactly.
    """

    place: float = 1.0e-5
    turn: float = 5.0e-5
    move: float = 5.0e-6
    thickness: float = 5.0e-5
    roughness: float = 2.0e-5
    correlation: float = 2.0e-3
    lens: FloatArray | None = None


@dataclass(frozen=True, eq=False)
class Extrinsics:
    """Outcome of `calibrate_extrinsics`.

    Attributes:
        camera: The camera with its mounting corrected.
        covariance: Of the twist from the found to the true camera, at the projection centre, base
            axes, shape (6, 6) [m, rad].
        chi_square: Weighted sum of squared residuals.
        redundancy: Edge points beyond the six that are needed.
        scale: The thesis' scale along base y and z: moved length over pixels [m], nan without such a move.
        model_scale: The same from the found camera [m].
        door_deviation: For each thickness in the pictures, and the thinnest and thickest doors, the standard deviations
            that mounting and lens leave in a door's y, z [m] and rotation [rad].
        thicknesses: Those in the pictures [m].
    """

    camera: CameraModel
    covariance: FloatArray
    chi_square: float
    redundancy: int
    scale: tuple[float, float]
    model_scale: tuple[float, float]
    door_deviation: dict[float, FloatArray]
    thicknesses: tuple[float, ...]

    @property
    def needs_a_thick_door(self) -> bool:
        """Whether a door much thicker or thinner would tell distance from focal length and thickness."""
        return max(self.thicknesses) - min(self.thicknesses) < APART


def calibrate_extrinsics(
    moved: list[MovedDoor],
    camera: CameraModel,
    layout: CellLayout,
    quality: PictureQuality,
    knowledge: Knowledge | None = None,
) -> Extrinsics:
    """Find the mounting that fits the camera's intrinsics as they are; what these may be off is in the covariance.

    Args:
        moved: The pictures; the reference place is the nominal place of `layout`.
        camera: Intrinsics, and a mounting good to a few millimetres.
        layout: Where the nominal door stands.
        quality: Noise and least contrast of the pictures.
        knowledge: How well door and moves are known.

    Raises:
        TooFewPictures: Fewer than three.
        CameraInfoSize: A picture has another size than the camera's.
        EdgeNotFound: A picture shows no edge.
        PoorlySpread: The moves leave the mounting open, or one of them or all do not fit the pictures.
    """
    if len(moved) < _FEWEST:
        raise TooFewPictures(
            f"{len(moved)} pictures of the moved door, at least {_FEWEST} are needed: one in the reference "
            "place, one moved along y and one along z"
        )
    for item in moved:
        check_size(item.picture.shape[::-1], camera)
    looked = [_look(m, camera, layout, quality, i) for i, m in enumerate(moved)]
    # The slider goes with the width: the camera is solved for in a frame that goes with it too.
    reference = camera.T_base_camera(0.0)
    known = knowledge or Knowledge()
    lens = np.zeros((9, 9)) if known.lens is None else known.lens
    shares = _lens_shares(looked, camera)
    alone = _covariance(looked, camera, known)

    def linearise(T_base_camera: FloatArray, covariance: FloatArray) -> Linearised:
        parts = [
            miss(item.T_base_door, _slide(T_base_camera, item.moved.door.width), e.axis, e.rays)
            for item in looked
            for e in item.edges
        ]
        return Linearised(
            -np.concatenate([p[0] for p in parts]), np.vstack([p[2] for p in parts]), covariance
        )

    what = "edge points of the moved door"
    try:
        # Whether all fits together is judged as the lens is known: it may be off.
        judged = partial(linearise, covariance=alone + shares @ lens @ shares.T)
        fit = solve_pose(reference, judged, what)
        check_moves(moved, _move_shares(looked, camera), judged(fit.T_base_door))
        check_agreement(fit, what)
        # The mounting goes into the file beside the lens that is there, not beside one that fits better.
        as_filed = partial(linearise, covariance=alone)
        own = solve_pose(fit.T_base_door, as_filed, what)
    except SensorError as error:
        raise PoorlySpread(f"{error.message}; check the list of moves against the pictures") from error
    found = _mounted(camera, own.T_base_door)
    # What a lens that is off by one does to the mounting: the fit turns the camera until the edges agree again.
    jacobian = as_filed(own.T_base_door).jacobian
    by_one = -own.covariance @ jacobian.T @ np.linalg.solve(alone, shares)
    pictured = {item.moved.door.thickness for item in looked}
    doors = [replace(looked[0].moved.door, thickness=t) for t in sorted(pictured | {_THINNEST, _THICKEST})]
    scales = [thesis_scale(looked, camera, found, axis) for axis in (1, 2)]
    return Extrinsics(
        camera=found,
        covariance=own.covariance + by_one @ lens @ by_one.T,
        chi_square=fit.chi_square,
        redundancy=fit.redundancy,
        scale=(scales[0][0], scales[1][0]),
        model_scale=(scales[0][1], scales[1][1]),
        door_deviation={
            door.thickness: door_deviation(looked[0].edges, door, found, layout, own.covariance, by_one, lens)
            for door in doors
        },
        thicknesses=tuple(sorted(pictured)),
    )


def _look(
    moved: MovedDoor, camera: CameraModel, layout: CellLayout, quality: PictureQuality, number: int
) -> SeenDoor:
    T_base_door = layout.T_base_door(moved.door.width, moved.door.thickness)
    T_base_door[:3, 3] += moved.move
    T_base_camera = camera.T_base_camera(moved.door.width)
    edges = find_corner_edges(
        moved.picture,
        camera,
        T_base_camera,
        T_base_door,
        "face",
        moved.door,
        _TOLERANCE,
        quality,
        f"picture {number + 1}",
    )
    return SeenDoor(edges, moved, T_base_door)


def _slide(T_base_camera: FloatArray, width: float) -> FloatArray:
    return transform(T_base_camera[:3, :3], T_base_camera[:3, 3] - [0.0, width / 2.0, 0.0])


def _mounted(camera: CameraModel, T_base_camera: FloatArray) -> CameraModel:
    turn = vector_from_rotation(R_BASE_CAMERA_NOMINAL.T @ T_base_camera[:3, :3])
    return replace(camera, position=T_base_camera[:3, 3], rotation_vector=turn)


def _covariance(looked: list[SeenDoor], camera: CameraModel, known: Knowledge) -> FloatArray:
    """Of all misses: noise, the door's roughness that moves along with it, moves and reference place."""
    focal = camera.focal
    rows = [(i, e) for i, item in enumerate(looked) for e in item.edges]
    total = sum(len(e.rays) for _, e in rows)
    axis, along, far, noise = (np.empty(total) for _ in range(4))
    place, step = np.zeros((total, 6)), np.zeros((total, 3 * len(looked)))
    nearer = np.zeros(total)
    begin = 0
    for i, e in rows:
        part = slice(begin, begin + len(e.rays))
        begin = part.stop
        item = looked[i]
        T_base_camera = camera.T_base_camera(item.moved.door.width)
        axis[part], along[part], noise[part] = e.axis, e.along, e.deviation / focal
        far[part] = depth(item.T_base_door, T_base_camera, e.axis, e.along)
        by_door = miss(item.T_base_door, T_base_camera, e.axis, e.rays)[1]
        place[part] = by_door
        nearer[part] = known.thickness * by_door[:, 0]
        if np.any(item.moved.move):
            step[part, 3 * i : 3 * i + 3] = by_door[:, :3]
    # Another thickness is another door, with edges of its own; its roughness is drawn anew.
    door = np.concatenate([np.full(len(e.rays), looked[i].moved.door.thickness) for i, e in rows])
    alike = np.exp(-np.abs(along[:, None] - along) / known.correlation)
    alike *= (axis[:, None] == axis) & (door[:, None] == door)
    out = known.roughness**2 * alike / np.outer(far, far) + np.diag(noise**2)
    place *= np.repeat([known.place, known.turn], 3)
    out += np.outer(nearer, nearer) * (door[:, None] == door)
    return out + place @ place.T + known.move**2 * step @ step.T


def _move_shares(looked: list[SeenDoor], camera: CameraModel) -> FloatArray:
    """What a shift of each picture's door along base x, y, z does to all misses, shape (n, pictures, 3)."""
    parts = []
    for i, item in enumerate(looked):
        T_base_camera = camera.T_base_camera(item.moved.door.width)
        for e in item.edges:
            part = np.zeros((len(e.rays), len(looked), 3))
            part[:, i] = miss(item.T_base_door, T_base_camera, e.axis, e.rays)[1][:, :3]
            parts.append(part)
    return np.concatenate(parts)


def _lens_shares(looked: list[SeenDoor], camera: CameraModel) -> FloatArray:
    """What the lens does to all misses, shape (n, 9)."""
    return np.vstack(
        [
            by_lens(camera, item.T_base_door, camera.T_base_camera(item.moved.door.width), e.axis, e.rays)
            for item in looked
            for e in item.edges
        ]
    )
