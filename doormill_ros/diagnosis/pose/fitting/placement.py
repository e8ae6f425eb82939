"""Finds where a set stands: base-in-tracker and target-in-flange from poses alone."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from doormill_ros.arrays import FloatArray
from doormill_ros.measurements.errors import PosePlacementError
from doormill_ros.robot_model.pose.chain import (
    Placement,
    derivatives,
    free_directions,
    per_axis,
    residual,
)
from doormill_ros.statistics import huber_weights

#: A residual this many robust standard deviations large loses weight (Huber).
HUBER = 2.5
_SAMPLE = 400
#: Rows that a placement needs, with orientations and with positions alone.
_ROWS, _ROWS_OF_POSITIONS = 3, 4
#: How far from the flange a target is looked for where positions alone were measured [m].
_OFFSET = 0.2


@dataclass(frozen=True, eq=False)
class Seen:
    """Some rows of a series as a model has them and as the tracker saw them.

    Attributes:
        T_base_frames: Modelled frames, the flange last, shape (n, J + 1, 4, 4).
        position: Measured target, shape (n, 3) [m].
        rotation: R_tracker_target, shape (n, 3, 3), or None where not measured.
    """

    T_base_frames: FloatArray
    position: FloatArray
    rotation: FloatArray | None

    @property
    def oriented(self) -> bool:
        """Whether orientations were measured."""
        return self.rotation is not None


def rows_needed(oriented: bool) -> int:
    """Fewest rows that place a set."""
    return _ROWS if oriented else _ROWS_OF_POSITIONS


def first_placement(T_base_flange: FloatArray, position: FloatArray, rotation: FloatArray) -> Placement:
    """A placement without any guess: rotations alternately from twelve starts evenly spread, then positions linearly.

    Args:
        T_base_flange: Modelled flange poses, shape (n, 4, 4).
        position: Measured target, shape (n, 3) [m].
        rotation: R_tracker_target, shape (n, 3, 3).
    """
    pick = np.unique(np.linspace(0, len(position) - 1, min(_SAMPLE, len(position))).astype(int))
    flange, seen = T_base_flange[pick, :3, :3], rotation[pick]
    # Either rotation is the nearest one to a matrix that is linear in the other: sums over the rows are formed once.
    products = np.einsum("nij,nkl->ijkl", seen, flange)
    targets = Rotation.create_group("T").as_matrix()
    for _ in range(80):
        bases = _nearest(np.einsum("ijkl,slj->sik", products, targets))
        targets = _nearest(np.einsum("jkli,sjl->sik", products, bases))
    best: tuple[float, FloatArray, FloatArray] | None = None
    for R_tracker_base, R_flange_target in zip(bases, targets, strict=True):
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


def first_placement_of_points(flange: FloatArray, position: FloatArray) -> Placement:
    """A placement of a target whose position alone was seen: the best of seven guesses of where it is on the flange.

    Args:
        flange: T_base_flange as modelled, shape (n, 4, 4).
        position: Measured target, shape (n, 3) [m].
    """
    pick = np.unique(np.linspace(0, len(position) - 1, min(_SAMPLE, len(position))).astype(int))
    seen = Seen(flange[pick, None], position[pick], None)
    best: tuple[float, Placement] | None = None
    for offset in (np.zeros(3), *(_OFFSET * np.concatenate([np.eye(3), -np.eye(3)]))):
        points = seen.T_base_frames[:, -1, :3] @ np.append(offset, 1.0)
        T_tracker_base, T_flange_target = np.eye(4), np.eye(4)
        weight = np.ones(len(points))
        for _ in range(5):
            middle, centre = np.average(points, 0, weight), np.average(seen.position, 0, weight)
            R = _nearest((weight[:, None] * (seen.position - centre)).T @ (points - middle))
            weight = huber(np.linalg.norm(seen.position - centre - (points - middle) @ R.T, axis=1))
        T_tracker_base[:3, :3], T_tracker_base[:3, 3] = R, centre - R @ middle
        T_flange_target[:3, 3] = offset
        found = _refined([seen], (1e-3, 1.0), Placement(T_tracker_base, T_flange_target))
        error = residual(seen.T_base_frames, found, seen.position, None)
        cost = float(np.median(np.linalg.norm(error, axis=1)))
        if best is None or cost < best[0]:
            best = (cost, found)
    assert best is not None
    return best[1]


def huber(size: FloatArray, floor: float = 0.0) -> FloatArray:
    """Weights of residuals of these lengths, 1 for ordinary ones, shape (n,)."""
    scale = max(1.2 * float(np.median(size)), floor, 1e-12)
    return huber_weights(size, HUBER * scale)


def place_together(
    parts: Sequence[Seen], sigma: tuple[float, float], start: Placement | None = None
) -> Placement:
    """Robust least squares for the placement that several series have in common: twelve numbers.

    Nine where no orientation was measured: then the target is a point, and its frame is left parallel to the flange.

    Args:
        parts: The series.
        sigma: Expected deviation per axis, position [m] and rotation [rad].
        start: Where to start; found from the data when None.

    Raises:
        PosePlacementError: Too few rows and no start.
    """
    if start is None:
        oriented = [one for one in parts if one.rotation is not None]
        enough = len(oriented) == len(parts) or sum(len(one.position) for one in oriented) >= _ROWS
        chosen = oriented if enough else parts
        rows, needed = sum(len(one.position) for one in chosen), rows_needed(enough)
        if rows < needed:
            raise PosePlacementError(
                f"{rows} rows with placement 1 are given, a set is placed by at least {needed} different "
                f"{'poses' if enough else 'positions'}; mark more rows"
            )
        flange = np.concatenate([one.T_base_frames[:, -1] for one in chosen])
        position = np.concatenate([one.position for one in chosen])
        if enough:
            turned = [one.rotation for one in oriented if one.rotation is not None]
            start = first_placement(flange, position, np.concatenate(turned))
        else:
            start = first_placement_of_points(flange, position)
    return _refined(parts, sigma, start)


def _refined(parts: Sequence[Seen], sigma: tuple[float, float], placement: Placement) -> Placement:
    joints = parts[0].T_base_frames.shape[1] - 1
    free = free_directions(joints, any(one.oriented for one in parts))
    for _ in range(12):
        errors, slopes = [], []
        for one in parts:
            scale = per_axis(sigma, one.oriented)
            errors.append(residual(one.T_base_frames, placement, one.position, one.rotation) * scale)
            slopes.append(derivatives(one.T_base_frames, placement)[:, free] * scale)
        error, J = np.concatenate(errors), np.concatenate(slopes)
        weight = huber(np.linalg.norm(error, axis=1), floor=1.0) if len(error) > 4 else np.ones(len(error))
        H = np.einsum("n,nac,nbc->ab", weight, J, J)
        g = np.einsum("n,nac,nc->a", weight, J, error)
        # A whisper of damping: directions that the poses leave open stay where they are.
        size = np.sqrt(np.diag(H)) + 1e-9
        step = np.zeros(12)
        step[: len(free)] = (
            np.linalg.solve(H / np.outer(size, size) + 1e-9 * np.eye(len(free)), g / size) / size
        )
        placement = placement.moved(step[:6], step[6:])
        if np.abs(step).max() < 1e-10:
            break
    return placement


def _nearest(matrix: FloatArray) -> FloatArray:
    """Nearest rotations, shape (..., 3, 3)."""
    U, _, V = np.linalg.svd(matrix)
    U[..., 2] *= np.linalg.det(U @ V)[..., None]
    result: FloatArray = U @ V
    return result
