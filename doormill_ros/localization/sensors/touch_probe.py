"""Touching the door with a switching probe in the robot's hand: thesis section 3.7."""

from __future__ import annotations

import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.cell.places.layout import CellLayout, load_layout
from doormill_ros.config import read
from doormill_ros.frames import apply
from doormill_ros.localization.sensors.errors import BadReading, BadSensorFile
from doormill_ros.localization.sensors.faces import heights, normals
from doormill_ros.localization.sensors.fit import Linearised, fit_pose
from doormill_ros.localization.sensors.freedom import ClampFreedom, load_freedom
from doormill_ros.localization.sensors.sensor import DoorPoseEstimate, ReadingKind
from doormill_ros.localization.sensors.spots import Spot
from doormill_ros.recipes.door import DoorSize
from doormill_ros.resources import resource
from doormill_ros.values import NotNegative, Positive, Section

FORM = "config/sensors/touch_probe.yaml"

_NEEDED = 6


@dataclass(frozen=True)
class ProbingMotion(Section):
    """How the robot moves between and at the points; see config/sensors/touch_probe.yaml [m, s]."""

    speed: Positive
    acceleration: Positive
    settle: NotNegative
    search_speed: Positive
    measure_speed: Positive
    back_off: NotNegative
    clearance: NotNegative
    clearance_known: NotNegative
    detour: NotNegative

    def travel(self, distance: float) -> float:
        """Time from rest to rest over a distance [m] with a trapezoidal speed profile [s]."""
        if distance * self.acceleration <= self.speed**2:
            return 2.0 * float(np.sqrt(distance / self.acceleration))
        return distance / self.speed + self.speed / self.acceleration

    def search(self, distance: float) -> float:
        """Time to find the face `distance` [m] ahead, fast, then back and once more slowly [s]."""
        fast = distance / self.search_speed
        return (
            fast + self.travel(self.back_off) + self.back_off / self.measure_speed + 2 * self.settle
        ) + self.travel(distance)  # and out again


@dataclass(frozen=True, eq=False)
class TouchProbe:
    """The probe as a door sensor; `reading` is where the robot says the ball's centre was, shape (n, 3) [m].

    The points are those of the file in its order; the first six give all degrees of freedom, more
    average and let a wrong one be noticed.

    Attributes:
        layout: Where the nominal door stands.
        freedom: What the clamp can hold.
        points: Where to touch.
        motion: How to get there.
        height: Of the ball's reported centre above the face when the probe switches [m].
        random: Standard deviation of a touch by itself [m].
        common: Standard deviation that all touches share [m].
        accuracy: Standard deviation of the robot's geometric error along an axis [m].
        correlation_length: Distance over which that error changes [m].
    """

    layout: CellLayout
    freedom: ClampFreedom
    points: tuple[Spot, ...]
    motion: ProbingMotion
    height: float
    random: float
    common: float
    accuracy: float
    correlation_length: float
    name: str = "touch_probe"
    takes: ReadingKind = "points"
    cannot_see: str = (
        "what lies between the points; with six points a chip under one of them; the robot's own "
        "geometric error, which cancels only where the same robot mills in the posture it probed in"
    )

    def locate(self, reading: FloatArray, door: DoorSize) -> DoorPoseEstimate:
        """Pose of the door from n touched points, shape (n, 3), n from 6 to the number in the file.

        Raises:
            BadReading: Another number of points.
            Contradiction: More than six points that do not lie on a door.
            PoseOutOfRange: The pose cannot be.
        """
        begun = time.perf_counter()
        reading = np.asarray(reading, dtype=float)
        if reading.ndim != 2 or reading.shape[1:] != (3,) or not np.all(np.isfinite(reading)):
            raise BadReading(f"touched points have shape {reading.shape}, allowed are finite (n, 3)")
        if not _NEEDED <= len(reading) <= len(self.points):
            raise BadReading(
                f"{len(reading)} points were touched, allowed are {_NEEDED} to {len(self.points)}; "
                "touch them in the order of the sensor's file"
            )
        outward = normals(tuple(spot.face for spot in self.points[: len(reading)]))

        def linearise(T_base_door: FloatArray) -> Linearised:
            height, derivative = heights(T_base_door, outward, reading)
            n = outward @ T_base_door[:3, :3].T
            return Linearised(self.height - height, derivative, self._covariance(reading, n))

        start = self.layout.T_base_door(door.width, door.thickness)
        fit = fit_pose(start, linearise, "touched points")
        self.freedom.check(fit.T_base_door, np.sqrt(np.diag(fit.covariance)), self.layout, door)
        return DoorPoseEstimate(
            fit.T_base_door,
            fit.covariance,
            (True,) * 6,
            self.probing_time(reading, door) + time.perf_counter() - begun,
            fit.chi_square,
            fit.redundancy,
        )

    def _covariance(self, points: FloatArray, n: FloatArray) -> FloatArray:
        """Of the heights of points (k, 3) over faces with normals n (k, 3), base; shape (k, k)."""
        apart = np.linalg.norm(points[:, None] - points[None], axis=2)
        alike = np.exp(-0.5 * (apart / self.correlation_length) ** 2)
        covariance: FloatArray = (
            self.accuracy**2 * alike * (n @ n.T)  # axes of the robot's error are independent
            + self.common**2
            + self.random**2 * np.eye(len(points))
        )
        return covariance

    def approach(self, door: DoorSize, count: int) -> FloatArray:
        """Where the search for each of the first `count` points begins, base [m], shape (count, 3)."""
        spots = self.points[:count]
        outward = normals(tuple(spot.face for spot in spots))
        clearance = np.where(np.arange(count) < _NEEDED, self.motion.clearance, self.motion.clearance_known)
        places = np.array([spot.place(door) for spot in spots]) + clearance[:, None] * outward
        return apply(self.layout.T_base_door(door.width, door.thickness), places)

    def probing_time(self, reading: FloatArray, door: DoorSize) -> float:
        """Time of the whole sequence that touched `reading` (n, 3) [s]."""
        starts = self.approach(door, len(reading))
        # A known door moves the start along; only the distance to the face counts then.
        ahead = np.linalg.norm(reading - starts, axis=1)
        ahead[_NEEDED:] = self.motion.clearance_known
        total = sum(self.motion.search(float(d)) for d in ahead)
        for i in range(1, len(starts)):
            detour = self.motion.detour * (self.points[i].face != self.points[i - 1].face)
            total += self.motion.travel(float(np.linalg.norm(starts[i] - starts[i - 1])) + detour)
        return total


@dataclass(frozen=True)
class _Probe(Section):
    """Figures of the probe [m, N]; see config/sensors/touch_probe.yaml."""

    radius: Positive
    radius_deviation: NotNegative
    repeatability: NotNegative
    pre_travel: NotNegative
    pre_travel_deviation: NotNegative
    trigger_force: NotNegative


@dataclass(frozen=True)
class _Robot(Section):
    """Figures of the robot that carries it [m, m/N]; see config/sensors/touch_probe.yaml."""

    repeatability: NotNegative
    accuracy: NotNegative
    correlation_length: Positive
    compliance: NotNegative


@dataclass(frozen=True)
class _SensorFile(Section):
    probe: _Probe
    robot: _Robot
    surface: NotNegative
    motion: ProbingMotion
    points: tuple[Spot, ...]
    more_points: tuple[Spot, ...]


def load_touch_probe(path: Path | None = None, layout: CellLayout | None = None) -> TouchProbe:
    """Read config/sensors/touch_probe.yaml, or another file of the same form.

    Raises:
        BadSensorFile: A key is missing or unknown, a value impossible or a point lies on no known face.
    """
    layout = layout or load_layout()
    content = read(path or resource(FORM), _SensorFile, BadSensorFile, f"compare it with {FORM}")
    probe, robot = content.probe, content.robot
    # The robot gives way under the probe by at most this, at least a third of it: take two thirds.
    yields = robot.compliance * probe.trigger_force
    return TouchProbe(
        layout=layout,
        freedom=load_freedom(layout),
        points=content.points + content.more_points,
        motion=content.motion,
        height=probe.radius - probe.pre_travel - 2.0 / 3.0 * yields,
        random=float(np.sqrt(probe.repeatability**2 + robot.repeatability**2 + content.surface**2)),
        common=float(np.sqrt(probe.radius_deviation**2 + probe.pre_travel_deviation**2 + yields**2 / 27.0)),
        accuracy=robot.accuracy,
        correlation_length=robot.correlation_length,
    )
