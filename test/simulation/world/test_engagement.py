"""Forces of engaged wood against the closed form for full and half immersion."""

import numpy as np

from doormill_ros.simulation.world.engagement import RADIAL, slot_share

RADIUS, DEPTH = 8e-3, 5e-3
FULL = np.array([-RADIAL, -1.0]) / np.hypot(RADIAL, 1.0)  # along and across the feed


def straight(y=0.0, z=DEPTH, length=0.04, step=5e-4):
    x = np.arange(0.0, length, step)
    return np.column_stack([x, np.full_like(x, y), np.full_like(x, z)])


def test_a_full_slot_takes_the_whole_force_against_feed_and_across():
    share = slot_share(straight(), RADIUS, DEPTH)[10:]
    np.testing.assert_allclose(share, np.broadcast_to(FULL, share.shape), atol=0.05)
    np.testing.assert_allclose(share.mean(axis=0), FULL, atol=0.02)


def test_half_the_depth_takes_half_the_force():
    share = slot_share(straight(z=DEPTH / 2.0), RADIUS, DEPTH)[10:]
    np.testing.assert_allclose(share, np.broadcast_to(FULL / 2.0, share.shape), atol=0.05)


def test_a_way_that_was_cut_before_takes_no_force():
    share = slot_share(np.concatenate([straight(), straight()]), RADIUS, DEPTH)
    half = len(share) // 2
    assert not share[half:].any()
    assert share[:half].any()


def test_the_force_grows_from_nothing_where_a_cut_begins():
    away = straight() + np.array([0.0, 0.05, 0.0])  # into full wood, beside the first slot
    share = slot_share(np.concatenate([straight(), away]), RADIUS, DEPTH)
    size = np.linalg.norm(share[len(share) // 2 :], axis=1)
    assert not size[0]
    assert size[1] == np.clip(size[1], 0.3, 0.7)
    assert np.all(np.abs(size[5:] - 1.0) < 0.06)


def test_half_immersion_takes_the_closed_form():
    # The other half of the slot is gone to one side: integrals of cos (1, 1) over a quarter turn.
    first, second = straight(length=0.08), straight(y=RADIUS, length=0.05)
    share = slot_share(np.concatenate([first, second]), RADIUS, DEPTH)[len(first) + 40 : -2]
    assert len(share) > 50
    along = -(-0.5 + RADIAL * np.pi / 4.0)
    across = -(np.pi / 4.0 + RADIAL * 0.5)
    expected = np.array([along, across]) / (np.pi / 2.0 * np.hypot(1.0, RADIAL))
    np.testing.assert_allclose(share.mean(axis=0), expected, atol=0.015)


def test_the_force_turns_with_the_feed():
    turned = straight()[:, [1, 0, 2]] * [-1.0, 1.0, 1.0]  # a quarter turn from x to y
    share = slot_share(turned, RADIUS, DEPTH)[10:]
    np.testing.assert_allclose(share, np.broadcast_to([-FULL[1], FULL[0]], share.shape), atol=0.05)


def test_going_down_takes_no_force_across():
    down = np.column_stack([np.zeros(20), np.zeros(20), np.linspace(0.0, DEPTH, 20)])
    assert not slot_share(down, RADIUS, DEPTH).any()
