"""The door's pose from edge points: a robust fit of two lines that meet at a right angle."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from doormill_ros.localization.view import directions


@dataclass(frozen=True, eq=False)
class PoseFit:
    """Result of a fit.

    Attributes:
        pose: y, z [m] and rotation [rad], shape (3,).
        residuals: Distances of hinge and bottom points from their lines, inside positive [m].
        inliers: Which of them agree, bool.
        covariance: Of the pose, shape (3, 3).
    """

    pose: np.ndarray
    residuals: tuple[np.ndarray, np.ndarray]
    inliers: tuple[np.ndarray, np.ndarray]
    covariance: np.ndarray


def fit_pose(hinge: np.ndarray, bottom: np.ndarray, pose: np.ndarray, rounds: int = 8) -> PoseFit:
    """Fit the pose to face points of the hinge edge (n, 2) and the bottom edge (m, 2) [m]."""
    pose = np.array(pose, dtype=float)
    for i in range(rounds):
        y_axis, z_axis = directions(pose[2])
        offset_h, offset_b = hinge - pose[:2], bottom - pose[:2]
        residuals = (offset_h @ y_axis, offset_b @ z_axis)
        weights = []
        for r in residuals:
            scale = 1.4826 * np.median(np.abs(r - np.median(r))) + 1e-6
            if i < 3:  # the prediction may be off by more than the scatter: least absolute distances
                weights.append(scale / np.maximum(np.abs(r), scale))
            else:
                weights.append(np.clip(1 - (r / (4.7 * scale)) ** 2, 0, None) ** 2)
        along_h, along_b = offset_h @ z_axis, offset_b @ y_axis
        rows_h = np.column_stack([np.full(len(hinge), y_axis[0]), np.full(len(hinge), y_axis[1]), -along_h])
        rows_b = np.column_stack([np.full(len(bottom), z_axis[0]), np.full(len(bottom), z_axis[1]), along_b])
        rows, r, w = np.vstack([rows_h, rows_b]), np.concatenate(residuals), np.concatenate(weights)
        normal = rows.T @ (rows * w[:, None])
        pose = pose + np.linalg.solve(normal, rows.T @ (r * w))
    variance = np.sum(w * r**2) / max(np.sum(w) - 3, 1)
    return PoseFit(pose, residuals, tuple(x > 0 for x in weights), np.linalg.inv(normal) * variance * 40.0)
