"""How a displacement is observed: noise of tracker and force sensor, and causes in the tracker."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.diagnosis.core.fitting.problem import split
from doormill_ros.measurements.trials import Trials
from doormill_ros.robot_model.elastic.causes.cause import ElasticCause
from doormill_ros.robot_model.elastic.load_case import LoadCase


def displacement_noise(case: LoadCase, data: Trials) -> FloatArray:
    """Covariance of each displacement, shape (n, 3, 3): tracker, and force sensor through the springs."""
    noise = data.noise
    load = case.origin[:, 6] + case.axes[:, 6] @ data.load_point
    by_force = np.zeros((len(case), 3, 3))
    by_moment = np.zeros((len(case), 3, 3))
    for k in range(6):
        lever = case.joint_twist(k)[:, :3] / case.joint_stiffness[k]
        arm = np.cross(case.axis(k), load - case.origin[:, k])
        by_force += lever[:, :, None] * arm[:, None]
        by_moment += lever[:, :, None] * case.axis(k)[:, None]
    return (
        noise.displacement**2 * np.eye(3)
        + noise.force**2 * by_force @ by_force.transpose(0, 2, 1)
        + noise.torque**2 * by_moment @ by_moment.transpose(0, 2, 1)
    )


def whitening(covariance: FloatArray, sight: FloatArray | None) -> tuple[FloatArray, FloatArray]:
    """Inverse Cholesky factors, shape (n, 3, 3), and the variance of a measured component, shape (n,).

    Args:
        covariance: Of each displacement, shape (n, 3, 3).
        sight: Unit vectors along which alone displacement was measured, shape (n, 3); None for all components.
    """
    if sight is None:
        return np.linalg.inv(np.linalg.cholesky(covariance)), np.trace(covariance, axis1=1, axis2=2) / 3.0
    variance = np.einsum("ni,nij,nj->n", sight, covariance, sight)
    whiten = np.zeros((len(sight), 3, 3))
    whiten[:, 0] = sight / np.sqrt(variance)[:, None]
    return whiten, variance


def trackers_of(members: Sequence[ElasticCause], theta: FloatArray) -> list[tuple[ElasticCause, FloatArray]]:
    """Causes in the tracker with their theta, shape (p,), as they act: a drift is added to what is reported."""
    found = [(cause, part) for cause, part in split(members, theta) if cause.stage == "tracker"]
    return sorted(found, key=lambda pair: pair[0].added_last)


def observed(
    members: Sequence[ElasticCause], theta: FloatArray, dt: FloatArray, displacement: FloatArray
) -> FloatArray:
    """A displacement as the tracker reports it.

    Args:
        members: Causes that act.
        theta: Their numbers in a row, shape (p,).
        dt: Time since each trial's reference, shape (n,) [s].
        displacement: What happened, shape (n, 3) [m].
    """
    for cause, part in trackers_of(members, theta):
        displacement = cause.observe(displacement, dt, part)
    return displacement


def carried(trackers: Sequence[tuple[ElasticCause, FloatArray]], slope: FloatArray) -> FloatArray:
    """A small displacement, or derivatives of one, shape (n, 3, p), as the tracker reports it."""
    for cause, part in trackers:
        still = np.zeros(len(slope))
        slope = np.stack([cause.observe(slope[:, :, i], still, part) for i in range(slope.shape[2])], axis=2)
    return slope
