"""Weight of the spindle in the readings of a force sensor behind it, and its removal.

The spindle hangs on the sensor: in every posture the sensor reads gravity in its own axes, plus a
constant offset of its electronics. The thesis' figure 4.6 still holds that weight. With at least three
postures that are not all alike, mass, centre of gravity and offset follow by linear least squares:

    F = m R^T g + F_0,    M = c x (m R^T g) + M_0

with R = R_base_sensor and the gravity g = (0, 0, -9.80665) m/s^2.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.identification.errors import PayloadError
from doormill_ros.units import GRAVITY

#: Largest condition number of the scaled equations that still tells weight from offset.
_WORST_CONDITION = 1e4


@dataclass(frozen=True, eq=False)
class Payload:
    """What hangs on a force sensor.

    Attributes:
        mass: Mass in front of the sensor [kg].
        centre: Its centre of gravity, sensor axes, from the sensor's origin, shape (3,) [m].
        offset: Reading of the unloaded sensor, shape (6,) [N, N m].
    """

    mass: float
    centre: FloatArray
    offset: FloatArray

    def wrench(self, R_base_sensor: FloatArray) -> FloatArray:
        """What the sensor reads at rest, sensor axes, shape (..., 6) [N, N m].

        Args:
            R_base_sensor: Orientation of the sensor, base z up, shape (..., 3, 3).
        """
        weight = self.mass * _gravity_in_sensor(R_base_sensor)
        moment = np.cross(self.centre, weight)
        return np.concatenate([weight, moment], axis=-1) + self.offset

    def remove(self, readings: FloatArray, R_base_sensor: FloatArray) -> FloatArray:
        """Readings without weight and offset: the process wrench, sensor axes, shape (..., 6)."""
        return np.asarray(readings, dtype=float) - self.wrench(R_base_sensor)


def identify_payload(readings: FloatArray, R_base_sensor: FloatArray) -> Payload:
    """Mass, centre of gravity and offset from readings at rest in several postures.

    Args:
        readings: Sensor readings at rest, sensor axes, shape (n, 6) [N, N m].
        R_base_sensor: Orientation of the sensor at each, shape (n, 3, 3).

    Raises:
        PayloadError: Too few or too similar postures, or no mass.
    """
    readings = np.asarray(readings, dtype=float)
    R_base_sensor = np.asarray(R_base_sensor, dtype=float)
    n = len(readings)
    if readings.shape != (n, 6) or R_base_sensor.shape != (n, 3, 3) or n < 3:
        raise PayloadError(
            f"readings have shape {readings.shape} and orientations {R_base_sensor.shape}, allowed are (n, 6) and "
            "(n, 3, 3) with n >= 3; hold the spindle still in at least three orientations"
        )
    gravity = _gravity_in_sensor(R_base_sensor)  # (n, 3)
    eye = np.tile(np.eye(3), (n, 1))  # (3n, 3)
    force_design = np.hstack([gravity.reshape(-1, 1), eye])  # mass, force offset
    mass, *force_offset = _solve(force_design, readings[:, :3].reshape(-1))
    if mass <= 0.0:
        raise PayloadError(
            f"the readings give a mass of {mass:.2f} kg; turn the sensor axes the right way round (base z is up)"
        )
    # M = c x w + M0 = -[w]_x c + M0.
    weight = mass * gravity
    skew = np.zeros((n, 3, 3))
    skew[:, 0, 1], skew[:, 0, 2], skew[:, 1, 2] = -weight[:, 2], weight[:, 1], -weight[:, 0]
    skew -= skew.transpose(0, 2, 1)
    moment_design = np.hstack([-skew.reshape(-1, 3), eye])
    solution = _solve(moment_design, readings[:, 3:].reshape(-1))
    return Payload(float(mass), solution[:3], np.concatenate([force_offset, solution[3:]]))


def _gravity_in_sensor(R_base_sensor: FloatArray) -> FloatArray:
    """Gravity written in sensor axes, shape (..., 3) [m/s^2]: minus g times the third row of R."""
    up: FloatArray = np.asarray(R_base_sensor, dtype=float)[..., 2, :]
    return -GRAVITY * up


def _solve(design: FloatArray, target: FloatArray) -> FloatArray:
    scale = np.linalg.norm(design, axis=0)
    if np.any(scale == 0.0) or np.linalg.cond(design / scale) > _WORST_CONDITION:
        raise PayloadError(
            "the postures are too much alike to tell weight from offset; tilt the spindle by tens of degrees "
            "about two axes between them"
        )
    solution: FloatArray = np.linalg.lstsq(design / scale, target, rcond=None)[0]
    solution /= scale
    return solution
