"""Stretches of wall do not hang on the order in which a gauge writes its points."""

import numpy as np
import pytest

from doormill_ros.diagnosis.parts.doors.stretches import LENGTH, stretches


def oblong(count=200, length=0.08, radius=0.01):
    """Points of a contour that was gauged round, in the plane y, z of a door, and its length."""
    straight, whole = length - 2.0 * radius, 2.0 * (length - 2.0 * radius) + 2.0 * np.pi * radius
    at = np.linspace(0.0, whole, count, endpoint=False)
    points = []
    for s in at:
        if s < straight:
            y, z = s - straight / 2.0, radius
        elif s < straight + np.pi * radius:
            a = np.pi / 2.0 - (s - straight) / radius
            y, z = straight / 2.0 + radius * np.cos(a), radius * np.sin(a)
        elif s < 2.0 * straight + np.pi * radius:
            y, z = straight / 2.0 - (s - straight - np.pi * radius), -radius
        else:
            a = -np.pi / 2.0 - (s - 2.0 * straight - np.pi * radius) / radius
            y, z = -straight / 2.0 + radius * np.cos(a), radius * np.sin(a)
        points.append((2.0, y, 1.0 + z))
    return np.array(points), whole


@pytest.mark.parametrize("seed", range(4))
def test_shuffled_points_are_left_out_with_the_same_neighbours(seed):
    points, whole = oblong()
    order = np.random.default_rng(seed).permutation(len(points))
    plain = stretches(points, np.zeros(len(points), dtype=int))
    found = stretches(points[order], np.zeros(len(points), dtype=int))
    assert np.array_equal(found, plain[order])
    assert len(np.unique(plain)) == int(np.ceil(whole / LENGTH - 1e-9))
    for number in np.unique(plain):
        assert np.ptp(points[plain == number], axis=0).max() < LENGTH + 1e-3


def test_surfaces_share_no_stretch():
    points, _ = oblong()
    twice, surface = np.vstack([points, points + np.array([0.01, 0.0, 0.0])]), np.repeat([4, 2], len(points))
    found = stretches(twice, surface)
    assert not set(found[surface == 4]) & set(found[surface == 2])


def test_one_point_alone_is_a_stretch():
    assert stretches(np.zeros((1, 3)), np.zeros(1, dtype=int)).tolist() == [0]
