"""One joint in motion, as the causes look at it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from scipy.interpolate import CubicSpline

from doormill_ros.arrays import BoolArray, FloatArray

#: Length over which the motor's angle is smoothed before it is derived [s]: drives follow their command to some 20 Hz.
_SMOOTHED = 0.02
_BESIDE = np.linspace(-_SMOOTHED, _SMOOTHED, 9)
_CURVED = _BESIDE**2 - np.mean(_BESIDE**2)
#: Moments beside one [s], and weights of the angle there in the second derivative of a parabola through all [1 / s^2].
_PARABOLA = (_BESIDE, 2.0 * _CURVED / np.sum(_CURVED**2))
#: Moments beside one [s], and weights of the torque there in the slope of a line through all [1 / s]: narrower than a
#: parabola's, for a torque shakes as fast as the link swings behind its gear.
_NEAR = _BESIDE / 2.0
_SLOPE = (_NEAR, _NEAR / np.sum(_NEAR**2))
_ASIDE = (-4, -3, -2, 2, 3, 4)  #: samples beside one of which a mean holds none of its noise
_DIGITS = 8  #: decimals of a delay [s] that count


@dataclass(frozen=True, eq=False)
class JointMotion:
    """What was recorded of one joint in one recording.

    Attributes:
        joint: Number, 1 to 6.
        time: Shape (n,) [s], ascending; samples may be missing.
        motor: Motor encoder over the gear ratio, shape (n,) [rad].
        link: Encoder behind the gear, shape (n,) [rad].
        torque: Motor torque times the gear ratio, shape (n,) [N m].
        torque_noise: Standard deviation of the noise that a filter left in it [N m]; None where none was needed.
        gear_ratio: Turns of the motor for one of the joint.
        stiffness: Of the model in question [N m / rad].
        motor_inertia: Of the motor in the model in question [kg m^2]; None where that knows none.
    """

    joint: int
    time: FloatArray
    motor: FloatArray
    link: FloatArray
    torque: FloatArray
    gear_ratio: float
    stiffness: float
    torque_noise: float | None = None
    motor_inertia: float | None = None

    def __len__(self) -> int:
        return len(self.time)

    @cached_property
    def path(self) -> CubicSpline:
        """The motor's angle over time."""
        return CubicSpline(self.time, self.motor)

    def seen(self, delay: float = 0.0) -> SeenMotion:
        """The joint as a link encoder sees it that is read late by a delay [s]."""
        return _seen(self, round(delay, _DIGITS))


@dataclass(frozen=True, eq=False)
class SeenMotion:
    """A joint a little earlier than its samples say.

    Attributes:
        motion: The recording.
        delay: How much earlier [s].
        motor, speed, acceleration: Of the motor's angle, shape (n,) [rad], [rad / s], [rad / s^2].
        torque: Shape (n,) [N m].
        recorded: Samples of which the recording holds the moment that is seen, shape (n,); others have its end.
    """

    motion: JointMotion
    delay: float
    motor: FloatArray
    speed: FloatArray
    acceleration: FloatArray
    torque: FloatArray
    recorded: BoolArray

    def __len__(self) -> int:
        return len(self.motor)

    @property
    def time(self) -> FloatArray:
        """Shape (n,) [s]."""
        return self.motion.time

    @cached_property
    def predicted(self) -> FloatArray:
        """Difference of the encoders that the model in question predicts, shape (n,) [rad]."""
        return self.motor - self.motion.motor - self.torque / self.motion.stiffness

    @cached_property
    def torque_rate(self) -> FloatArray:
        """How the torque grows, shape (n,) [N m / s]."""
        motion = self.motion
        time = np.clip(self.time - self.delay, motion.time[0] - _SLOPE[0][0], motion.time[-1] - _SLOPE[0][-1])
        parts = [
            weight * np.interp(time + side, motion.time, motion.torque)
            for side, weight in zip(*_SLOPE, strict=True)
        ]
        return np.asarray(np.sum(parts, axis=0), dtype=float)

    def torque_beside(self, later: float = 0.0) -> FloatArray:
        """Mean torque of samples on either side of moments later by a time [s], less the nearest, shape (n,) [N m]."""
        motion = self.motion
        period = float(np.median(np.diff(motion.time)))
        moments = [self.time - self.delay + later + k * period for k in _ASIDE]
        return np.asarray(
            np.mean([np.interp(at, motion.time, motion.torque) for at in moments], axis=0), dtype=float
        )

    def slip(self, width: float, start: float) -> FloatArray:
        """State of bristles that bend for a width [rad] before they slide, from -1 to 1, shape (n,).

        Prandtl's element: it follows the motor until it is bent to its end, and remembers where it turned.

        Args:
            width: Half of the way from end to end.
            start: State at the first sample.
        """
        return _slip(self, width, start)

    @property
    def moving(self) -> BoolArray:
        """Whether the joint moves, shape (n,)."""
        return np.abs(self.speed) > 1e-3


def followed(time: FloatArray, values: FloatArray, settles: float) -> FloatArray:
    """What follows values with a time constant [s] where they run straight between times [s], each of shape (n,)."""
    wait = np.maximum(np.diff(time), 1e-9) / settles
    stays = np.exp(-wait)
    mean = (1.0 - stays) / wait
    fed = (mean - stays) * values[:-1] + (1.0 - mean) * values[1:]
    late = float(values[0])
    found = [late]
    for share, new in zip(stays.tolist(), fed.tolist(), strict=True):
        late = share * late + new
        found.append(late)
    return np.array(found)


@lru_cache(maxsize=256)
def _seen(motion: JointMotion, delay: float) -> SeenMotion:
    asked = motion.time - delay
    # A cubic carried on beyond its ends multiplies noise: a joint that moved there says nothing of these samples.
    time = np.clip(asked, motion.time[0], motion.time[-1])
    half = _SMOOTHED / 2.0
    before, after = (np.clip(time + side, motion.time[0], motion.time[-1]) for side in (-half, half))
    here = motion.path(time)
    speed = (motion.path(after) - motion.path(before)) / np.maximum(after - before, 1e-9)
    # A parabola's over twice the length, about the next moment that has so much on either side: noise shows less in it.
    whole = np.clip(time, motion.time[0] + _SMOOTHED, motion.time[-1] - _SMOOTHED)
    acceleration = np.sum(
        [weight * motion.path(whole + side) for side, weight in zip(*_PARABOLA, strict=True)], axis=0
    )
    torque = np.interp(time, motion.time, motion.torque)
    return SeenMotion(motion, delay, here, speed, acceleration, torque, time == asked)


@lru_cache(maxsize=1024)
def _slip(seen: SeenMotion, width: float, start: float) -> FloatArray:
    steps = (np.diff(seen.motor) / width).tolist()
    states, state = [start], start
    for step in steps:
        state = min(max(state + step, -1.0), 1.0)
        states.append(state)
    return np.array(states)
