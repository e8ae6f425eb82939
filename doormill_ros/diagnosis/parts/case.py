"""What effects in inspected doors look at: loads and geometry where each point was cut, its normal, and its door."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from doormill_ros.arrays import BoolArray, FloatArray
from doormill_ros.robot_model.elastic.load_case import LoadCase


@dataclass(frozen=True, eq=False)
class CutCase:
    """n points of inspected doors.

    Attributes:
        load: Loads and geometry of the robot where each was cut.
        normal: Unit normals into the wood, base axes, shape (n, 3).
        wall: Which points lie on a wall, the others on a floor; shape (n,).
        kind: Kind of the feature of each point, shape (n,).
        bend: Curvature of the tool's way where it cut each, base axes, shape (n, 3) [1 / m].
        time: When the door of each point was milled [s since the epoch], shape (n,).
        eye: Where the camera stood that saw the door of each point, base frame, shape (n, 3) [m].
        tip: The tool's tip, flange frame, shape (3,) [m].
        cache: Columns that have been asked for.
    """

    load: LoadCase
    normal: FloatArray
    wall: BoolArray
    kind: np.ndarray[tuple[int], np.dtype[np.str_]]
    bend: FloatArray
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
        share = gain * np.stack([np.ones_like(angle), np.cos(angle), np.sin(angle)])
        force, moment, torque = (np.einsum("cn,cn...->n...", share, part) for part in self._turned)
        kept: dict[object, FloatArray] = {
            key: value for key, value in load.cache.items() if isinstance(key, tuple) and key[0] == "joint"
        }
        return replace(
            self, load=replace(load, force=force, moment=moment, torque=torque, cache=kept), cache={}
        )

    def carrying(self, torque: FloatArray) -> CutCase:
        """The same with joints that carry more beside the process, shape (n, 6) [N m]; no force at the tool does."""
        load = self.load
        kept: dict[object, FloatArray] = {key: value for key, value in load.cache.items() if key == "joints"}
        return replace(self, load=replace(load, torque=load.torque + torque, cache=kept), cache={})

    @property
    def _turned(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Force, moments and torques of which a turn by a takes 1, cos a and sin a, computed once.

        Of every vector v these are k (k v), v less that, and k x v, with k along the tool (Rodrigues' formula).

        Returns:
            Shapes (3, n, 3) [N], (3, n, 7, 3) and (3, n, 6) [N m].
        """
        names = "force", "moment", "torque"
        if ("turned", "force") not in self.cache:
            load, axis = self.load, self.load.axes[:, 6, :, 2]
            tip = load.origin[:, 6] + load.axes[:, 6] @ self.tip
            couple = load.moment[:, 6] - np.cross(tip - load.origin[:, 6], load.force)

            def parts(vector: FloatArray) -> FloatArray:
                along = axis * np.sum(axis * vector, axis=1, keepdims=True)
                return np.stack([along, vector - along, np.cross(axis, vector)])

            force = parts(load.force)
            arm = tip[:, None] - load.origin
            moment = parts(couple)[:, :, None] + np.cross(arm, force[:, :, None])
            torque = np.einsum("nki,cnki->cnk", load.axes[:, :6, :, 2], moment[:, :, :6])
            for name, found in zip(names, (force, moment, torque), strict=True):
                self.cache["turned", name] = found
        force, moment, torque = (self.cache["turned", name] for name in names)
        return force, moment, torque
