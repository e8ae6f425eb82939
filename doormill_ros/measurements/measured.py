"""A measurement set as loadings: wrenches turned from sensor axes into base axes."""

from __future__ import annotations

import numpy as np

from doormill_ros.frames import rotate_wrench, rotation_z
from doormill_ros.measurements.loading import Loadings
from doormill_ros.measurements.measurement_set import MeasurementSet
from doormill_ros.robot.chain import JOINTS
from doormill_ros.robot.kinematics import Kinematics


def loadings_of_set(kinematics: Kinematics, measurements: MeasurementSet) -> Loadings:
    """The trials of a measurement set as loadings."""
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
