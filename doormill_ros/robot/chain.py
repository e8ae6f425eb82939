"""Kinematics of many configurations at once: arrays with the configurations last.

Each number of the result is a contiguous row over all configurations, so that every numpy call
is one pass over memory. `Kinematics` wraps this in the usual shapes.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass, field

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.robot.denavit_hartenberg import ALPHA, THETA_OFFSET, A, D

JOINTS = 6
KEPT = 4  #: sets of postures whose frames are kept, and Jacobians of each
MOST_KEPT = 4096  #: postures of a set that is kept


@dataclass(frozen=True, eq=False)
class ChainFrames:
    """Denavit-Hartenberg frames 0..6 of n configurations, base axes.

    Attributes:
        x: Unit x axes, shape (7, 3, n).
        y: Unit y axes, shape (7, 3, n).
        z: Unit z axes, shape (7, 3, n); z[j] is the axis of joint j + 1.
        origin: Origins, shape (7, 3, n) [m].
        jacobians: Those that `Kinematics` was asked for of kept frames, by link and point.
    """

    x: FloatArray
    y: FloatArray
    z: FloatArray
    origin: FloatArray
    jacobians: dict[tuple[int, bytes], FloatArray] = field(default_factory=dict)

    def point(self, link: int, position: FloatArray) -> FloatArray:
        """Base coordinates, shape (3, n) [m], of a point of a link's frame, shape (3,) [m]."""
        result: FloatArray = self.origin[link]
        for axis, coordinate in zip((self.x, self.y, self.z), position, strict=True):
            if coordinate != 0.0:
                result = result + coordinate * axis[link]
        return result


_Key = tuple[bytes, bytes]
_kept: tuple[tuple[_Key, ChainFrames], ...] = ()


def chain_frames(
    dh: FloatArray, q: FloatArray, sin_cos: tuple[FloatArray, FloatArray] | None = None
) -> ChainFrames:
    """Frames of every link (thesis eq. 2.1).

    The last ones are kept, for poses, Jacobians and deflections are asked of the same postures one after another.

    Args:
        dh: Denavit-Hartenberg table, shape (6, 4).
        q: Joint angles, configurations last, shape (6, n) [rad].
        sin_cos: Sine and cosine of q where they are known, each shape (6, n).

    Returns:
        Arrays that are locked, as others may be given the same.
    """
    global _kept
    if q.shape[1] > MOST_KEPT:
        return _frames(dh, q, sin_cos)
    key = (dh.tobytes(), q.tobytes())
    for known, frames in _kept:
        if known == key:
            return frames
    frames = _frames(dh, q, sin_cos)
    _kept = ((key, frames), *_kept[: KEPT - 1])
    return frames


def _frames(dh: FloatArray, q: FloatArray, sin_cos: tuple[FloatArray, FloatArray] | None) -> ChainFrames:
    n = q.shape[1]
    x, y, z, origin = (np.empty((JOINTS + 1, 3, n)) for _ in range(4))
    for array, start in ((x, (1.0, 0.0, 0.0)), (y, (0.0, 1.0, 0.0)), (z, (0.0, 0.0, 1.0))):
        array[0] = np.array(start)[:, None]
    origin[0] = 0.0
    part, across = np.empty((3, n)), np.empty((3, n))
    sin_q, cos_q = (np.sin(q), np.cos(q)) if sin_cos is None else sin_cos
    for joint, row in enumerate(dh):
        s, c = _turned(sin_q[joint], cos_q[joint], row[THETA_OFFSET])
        before, after = joint, joint + 1
        np.multiply(x[before], c, out=x[after])
        np.multiply(y[before], s, out=part)
        x[after] += part
        np.multiply(y[before], c, out=across)
        np.multiply(x[before], s, out=part)
        across -= part
        sin_alpha, cos_alpha = _exact_sin_cos(row[ALPHA])
        if sin_alpha == 0.0:
            np.multiply(across, cos_alpha, out=y[after])
            np.multiply(z[before], cos_alpha, out=z[after])
        elif cos_alpha == 0.0:
            np.multiply(z[before], sin_alpha, out=y[after])
            np.multiply(across, -sin_alpha, out=z[after])
        else:
            y[after] = cos_alpha * across + sin_alpha * z[before]
            z[after] = cos_alpha * z[before] - sin_alpha * across
        origin[after] = origin[before]
        if row[D] != 0.0:
            np.multiply(z[before], row[D], out=part)
            origin[after] += part
        if row[A] != 0.0:
            np.multiply(x[after], row[A], out=part)
            origin[after] += part
    for array in (x, y, z, origin):
        array.setflags(write=False)
    return ChainFrames(x, y, z, origin)


def jacobian_columns(frames: ChainFrames, point: FloatArray, link: int = JOINTS) -> FloatArray:
    """Translational Jacobian of a point (thesis eq. 2.29, upper half).

    Args:
        frames: Frames of n configurations.
        point: Base coordinates of the point, shape (3, n) [m].
        link: Moving link that carries it; joints behind it do not move it.

    Returns:
        Velocity of the point per joint velocity, joints first, shape (6, 3, n) [m/rad]. The
        rotational half is `frames.z[:6]`, zero for joints behind `link`.
    """
    columns = np.zeros((JOINTS, *point.shape))
    cross(frames.z[:link], point - frames.origin[:link], out=columns[:link])
    return columns


def cross(a: FloatArray, b: FloatArray, out: FloatArray | None = None) -> FloatArray:
    """Vector product along the last but one axis; shapes (..., 3, n), broadcast."""
    if out is None:
        out = np.empty(np.broadcast_shapes(a.shape, b.shape))
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        np.multiply(a[..., j, :], b[..., k, :], out=out[..., i, :])
        out[..., i, :] -= a[..., k, :] * b[..., j, :]
    return out


def dot(a: FloatArray, b: FloatArray) -> FloatArray:
    """Scalar product along the last but one axis; shapes (..., 3, n) to (..., n)."""
    result = a[..., 0, :] * b[..., 0, :]
    result += a[..., 1, :] * b[..., 1, :]
    result += a[..., 2, :] * b[..., 2, :]
    return result


def _turned(sin_q: FloatArray, cos_q: FloatArray, offset: float) -> tuple[FloatArray, FloatArray]:
    """Sine and cosine of q + offset, exact when the offset is whole quarter turns."""
    s, c = _exact_sin_cos(offset)
    if s == 0.0:
        return sin_q * c, cos_q * c
    if c == 0.0:
        return cos_q * s, -sin_q * s
    return sin_q * c + cos_q * s, cos_q * c - sin_q * s


@functools.lru_cache(maxsize=128)  # of a robot's table, which is asked for with every set of postures
def _exact_sin_cos(angle: float) -> tuple[float, float]:
    quarter = round(angle / (np.pi / 2))
    if angle == quarter * (np.pi / 2):
        return (0.0, 1.0, 0.0, -1.0)[quarter % 4], (1.0, 0.0, -1.0, 0.0)[quarter % 4]
    return float(np.sin(angle)), float(np.cos(angle))
