"""What effects in inspected doors look at: loads and geometry where each point was cut, its normal, and its door."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from doormill_ros.arrays import BoolArray, FloatArray
from doormill_ros.robot_model.elastic.load_case import LoadCase

TOOL = "tool"  #: the place of an effect that all tools have alike
_JOINTS = "joints along the normals"  #: among the columns that no load changes


@dataclass(frozen=True, eq=False)
class CutCase:
    """n points of inspected doors.

    Attributes:
        load: Loads and geometry of the robot where each was cut.
        normal: Unit normals into the wood, base axes, shape (n, 3).
        wall: Which points lie on a wall, the others on a floor; shape (n,).
        kind: Kind of the feature of each point, shape (n,).
        tool: Name of the tool that cut it, shape (n,).
        bend: Curvature of the tool's way where it cut each, base axes, shape (n, 3) [1 / m].
        late: How far beside it the tool passes that follows late by each of `LAGS`, base axes, shape (n, lags, 3) [m].
        feed: Speed of the tool there, shape (n,) [m / s].
        time: When the door of each point was milled [s since the epoch], shape (n,).
        height: Of each above the lower edge of its door, shape (n,) [m].
        eye: Where the camera stood that saw the door of each point, base frame, shape (n, 3) [m].
        tip: The tool's tip, flange frame, shape (3,) [m].
        unloaded: Columns that were asked for and that no load changes, of the same points under whatever loads.
    """

    load: LoadCase
    normal: FloatArray
    wall: BoolArray
    kind: np.ndarray[tuple[int], np.dtype[np.str_]]
    tool: np.ndarray[tuple[int], np.dtype[np.str_]]
    bend: FloatArray
    late: FloatArray
    feed: FloatArray
    time: FloatArray
    height: FloatArray
    eye: FloatArray
    tip: FloatArray
    unloaded: dict[object, FloatArray] = field(default_factory=dict)

    def __len__(self) -> int:
        return len(self.normal)

    def cut_by(self, where: str) -> BoolArray:
        """Which points a tool cut, or any tool in a kind of feature, or any at all where it is TOOL; shape (n,)."""
        return np.full(len(self), True) if where == TOOL else (self.kind == where) | (self.tool == where)

    def along(self, displacement: FloatArray) -> FloatArray:
        """What displacements, shape (n, 3) or (n, 3, p), are along the normals, shape (n,) or (n, p)."""
        result: FloatArray = np.einsum("ni,ni...->n...", self.normal, displacement)
        return result

    def joints(self) -> FloatArray:
        """What a radian of each joint moves each point along its normal, shape (n, 6) [m / rad]; of no load."""
        if _JOINTS not in self.unloaded:
            twists = self.load.joint_twists()
            self.unloaded[_JOINTS] = np.einsum("ni,nki->nk", self.normal, twists[..., :3])
        return self.unloaded[_JOINTS]

    def springs(self) -> FloatArray:
        """What the linear joint springs move each point along its normal, shape (n,) [m] (thesis eq. 2.40)."""
        give = self.load.torque / self.load.joint_stiffness
        result: FloatArray = np.einsum("nk,nk->n", give, self.joints())
        return result

    def felt(self, gain: FloatArray, angle: FloatArray) -> CutCase:
        """The same under wrenches times `gain`, turned about the tool by `angle` [rad], shape (n,) each."""
        along, across, turned = self._turned
        size = gain[:, None]
        load = size * along + size * np.cos(angle)[:, None] * across + size * np.sin(angle)[:, None] * turned
        return self._under(load[:, :3], load[:, 9:].reshape(-1, 7, 3), load[:, 3:9])

    def carrying(self, torque: FloatArray) -> CutCase:
        """The same with joints that carry more beside the process, shape (n, 6) [N m]; no force at the tool does."""
        return self._under(self.load.force, self.load.moment, self.load.torque + torque)

    def _under(self, force: FloatArray, moment: FloatArray, torque: FloatArray) -> CutCase:
        """The same under other loads; where everything is stays as it is."""
        kept: dict[object, FloatArray] = {"joints": self.load.joint_twists()}
        load = replace(self.load, force=force, moment=moment, torque=torque, cache=kept)
        return replace(self, load=load)

    @cached_property
    def _turned(self) -> FloatArray:
        """Forces, torques and moments of which a turn by a takes 1, cos a and sin a, computed once.

        Of every vector v these are k (k v), v less that, and k x v, with k along the tool (Rodrigues' formula).

        Returns:
            Shape (3, n, 30): force [N], torques of six joints, moments about seven frames [N m].
        """
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
        return np.concatenate([force, torque, moment.reshape(3, -1, 21)], axis=2)
