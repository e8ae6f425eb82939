"""Shapes that belong to no known cause: where one of them explains more, a name would be wrong."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.robot_model.motion.causes.cause import MotionCause
from doormill_ros.robot_model.motion.view import JointMotion, SeenMotion
from doormill_ros.statistics import root_mean_square

_BOTH_WAYS = 0.01  #: share of the samples with the rarer sign from which on both are seen


class MotionPattern(MotionCause):
    """A shape over a recording that may enter a model and is never named.

    Attributes:
        driver: What drives it, in one of the words that diagnosis.json has for that.
        spoken, unit: The same more closely, and its unit.
        size: Its root mean square in the data, in that unit; the shape itself has size 1.
    """

    name = "pattern"
    named = False

    def __init__(
        self, where: str, driver: str, spoken: str, unit: str, shapes: dict[int, FloatArray]
    ) -> None:
        """Keep the shape of each recording, by the identity of its motion, in its unit."""
        super().__init__(where)
        self.driver, self.spoken, self.unit = driver, spoken, unit
        self.size = max(root_mean_square(np.concatenate(list(shapes.values()))), 1e-12)
        self._shapes = {key: shape / self.size for key, shape in shapes.items()}

    @property
    def slot(self) -> tuple[str, ...]:
        """One for each driver."""
        return (self.name, self.where, self.spoken)

    def columns(self, seen: SeenMotion) -> FloatArray:
        """The shape, shape (n, 1)."""
        return self._shapes[id(seen.motion)][:, None]

    def values(self, x: FloatArray, stiffness: float) -> dict[str, tuple[float, str]]:
        """Its height."""
        return {"height": (float(x[0]), "rad")}

    def pattern(self) -> str:
        """What it leaves."""
        return f"the difference of the encoders follows {self.spoken}"

    def spoils(self, cause: MotionCause) -> bool:
        """Whether it shapes the same thing as a cause: one law of the torque, or of the speed."""
        return self.driver in cause.follows

    def __repr__(self) -> str:
        return f"what follows {self.spoken} at {self.where}"


def _one_way(parts: Sequence[FloatArray]) -> bool:
    """Whether nearly all of some values, shape (n,) each, have one sign."""
    positive = float(np.mean(np.concatenate(parts) > 0.0))
    return min(positive, 1.0 - positive) < _BOTH_WAYS


def unnamed_patterns(index: int, recordings: Sequence[Sequence[JointMotion]]) -> list[MotionPattern]:
    """Shapes for one joint, by its index, of recordings that hold all joints."""
    own = [recording[index] for recording in recordings]
    where = f"joint {own[0].joint}"
    speed = [motion.seen().speed for motion in own]
    shapes: list[tuple[str, str, str, list[FloatArray]]] = [
        ("time", "the time", "s", [motion.time - motion.time.mean() for motion in own]),
        ("torque sign", "the size of its torque", "N m", [np.abs(motion.torque) for motion in own]),
        (
            "own torque",
            "the square of its torque with its sign",
            "(N m)^2",
            [motion.torque * np.abs(motion.torque) for motion in own],
        ),
        ("speed (its change)", "its acceleration", "rad/s^2", [motion.seen().acceleration for motion in own]),
        ("speed", "the size of its speed", "rad/s", [np.abs(one) for one in speed]),
        ("speed", "the square of its speed with its sign", "(rad/s)^2", [one * np.abs(one) for one in speed]),
    ]
    # Where a joint's torque or speed hardly ever changes its sign its size is the same in other words.
    one_way = [
        words
        for words, parts in (("torque", [motion.torque for motion in own]), ("speed", speed))
        if _one_way(parts)
    ]
    shapes = [shape for shape in shapes if shape[1] not in [f"the size of its {words}" for words in one_way]]
    for other, motion in enumerate(recordings[0]):
        if other != index:
            others = [recording[other] for recording in recordings]
            k = motion.joint
            shapes += [
                (f"angle of joint {k}", f"the angle of joint {k}", "rad", [one.motor for one in others]),
                (f"torque of joint {k}", f"the torque of joint {k}", "N m", [one.torque for one in others]),
                ("speed", f"the speed of joint {k}", "rad/s", [one.seen().speed for one in others]),
            ]
    return [
        MotionPattern(
            where, driver, words, unit, {id(motion): part for motion, part in zip(own, parts, strict=True)}
        )
        for driver, words, unit, parts in shapes
    ]
