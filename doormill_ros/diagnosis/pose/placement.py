"""Finds where a set stands: base-in-tracker and target-in-flange from poses alone."""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from doormill_ros.arrays import FloatArray
from doormill_ros.measurements.errors import PosePlacementError
from doormill_ros.robot_model.pose.chain import Placement, derivatives, residual
from doormill_ros.statistics import huber_weights

#: A residual this many robust standard deviations large loses weight (Huber).
HUBER = 2.5
_SAMPLE = 400


def first_placement(T_base_flange: FloatArray, position: FloatArray, rotation: FloatArray) -> Placement:
    """A placement without any guess: rotations alternately from twelve starts evenly spread, then positions linearly.

    Args:
        T_base_flange: Modelled flange poses, shape (n, 4, 4).
        position: Measured target, shape (n, 3) [m].
        rotation: R_tracker_target, shape (n, 3, 3).
    """
    pick = np.unique(np.linspace(0, len(position) - 1, min(_SAMPLE, len(position))).astype(int))
    flange, seen = T_base_flange[pick, :3, :3], rotation[pick]
    best: tuple[float, FloatArray, FloatArray] | None = None
    for start in Rotation.create_group("T").as_matrix():
        R_flange_target = start
        for _ in range(80):
            R_tracker_base = _nearest(np.einsum("nij,nkj->ik", seen, flange @ R_flange_target))
            R_flange_target = _nearest(np.einsum("nji,njk->ik", R_tracker_base @ flange, seen))
        cost = float(np.median(np.abs(seen - R_tracker_base @ flange @ R_flange_target).sum(axis=(1, 2))))
        if best is None or cost < best[0] * (1.0 - 1e-6):
            best = (cost, R_tracker_base, R_flange_target)
    assert best is not None
    _, R_tracker_base, R_flange_target = best
    n = len(position)
    turned = R_tracker_base @ T_base_flange[:, :3, :3]
    design = np.concatenate([turned, np.broadcast_to(np.eye(3), (n, 3, 3))], axis=2)
    wanted = position - T_base_flange[:, :3, 3] @ R_tracker_base.T
    weight = np.ones(n)
    for _ in range(10):
        root = np.sqrt(weight)[:, None]
        solution = np.linalg.lstsq(
            (design * root[:, :, None]).reshape(-1, 6), (wanted * root).ravel(), rcond=None
        )[0]
        size = np.linalg.norm(wanted - design @ solution, axis=1)
        weight = huber(size)
    T_tracker_base, T_flange_target = np.eye(4), np.eye(4)
    T_tracker_base[:3, :3], T_tracker_base[:3, 3] = R_tracker_base, solution[3:]
    T_flange_target[:3, :3], T_flange_target[:3, 3] = R_flange_target, solution[:3]
    return Placement(T_tracker_base, T_flange_target)


def huber(size: FloatArray, floor: float = 0.0) -> FloatArray:
    """Weights of residuals of these lengths, 1 for ordinary ones, shape (n,)."""
    scale = max(1.2 * float(np.median(size)), floor, 1e-12)
    return huber_weights(size, HUBER * scale)


def fit_placement(
    T_base_frames: FloatArray,
    position: FloatArray,
    rotation: FloatArray,
    sigma: tuple[float, float],
    start: Placement | None = None,
) -> Placement:
    """Robust least squares for the twelve numbers of a placement.

    Args:
        T_base_frames: Modelled frames, shape (n, 7, 4, 4).
        position: Measured target, shape (n, 3) [m].
        rotation: R_tracker_target, shape (n, 3, 3).
        sigma: Expected deviation per axis, position [m] and rotation [rad].
        start: Where to start; found from the data when None.

    Raises:
        PosePlacementError: Fewer than three rows and no start.
    """
    if start is None:
        if len(position) < 3:
            raise PosePlacementError(
                f"{len(position)} rows with placement 1 are given, a set is placed by at least 3 different poses; "
                "mark more rows"
            )
        start = first_placement(T_base_frames[:, -1], position, rotation)
    placement = start
    scale = np.repeat(1.0 / np.array(sigma), 3)
    for _ in range(12):
        error = residual(T_base_frames, placement, position, rotation) * scale
        J = derivatives(T_base_frames, placement)[:, [*range(6), *range(36, 42)]] * scale
        weight = huber(np.linalg.norm(error, axis=1), floor=1.0) if len(error) > 4 else np.ones(len(error))
        H = np.einsum("n,nac,nbc->ab", weight, J, J)
        g = np.einsum("n,nac,nc->a", weight, J, error)
        # A whisper of damping: directions that the poses leave open stay where they are.
        size = np.sqrt(np.diag(H)) + 1e-9
        step = np.linalg.solve(H / np.outer(size, size) + 1e-9 * np.eye(12), g / size) / size
        placement = placement.moved(step[:6], step[6:])
        if np.abs(step).max() < 1e-10:
            break
    return placement


def _nearest(matrix: FloatArray) -> FloatArray:
    U, _, V = np.linalg.svd(matrix)
    result: FloatArray = U @ np.diag([1.0, 1.0, np.linalg.det(U @ V)]) @ V
    return result
