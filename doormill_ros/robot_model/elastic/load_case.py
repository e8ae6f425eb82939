"""Geometry and loads of many static loadings at once, in the base frame."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from doormill_ros.arrays import FloatArray, IntArray
from doormill_ros.frames import cross, rotate_wrench, rotation_z
from doormill_ros.robot.kinematics import Kinematics
from doormill_ros.robot_model.elastic.circumstances import NOTHING_KNOWN, Circumstances

LEAST_TORQUE = 1e-9  #: a joint that carries less carries nothing [N m]


@dataclass(frozen=True, eq=False)
class LoadCase:
    """n loadings of one robot and the points whose motion is asked for.

    Attributes:
        axes: R_base_i of the link frames 0..6, shape (n, 7, 3, 3).
        origin: Origins of the link frames, shape (n, 7, 3) [m].
        force: Load on the robot, shape (n, 3) [N].
        moment: Moment of the load about each origin, shape (n, 7, 3) [N m].
        torque: Moment about each joint axis, shape (n, 6) [N m] (thesis eq. 2.34).
        point: Points asked for, shape (n, 3) [m].
        link: Link that carries each point, shape (n,).
        direction: Last motion of each joint, shape (n, 6).
        joint_stiffness: Springs of the model in question, shape (6,) [N m / rad].
        torque_noise: Standard deviation of each joint torque, shape (n, 6) [N m].
        largest_torque: Largest torque of each joint over the whole test, shape (6,) [N m].
        q: Joint angles, shape (n, 6) [rad].
        load: Where the wrench acts, shape (n, 3) [m].
        sensor: R_base_sensor of the force sensor, that of the flange where there is none, shape (n, 3, 3).
        circumstances: What else is known of each loading.
        cache: Unit twists of causes that have been asked for.
    """

    axes: FloatArray
    origin: FloatArray
    force: FloatArray
    moment: FloatArray
    torque: FloatArray
    point: FloatArray
    link: IntArray
    direction: FloatArray
    joint_stiffness: FloatArray
    torque_noise: FloatArray
    largest_torque: FloatArray
    q: FloatArray
    load: FloatArray
    sensor: FloatArray
    circumstances: Circumstances = NOTHING_KNOWN
    cache: dict[object, FloatArray] = field(default_factory=dict)

    def __len__(self) -> int:
        return len(self.force)

    def axis(self, k: int) -> FloatArray:
        """Axis of joint k (0..5), shape (n, 3)."""
        return self.axes[:, k, :, 2]

    def rotate(self, rotation: FloatArray, origin: int, first_link: int) -> FloatArray:
        """Twist of each point when everything from a link on turns about a frame's origin.

        Args:
            rotation: Rotation vector, shape (n, 3) [rad].
            origin: Frame 0..6 about whose origin it turns.
            first_link: First link that turns with it.

        Returns:
            Displacement and rotation of the point, zero on links before, shape (n, 6).
        """
        twist = np.concatenate([cross(rotation, self.point - self.origin[:, origin]), rotation], axis=1)
        twist[self.link < first_link] = 0.0
        return twist

    def joint_twist(self, k: int) -> FloatArray:
        """Twist of each point for one radian of joint k (0..5), shape (n, 6): thesis eq. 2.29."""
        return self.joint_twists()[:, k]

    def joint_twists(self) -> FloatArray:
        """Those of all joints, shape (n, 6 joints, 6)."""
        if "joints" not in self.cache:
            axes = self.axes[:, :6, :, 2]
            twists = np.empty((len(self), 6, 6))
            twists[..., :3] = cross(axes, self.point[:, None] - self.origin[:, :6])
            twists[..., 3:] = axes
            twists[self.link[:, None] <= np.arange(6)] = 0.0
            self.cache["joints"] = twists
        return self.cache["joints"]

    def springs(self) -> FloatArray:
        """Twist of each point by the linear joint springs, shape (n, 6) (thesis eq. 2.40)."""
        if "springs" not in self.cache:
            give = self.torque / self.joint_stiffness
            self.cache["springs"] = (give[:, None] @ self.joint_twists())[:, 0]
        return self.cache["springs"]

    def curvature(self) -> FloatArray:
        """What finite joint angles add to the displacement of the springs, shape (n, 3) [m].

        The joints turn one after the other, from the tool to the base, each about its own axis
        (product of exponentials).
        """
        if "curvature" not in self.cache:
            give = self.torque / self.joint_stiffness
            point = self.point
            for k in reversed(range(6)):
                arm, axis = point - self.origin[:, k], self.axis(k)
                angle = np.where(self.link > k, give[:, k], 0.0)[:, None]
                along = np.sum(axis * arm, axis=1, keepdims=True) * axis
                across = cross(axis, arm)
                point = self.origin[:, k] + along + np.cos(angle) * (arm - along) + np.sin(angle) * across
            self.cache["curvature"] = point - self.point - self.springs()[:, :3]
        return self.cache["curvature"]


def largest_of(torque: FloatArray) -> FloatArray:
    """Largest torque of each joint, shapes (n, 6) -> (6,) [N m]; never 0, for laws are told in shares of it."""
    largest: FloatArray = np.maximum(np.abs(torque).max(axis=0), LEAST_TORQUE)
    return largest


def build_load_case(
    kinematics: Kinematics,
    q: FloatArray,
    wrench: FloatArray,
    load_point: FloatArray,
    *,
    wrench_rotation: float | None = None,
    points: FloatArray | None = None,
    links: IntArray | None = None,
    direction: FloatArray | None = None,
    joint_stiffness: FloatArray,
    noise: tuple[float, float] = (0.0, 0.0),
    largest_torque: FloatArray | None = None,
    circumstances: Circumstances = NOTHING_KNOWN,
) -> LoadCase:
    """Work out where everything is and how the load acts on it.

    Args:
        kinematics: Of the robot.
        q: Joint angles, shape (n, 6) [rad].
        wrench: Wrench at the load point, shape (n, 6) [N, N m]; base axes, or sensor axes when
            `wrench_rotation` is given.
        load_point: Flange frame, shape (3,) [m].
        wrench_rotation: Rotation about flange z from sensor axes to flange axes [rad].
        points: Position of the points in their links' frames, shape (n, 3) [m]; default the load point.
        links: Links of the points, shape (n,); default the flange.
        direction: Last motion of the joints, shape (n, 6); default unknown.
        joint_stiffness: Shape (6,) [N m / rad].
        noise: Standard deviation of force [N] and torque [N m].
        largest_torque: To scale laws with; default from these loadings.
        circumstances: What else is known of each loading.
    """
    q = np.asarray(q, dtype=float)
    n = len(q)
    frames = kinematics.link_frames(q)
    axes, origin = frames[..., :3, :3], frames[..., :3, 3]
    sensor = axes[:, 6]
    if wrench_rotation is not None:
        sensor = axes[:, 6] @ rotation_z(wrench_rotation)
        wrench = rotate_wrench(sensor, wrench)
    force, couple = wrench[:, :3], wrench[:, 3:]
    load = origin[:, 6] + axes[:, 6] @ np.asarray(load_point, dtype=float)
    moment = couple[:, None] + cross(load[:, None] - origin, force[:, None])
    joint_axes = axes[:, :6, :, 2]
    torque = np.einsum("nki,nki->nk", joint_axes, moment[:, :6])
    torque_noise = np.zeros((n, 6))
    if any(noise):
        arm = cross(joint_axes, load[:, None] - origin[:, :6])
        torque_noise = np.sqrt((noise[0] * np.linalg.norm(arm, axis=2)) ** 2 + noise[1] ** 2)
    if points is None:
        points, links = np.broadcast_to(load_point, (n, 3)), np.full(n, 6)
    rows = np.arange(n)
    point = origin[rows, links] + np.einsum("nij,nj->ni", axes[rows, links], points)
    return LoadCase(
        axes=axes,
        origin=origin,
        force=force,
        moment=moment,
        torque=torque,
        point=point,
        link=np.asarray(links),
        direction=np.zeros((n, 6)) if direction is None else np.asarray(direction, dtype=float),
        joint_stiffness=np.asarray(joint_stiffness, dtype=float),
        torque_noise=torque_noise,
        largest_torque=largest_of(torque) if largest_torque is None else largest_torque,
        q=q,
        load=load,
        sensor=sensor,
        circumstances=circumstances,
    )
