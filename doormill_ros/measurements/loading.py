"""Static loadings of the robot, and how far each would move if one joint alone gave way.

With the load W at a point of link l, joint k feels tau_k = J_load[:, k]^T W (thesis eq. 2.34) and turns
by tau_k / K_k (2.36), which moves the reflector by J_reflector[:, k] tau_k / K_k (2.32). The displacement
is therefore linear in the six compliances c = 1 / K: d = A c.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

import numpy as np

from doormill_ros.arrays import BoolArray, FloatArray, IntArray
from doormill_ros.frames import rotate_wrench, rotation_z
from doormill_ros.measurements.sets.measurement_set import MeasurementSet
from doormill_ros.robot.chain import JOINTS
from doormill_ros.robot.kinematics import Kinematics


@dataclass(frozen=True, eq=False)
class Loadings:
    """n static loadings, each seen by one reflector.

    Attributes:
        q: Joint angles, shape (n, 6) [rad].
        wrench: Load on the robot at the load point, base axes, shape (n, 6) [N, N m].
        load_link: Moving link that carries the load, shape (n,), 6 is the flange.
        load_point: Where the load acts, frame of that link, shape (n, 3) [m].
        reflector_link: Moving link that carries the reflector, shape (n,).
        reflector: Its position, frame of that link, shape (n, 3) [m].
        displacement: Loaded minus unloaded reflector position, base axes, shape (n, 3) [m].
        displacement_std: Standard deviation of the displacement components, shape (n, 3) [m].
        wrench_std: Standard deviation of the wrench components, shape (n, 6) [N, N m].
    """

    q: FloatArray
    wrench: FloatArray
    load_link: IntArray
    load_point: FloatArray
    reflector_link: IntArray
    reflector: FloatArray
    displacement: FloatArray
    displacement_std: FloatArray
    wrench_std: FloatArray

    def __len__(self) -> int:
        """Number of loadings."""
        return len(self.q)

    def pick(self, rows: IntArray | BoolArray) -> Loadings:
        """The given loadings alone; row numbers or a mask, shape (k,) or (n,)."""
        return replace(self, **{field.name: getattr(self, field.name)[rows] for field in fields(self)})


def joint_torques(kinematics: Kinematics, loadings: Loadings) -> FloatArray:
    """Torque of the load about each joint, shape (n, 6) [N m] (thesis eq. 2.34)."""
    torque: FloatArray = np.einsum("nik,ni->nk", load_jacobian(kinematics, loadings), loadings.wrench)
    return torque


def load_jacobian(kinematics: Kinematics, loadings: Loadings) -> FloatArray:
    """Jacobian of each load point, shape (n, 6, 6)."""
    return _jacobian(kinematics, loadings.q, loadings.load_link, loadings.load_point)


def reflector_jacobian(kinematics: Kinematics, loadings: Loadings) -> FloatArray:
    """Jacobian of each reflector, shape (n, 6, 6)."""
    return _jacobian(kinematics, loadings.q, loadings.reflector_link, loadings.reflector)


def displacement_per_compliance(kinematics: Kinematics, loadings: Loadings) -> FloatArray:
    """The matrix A of d = A c, shape (n, 3, 6) [m N m / rad]; column k is joint k alone."""
    lever = reflector_jacobian(kinematics, loadings)[:, :3]
    return lever * joint_torques(kinematics, loadings)[:, None, :]


def _jacobian(kinematics: Kinematics, q: FloatArray, link: IntArray, point: FloatArray) -> FloatArray:
    """Jacobians of points on different links: one vectorised call for each distinct point."""
    keys = np.column_stack([np.asarray(link, dtype=float), point])
    distinct, group = np.unique(keys, axis=0, return_inverse=True)
    J = np.empty((len(q), 6, JOINTS))
    for index, key in enumerate(distinct):
        rows = group.ravel() == index
        J[rows] = kinematics.link_jacobian(q[rows], int(key[0]), key[1:])
    return J


def loadings_of_set(kinematics: Kinematics, measurements: MeasurementSet) -> Loadings:
    """The trials of a measurement set as loadings: wrenches turned from sensor axes into base axes."""
    R_base_flange = kinematics.forward(measurements.q)[:, :3, :3]
    R_base_sensor = R_base_flange @ rotation_z(measurements.wrench_frame_rotation)
    noise = measurements.noise
    n = len(measurements)
    return Loadings(
        q=measurements.q,
        wrench=rotate_wrench(R_base_sensor, measurements.wrench),
        load_link=np.full(n, JOINTS),
        load_point=np.tile(measurements.load_point, (n, 1)),
        reflector_link=measurements.reflector_link,
        reflector=measurements.reflector_position,
        displacement=measurements.displacement,
        displacement_std=np.full((n, 3), noise.displacement),
        wrench_std=np.tile([noise.force] * 3 + [noise.torque] * 3, (n, 1)),
    )
