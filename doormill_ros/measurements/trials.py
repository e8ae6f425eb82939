"""Static loadings of a robot: what was commanded, how it was loaded and how far it gave way."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from doormill_ros.arrays import FloatArray, IntArray

#: Commanded angles closer than this belong to one configuration [rad].
SAME_ANGLE = 1e-5


@dataclass(frozen=True)
class Reflector:
    """A target on the robot: its link (0 is the base) and position in the link's DH frame, shape (3,) [m]."""

    link: int
    position: FloatArray


@dataclass(frozen=True)
class Noise:
    """Standard deviation of one recorded value, per axis: displacement [m], force [N], torque [N m]."""

    displacement: float
    force: float
    torque: float


@dataclass(frozen=True, eq=False)
class Trials:
    """Static loadings of one robot, wherever they come from; arrays are read-only, one trial a row.

    Attributes:
        robot: Name of the robot.
        dh: Its Denavit-Hartenberg table, shape (6, 4).
        joint_stiffness: Springs of the model in question, shape (6,) [N m / rad].
        noise: Standard deviations of the recorded values.
        wrench_frame_rotation: Rotation about flange z from sensor axes to flange axes [rad].
        load_point: Where the wrench acts, flange frame, shape (3,) [m].
        reflectors: By name.
        trial: Trial numbers, shape (n,).
        time: Time of the loaded measurement, shape (n,) [s].
        dt: Time between unloaded and loaded measurement, shape (n,) [s].
        temperature: Air temperature, shape (n,) [deg C], NaN where not recorded.
        q: Commanded joint angles, shape (n, 6) [rad].
        direction: Last motion of each joint, -1, 0 (unknown) or +1, shape (n, 6).
        wrench: Wrench on the robot at the load point, sensor axes, shape (n, 6) [N, N m].
        reflector: Name of the measured reflector, shape (n,).
        displacement: Loaded minus unloaded position, base frame, shape (n, 3) [m].
    """

    robot: str
    dh: FloatArray
    joint_stiffness: FloatArray
    noise: Noise
    wrench_frame_rotation: float
    load_point: FloatArray
    reflectors: dict[str, Reflector]
    trial: IntArray
    time: FloatArray
    dt: FloatArray
    temperature: FloatArray
    q: FloatArray
    direction: FloatArray
    wrench: FloatArray
    reflector: FloatArray
    displacement: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        for value in vars(self).values():
            if isinstance(value, np.ndarray):
                value.setflags(write=False)

    def __len__(self) -> int:
        return len(self.trial)

    @property
    def configuration(self) -> IntArray:
        """Number of the posture of each trial, shape (n,), counted in order of appearance."""
        seen: list[FloatArray] = []
        numbers = np.zeros(len(self), dtype=int)
        for row, q in enumerate(self.q):
            # Not by rounded angles: typed ones like to lie on the border between two.
            same = np.flatnonzero(np.all(np.abs(np.array(seen).reshape(-1, 6) - q) < SAME_ANGLE, axis=1))
            if not len(same):
                seen.append(q)
            numbers[row] = same[0] if len(same) else len(seen) - 1
        return numbers

    @property
    def reflector_link(self) -> IntArray:
        """Link of each trial's reflector, shape (n,)."""
        return np.array([self.reflectors[name].link for name in self.reflector])

    @property
    def reflector_position(self) -> FloatArray:
        """Position of each trial's reflector in its link's frame, shape (n, 3) [m]."""
        return np.array([self.reflectors[name].position for name in self.reflector])
