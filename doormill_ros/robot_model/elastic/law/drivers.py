"""What can drive an effect, read from a loading: one line a driver.

The names are those of diagnosis.json; brackets tell two readings of one driver apart. A value that nobody knows is NaN.
"""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.robot_model.elastic.law.cracks import OPENING
from doormill_ros.robot_model.elastic.law.memory import FRICTIONS
from doormill_ros.robot_model.elastic.load_case import LoadCase
from doormill_ros.robot_model.law.parts import Driver, Drivers


def _known(values: FloatArray | None, case: LoadCase) -> FloatArray:
    return np.full(len(case), np.nan) if values is None else np.asarray(values, dtype=float)


def _along(case: LoadCase, k: int) -> FloatArray:
    """+1 where the joint last moved as the load turns it, -1 where against it, 0 unknown."""
    result: FloatArray = np.sign(case.direction[:, k]) * np.sign(case.torque[:, k])
    return result


_JOINT: dict[str, Driver[LoadCase]] = {
    "angle": Driver(lambda case, k: case.q[:, k], "rad", True),
    "torque": Driver(lambda case, k: case.torque[:, k], "N m", True),
}
DRIVERS: Drivers[LoadCase] = Drivers(
    named={
        "constant": Driver(lambda case, k: np.ones(len(case)), "", True),
        "own angle": _JOINT["angle"],
        "own torque": _JOINT["torque"],
        "torque sign": Driver(lambda case, k: np.sign(case.torque[:, k]), "", True),
        "direction": Driver(_along, "", True),
        "direction (sense)": Driver(lambda case, k: np.sign(case.direction[:, k]), "", True),
        "direction (torque along it)": Driver(
            lambda case, k: np.maximum(case.direction[:, k] * case.torque[:, k], 0.0), "N m", True
        ),
        "direction (torque against it)": Driver(
            lambda case, k: np.maximum(-case.direction[:, k] * case.torque[:, k], 0.0), "N m", True
        ),
        "time": Driver(lambda case, k: _known(case.circumstances.time, case), "s", False),
        "time under load": Driver(lambda case, k: _known(case.circumstances.dt, case), "s", False),
        "temperature": Driver(lambda case, k: _known(case.circumstances.temperature, case), "deg C", False),
        "wrench": Driver(lambda case, k: np.linalg.norm(case.force, axis=1), "N", True),
        **{one.driver: Driver(one.moment, "N m", True) for one in OPENING.values()},
        **{driver: Driver(friction.share, "", True) for driver, friction in FRICTIONS.items()},
    },
    of_joint=_JOINT,
)
