"""What effects in inspected doors look at: loads and geometry where each point was cut, its normal, and its door."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from doormill_ros.arrays import BoolArray, FloatArray
from doormill_ros.frames import rotate_wrench, rotation_from_vector
from doormill_ros.robot_model.elastic.load_case import LoadCase


@dataclass(frozen=True, eq=False)
class CutCase:
    """n points of inspected doors.

    Attributes:
        load: Loads and geometry of the robot where each was cut.
        normal: Unit normals into the wood, base axes, shape (n, 3).
        wall: Which points lie on a wall, the others on a floor; shape (n,).
        kind: Kind of the feature of each point, shape (n,).
        time: When the door of each point was measured [s since the epoch], shape (n,).
        eye: Where the camera stood that saw the door of each point, base frame, shape (n, 3) [m].
        tip: The tool's tip, flange frame, shape (3,) [m].
        cache: Columns that have been asked for.
    """

    load: LoadCase
    normal: FloatArray
    wall: BoolArray
    kind: np.ndarray[tuple[int], np.dtype[np.str_]]
    time: FloatArray
    eye: FloatArray
    tip: FloatArray
    cache: dict[object, FloatArray] = field(default_factory=dict)

    def __len__(self) -> int:
        return len(self.normal)

    def along(self, displacement: FloatArray) -> FloatArray:
        """What displacements, shape (n, 3) or (n, 3, p), are along the normals, shape (n,) or (n, p)."""
        result: FloatArray = np.einsum("ni,ni...->n...", self.normal, displacement)
        return result

    def springs(self) -> FloatArray:
        """What the linear joint springs move each point along its normal, shape (n,) [m]."""
        return self.along(self.load.springs()[:, :3])

    def felt(self, gain: FloatArray, angle: FloatArray) -> CutCase:
        """The same under wrenches times `gain`, turned about the tool by `angle` [rad], shape (n,) each."""
        load = self.load
        couple = load.moment[:, 6] - np.cross(self._tip - load.origin[:, 6], load.force)
        R = rotation_from_vector(angle[:, None] * load.axes[:, 6, :, 2])
        wrench = gain[:, None] * rotate_wrench(R, np.concatenate([load.force, couple], axis=1))
        force, couple = wrench[:, :3], wrench[:, 3:]
        moment = couple[:, None] + np.cross(self._tip[:, None] - load.origin, force[:, None])
        torque = np.einsum("nki,nki->nk", load.axes[:, :6, :, 2], moment[:, :6])
        kept: dict[object, FloatArray] = {
            key: value for key, value in load.cache.items() if isinstance(key, tuple) and key[0] == "joint"
        }
        return replace(
            self, load=replace(load, force=force, moment=moment, torque=torque, cache=kept), cache={}
        )

    @property
    def _tip(self) -> FloatArray:
        """The tool's tip at each point, base frame, shape (n, 3) [m]."""
        return self.load.origin[:, 6] + self.load.axes[:, 6] @ self.tip
