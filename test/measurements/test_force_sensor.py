"""The mounting rotation of the force sensor, on the four printed readings."""

from __future__ import annotations

import math

import numpy as np
import pytest

from doormill_ros.measurements.raw.force_sensor import (
    MOUNTING_ROTATION,
    sensor_to_flange,
)

# Appendices A.8, A.10, A.12, A.13.
READINGS = {
    1: [-126.2130, -122.8430, -8.6697, 13.2552, -14.1647, 6.1561],
    3: [-1.6108, -0.4682, 197.9959, 1.7874, -0.4346, -0.0256],
    5: [131.3839, -143.2498, 3.7887, 11.3128, 10.8667, 0.1326],
    6: [123.7268, -128.4797, 3.4454, 6.7128, 4.6608, -89.4632],
}
ALONG = {1: (1, -1), 3: (2, 1), 5: (0, 1), 6: (0, 1)}  # axis and sign in which the load was applied


@pytest.mark.parametrize("test", READINGS)
def test_the_mounting_angle_turns_the_load_onto_a_flange_axis(test):
    """Each load was applied along one flange axis; after the rotation less than 7 % is left across it."""
    force = sensor_to_flange(np.array(READINGS[test]))[:3]
    axis, sign = ALONG[test]
    assert np.sign(force[axis]) == sign
    assert np.linalg.norm(np.delete(force, axis)) < 0.07 * abs(force[axis])
    # The other sense of rotation would not do that, except for the load along z.
    if axis != 2:
        other = sensor_to_flange(np.array(READINGS[test]), -MOUNTING_ROTATION)[:3]
        assert np.linalg.norm(np.delete(other, axis)) > 0.5 * np.linalg.norm(other)


def test_rotation_by_hand():
    """The sensor's x axis stands at the mounting angle from the flange's x axis."""
    turned = sensor_to_flange(np.array([1.0, 0, 0, 0, 1.0, 0]))
    a = math.atan2(219.25, 226.66)
    assert turned == pytest.approx([math.cos(a), math.sin(a), 0, -math.sin(a), math.cos(a), 0])
