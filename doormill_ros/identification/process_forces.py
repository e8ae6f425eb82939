"""Process forces: the mean wrench on the tool along each segment of a path (appendix A.16, table 4.8).

The log is rotated from sensor axes into flange axes, the spindle's weight comes off, and each segment's
samples are averaged. The thesis picked its four intervals by hand in sample numbers, 4500 to 5800, and let
neighbours share a sample; here a segment is a half-open time interval.

The thesis' table is in flange axes. Two things say where and how these lie:

* In the poses of table 4.6 the flange x axis points along base -y and the flange y axis along
  base -z. The spindle's weight is then on y, and y is the axis on which appendix A.16 plots
  -350 to -170 N, while the means of the table come without it.
* The moments are those of forces at the tip of the tool: Mx = -a Fy and My = a Fx hold with one
  arm a, 0.21 m, to within the rounding for the strongest segment. So the table speaks about the
  sensor, and the moment about the tool tip is what is left after `shift_wrench` with that arm.

The sign is taken as the wrench on the robot; the thesis does not state it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.frames import rotation_z
from doormill_ros.identification.errors import SegmentError
from doormill_ros.identification.payload import Payload
from doormill_ros.measurements.raw.force_sensor import MOUNTING_ROTATION, sensor_to_flange
from doormill_ros.measurements.raw.raw_files import Recording

#: Fewest samples of a segment that make a mean.
FEWEST_SAMPLES = 5
_BLOCKS = 10


@dataclass(frozen=True, eq=False)
class SegmentForce:
    """Mean process wrench of one path segment.

    Attributes:
        name: Name of the segment.
        wrench: Mean force on the tool and moment, flange axes, shape (6,) [N, N m].
        std: Standard deviation of the samples about it, shape (6,): how much the cut chatters.
        standard_error: Standard deviation of the mean, shape (6,), from means of ten blocks, so that a slow
            swing is not taken for many independent samples.
        samples: Number of samples.
    """

    name: str
    wrench: FloatArray
    std: FloatArray
    standard_error: FloatArray
    samples: int


def process_wrench(
    readings: FloatArray,
    rotation: float = MOUNTING_ROTATION,
    payload: Payload | None = None,
    R_base_flange: FloatArray | None = None,
) -> FloatArray:
    """Sensor readings as process wrench in flange axes.

    Args:
        readings: Sensor axes, shape (n, 6) [N, N m].
        rotation: Mounting angle from sensor axes to flange axes about the flange z [rad].
        payload: Weight and offset to remove; nothing is removed when None.
        R_base_flange: Orientation of the flange, shape (3, 3) or (n, 3, 3); needed with a payload.

    Returns:
        Shape (n, 6) [N, N m].

    Raises:
        SegmentError: A payload without the orientation.
    """
    readings = np.asarray(readings, dtype=float)
    if payload is not None:
        if R_base_flange is None:
            raise SegmentError(
                "the spindle weight can only be removed when the flange's orientation is known; give R_base_flange"
            )
        readings = payload.remove(readings, np.asarray(R_base_flange) @ rotation_z(rotation))
    return sensor_to_flange(readings, rotation)


def segment_forces(
    log: Recording,
    segments: Mapping[str, tuple[float, float]],
    rotation: float = MOUNTING_ROTATION,
    payload: Payload | None = None,
    R_base_flange: FloatArray | None = None,
    air: tuple[float, float] | None = None,
) -> list[SegmentForce]:
    """Mean wrench of every segment.

    Args:
        log: Force log, sensor axes.
        segments: Start and end of each segment [s since the start of the log]; the end is not in it.
        rotation: Mounting angle from sensor axes to flange axes about the flange z [rad].
        payload: Spindle weight and sensor offset to remove.
        R_base_flange: Orientation of the flange, shape (3, 3) or (n, 3, 3); needed with a payload.
        air: A window in which the tool turns in air in the same orientation; its mean is taken off, which
            removes weight and offset where the payload is unknown.

    Raises:
        SegmentError: An interval upside down, outside the log or with too few samples.
    """
    wrench = process_wrench(log.values, rotation, payload, R_base_flange)
    if air is not None:
        wrench = wrench - wrench[_rows(log, "air", air)].mean(axis=0)
    return [_segment(name, wrench[_rows(log, name, span)]) for name, span in segments.items()]


def lever_arm(wrenches: FloatArray) -> float:
    """Distance along z between a sensor and the point where pure forces explain its moments.

    Least squares over Mx = -a Fy and My = a Fx.

    Args:
        wrenches: Sensor readings, z along the tool, shape (n, 6) [N, N m].

    Returns:
        The arm a [m].
    """
    wrenches = np.asarray(wrenches, dtype=float)
    forces = np.concatenate([-wrenches[:, 1], wrenches[:, 0]])  # (2 n,)
    moments = np.concatenate([wrenches[:, 3], wrenches[:, 4]])
    return float(forces @ moments / (forces @ forces))


def _rows(log: Recording, name: str, span: tuple[float, float]) -> slice:
    start, end = span
    last = float(log.time[-1])
    if not 0.0 <= start < end:
        raise SegmentError(
            f"segment {name} runs from {start:g} s to {end:g} s, allowed is 0 <= start < end; correct the segment"
        )
    if start > last:
        raise SegmentError(
            f"segment {name} starts at {start:g} s, the log {log.path} ends at {last:g} s; correct it"
        )
    rows = slice(int(np.searchsorted(log.time, start)), int(np.searchsorted(log.time, end)))
    _enough(name, rows.stop - rows.start)
    return rows


def _enough(name: str, samples: int) -> None:
    if samples < FEWEST_SAMPLES:
        raise SegmentError(
            f"segment {name} holds {samples} samples, allowed are at least {FEWEST_SAMPLES}; widen it or log faster"
        )


def _segment(name: str, wrench: FloatArray) -> SegmentForce:
    n = len(wrench)
    std = wrench.std(axis=0, ddof=1)
    blocks = min(_BLOCKS, n // 2)
    means = np.array([block.mean(axis=0) for block in np.array_split(wrench, blocks)])
    error = np.maximum(means.std(axis=0, ddof=1) / np.sqrt(blocks), std / np.sqrt(n))
    return SegmentForce(name, wrench.mean(axis=0), std, error, n)
