"""What can drive an effect, read from a loading: one line a driver.

The names are those of diagnosis.json. A value that nobody knows is NaN.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.robot_model.elastic.load_case import LoadCase

#: Of a loading and the joint at which the effect acts, 0 ... 5 (-1: no joint), or that is spoken of: shape (n,).
Reading = Callable[[LoadCase, int], FloatArray]


@dataclass(frozen=True)
class Driver:
    """Something that an effect may hang on.

    Attributes:
        reading: Its value in each loading.
        unit: SI.
        of_path: Whether a milling path knows it.
    """

    reading: Reading
    unit: str
    of_path: bool


def _known(values: FloatArray | None, case: LoadCase) -> FloatArray:
    return np.full(len(case), np.nan) if values is None else np.asarray(values, dtype=float)


def _along(case: LoadCase, k: int) -> FloatArray:
    """+1 where the joint last moved as the load turns it, -1 where against it, 0 unknown."""
    result: FloatArray = np.sign(case.direction[:, k]) * np.sign(case.torque[:, k])
    return result


_JOINT: dict[str, Driver] = {
    "angle": Driver(lambda case, k: case.q[:, k], "rad", True),
    "torque": Driver(lambda case, k: case.torque[:, k], "N m", True),
}
#: Drivers by their names, but for those that name another joint.
DRIVERS: dict[str, Driver] = {
    "constant": Driver(lambda case, k: np.ones(len(case)), "", True),
    "own angle": _JOINT["angle"],
    "own torque": _JOINT["torque"],
    "torque sign": Driver(lambda case, k: np.sign(case.torque[:, k]), "", True),
    "direction": Driver(_along, "", True),
    "time": Driver(lambda case, k: _known(case.circumstances.time, case), "s", False),
    "time under load": Driver(lambda case, k: _known(case.circumstances.dt, case), "s", False),
    "temperature": Driver(lambda case, k: _known(case.circumstances.temperature, case), "deg C", False),
    "wrench": Driver(lambda case, k: np.linalg.norm(case.force, axis=1), "N", True),
}


def driver(name: str) -> Driver:
    """A driver by its name.

    Raises:
        KeyError: There is none of that name.
    """
    kind, _, joint = name.partition(" of joint ")
    return _JOINT[kind] if joint else DRIVERS[name]


def reading(name: str, case: LoadCase, joint: int) -> FloatArray:
    """Value of a driver in each loading for an effect at a joint (0 ... 5, -1 for none), shape (n,)."""
    _, _, other = name.partition(" of joint ")
    return driver(name).reading(case, int(other) - 1 if other else joint)
