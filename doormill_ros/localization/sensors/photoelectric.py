"""Six laser distance sensors: thesis section 3.7, figure 3.16; data sheet in appendix A.21."""

from __future__ import annotations

import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.cell.places.layout import CellLayout, load_layout
from doormill_ros.config import read
from doormill_ros.frames import apply
from doormill_ros.localization.sensors.errors import BadReading, BadSensorFile, BeamMissed
from doormill_ros.localization.sensors.faces import normals, ranges
from doormill_ros.localization.sensors.fit import Linearised, fit_pose
from doormill_ros.localization.sensors.freedom import ClampFreedom, load_freedom
from doormill_ros.localization.sensors.sensor import DoorPoseEstimate, ReadingKind
from doormill_ros.localization.sensors.spots import Spot
from doormill_ros.recipes.door import DoorSize
from doormill_ros.resources import resource
from doormill_ros.units import m_to_mm
from doormill_ros.values import Count, NotNegative, Positive, Section

FORM = "config/sensors/photoelectric.yaml"


@dataclass(frozen=True, eq=False)
class Photoelectric:
    """The six sensors as one door sensor; `reading` is their distances, shape (6,) [m], nan for nothing.

    Attributes:
        layout: Where the nominal door stands.
        freedom: What the clamp can hold.
        beams: The sensors.
        stand_off: Nominal distance [m].
        span: Smallest and largest distance [m].
        deviation: Standard deviation of a distance from all causes [m].
        seconds: Time of the averaged readings [s].
    """

    layout: CellLayout
    freedom: ClampFreedom
    beams: tuple[Spot, ...]
    stand_off: float
    span: tuple[float, float]
    deviation: float
    seconds: float
    name: str = "photoelectric"
    takes: ReadingKind = "distances"
    cannot_see: str = (
        "a chip, a chamfer or dust under a beam, since six readings for six unknowns leave no check; "
        "glossy paint; a door turned far"
    )

    def geometry(self, door: DoorSize) -> tuple[FloatArray, FloatArray]:
        """Where the beams start [m] and their directions in base, each shape (n, 3)."""
        T_base_door = self.layout.T_base_door(door.width, door.thickness)
        outward = normals(tuple(beam.face for beam in self.beams))
        spots = np.array([beam.place(door) for beam in self.beams])
        return apply(T_base_door, spots + self.stand_off * outward), -outward @ T_base_door[:3, :3].T

    def locate(self, reading: FloatArray, door: DoorSize) -> DoorPoseEstimate:
        """Pose of the door from the distances, shape (n,) [m].

        Raises:
            BadReading: Another number of distances.
            BeamMissed: A distance is missing or out of the sensor's range.
            PoseOutOfRange: The pose cannot be.
        """
        begun = time.perf_counter()
        reading = np.asarray(reading, dtype=float)
        if reading.shape != (len(self.beams),):
            raise BadReading(
                f"distances have shape {reading.shape}, allowed is ({len(self.beams)},); one for each beam"
            )
        low, high = self.span
        for i, value in enumerate(reading):
            if not low <= value <= high:
                raise BeamMissed(
                    f"distance sensor {i + 1} on the {self.beams[i].face} reads {m_to_mm(value):.3f} mm, "
                    f"allowed are {m_to_mm(low):g} to {m_to_mm(high):g} mm; clamp the door again",
                    beam=i + 1,
                )
        outward = normals(tuple(beam.face for beam in self.beams))
        origins, directions = self.geometry(door)
        variance = np.full(reading.size, self.deviation**2)

        def linearise(T_base_door: FloatArray) -> Linearised:
            length, derivative = ranges(T_base_door, outward, origins, directions)
            return Linearised(reading - length, derivative, variance)

        start = self.layout.T_base_door(door.width, door.thickness)
        fit = fit_pose(start, linearise, "distances")
        self.freedom.check(fit.T_base_door, np.sqrt(np.diag(fit.covariance)), self.layout, door)
        return DoorPoseEstimate(
            fit.T_base_door,
            fit.covariance,
            (True,) * 6,
            self.seconds + time.perf_counter() - begun,
            fit.chi_square,
            fit.redundancy,
        )


@dataclass(frozen=True)
class _Beam(Section):
    """Figures of one distance sensor [m, s]; see config/sensors/photoelectric.yaml."""

    range: tuple[Positive, Positive]
    resolution: NotNegative
    reading_time: NotNegative
    linearity: NotNegative
    noise: NotNegative


@dataclass(frozen=True)
class _SensorFile(Section):
    sensor: _Beam
    readings: Count
    surface: NotNegative
    mounting_deviation: NotNegative
    stand_off: Positive
    beams: tuple[Spot, ...]


def load_photoelectric(path: Path | None = None, layout: CellLayout | None = None) -> Photoelectric:
    """Read config/sensors/photoelectric.yaml, or another file of the same form.

    Raises:
        BadSensorFile: A key is missing or unknown, a value impossible or a beam looks at no known face.
    """
    layout = layout or load_layout()
    content = read(path or resource(FORM), _SensorFile, BadSensorFile, f"compare it with {FORM}")
    sensor, count = content.sensor, content.readings
    # Quantising is uniform over a step. It does not average out while the noise is below the
    # step. The characteristic's error is bounded and unknown: as a wave of that amplitude.
    variance = (
        sensor.resolution**2 / 12.0
        + sensor.linearity**2 / 2.0
        + sensor.noise**2 / count
        + content.surface**2
        + content.mounting_deviation**2
    )
    return Photoelectric(
        layout,
        load_freedom(layout),
        content.beams,
        content.stand_off,
        sensor.range,
        float(np.sqrt(variance)),
        count * sensor.reading_time,
    )
