"""True door poses and the statistics that the tests of all sensors use."""

from __future__ import annotations

import numpy as np
from scipy.stats import chi2

from doormill_ros.cell.places.layout import DoorOffset, load_layout
from doormill_ros.frames import apply_twist, twist_between
from doormill_ros.localization.sensors.sensor import DoorPoseEstimate
from doormill_ros.recipes.door import DoorSize

SIZES = (
    DoorSize(width=0.290, height=1.2, thickness=0.030),
    DoorSize(width=0.826, height=2.04, thickness=0.040),
    DoorSize(width=1.350, height=3.0, thickness=0.100),
)
LIMITS = np.array([0.0015, 0.009, 0.009, 0.0314, 0.006, 0.006])  # nine tenths of what the clamp allows


def true_pose(door: DoorSize, rng: np.random.Generator, share: float = 1.0) -> np.ndarray:
    """T_base_door anywhere within `share` of the limits, shape (4, 4)."""
    nominal = load_layout().T_base_door(door.width, door.thickness, DoorOffset())
    return apply_twist(nominal, share * LIMITS * rng.uniform(-1, 1, 6))


def error(estimate: DoorPoseEstimate, T_base_door: np.ndarray) -> np.ndarray:
    """Twist from the estimate to the truth, shape (6,)."""
    return twist_between(estimate.T_base_door, T_base_door)


def mahalanobis(estimate: DoorPoseEstimate, T_base_door: np.ndarray) -> float:
    """Normalised squared error: chi-square with six degrees of freedom when the covariance is honest."""
    miss = error(estimate, T_base_door)
    return float(miss @ np.linalg.solve(estimate.covariance, miss))


def assert_honest(squares: list[float], freedom: int = 6) -> None:
    """The sum of normalised squared errors lies in the central 99.9 % of its chi-square, and no tail is fat."""
    total, count = float(np.sum(squares)), freedom * len(squares)
    low, high = chi2.ppf([0.0005, 0.9995], count)
    assert low < total < high, f"mean {total / count:.3f} of 1, allowed {low / count:.3f}..{high / count:.3f}"
    worst = chi2.isf(1e-3 / len(squares), freedom)
    assert max(squares) < worst, f"largest {max(squares):.1f}, allowed {worst:.1f}"
