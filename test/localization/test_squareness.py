"""Doors that are not square: what the two lines tell of the turn, and how sure that is."""

import numpy as np
import pytest

from doormill_ros.localization.errors import WrongEdge
from doormill_ros.localization.lines.fit import LineFit, fit_corner
from doormill_ros.localization.localizer import localize
from doormill_ros.simulation.picture.picture import render_picture
from doormill_ros.units import DEG
from support.pictures.conditions import pictures

SQUARE, LIMIT = 1.0e-4, 2.6e-3
HINGE, BOTTOM = 3.0e-4, 4.0e-5  # standard deviations of the lines' slopes: little shows of the hinge edge


def line(slope, deviation):
    nothing = np.zeros(0)
    return LineFit(
        0.0, slope, 0.05, 1e-11, deviation**2, nothing, nothing.astype(bool), 1e-5, 0.0, 1.0, 1e-10, 12.0
    )


def scores(skew, seed):
    """Errors of the turn in standard deviations and in radians of 2000 doors that are out of square by `skew` [rad]."""
    rng, out = np.random.default_rng(seed), []
    for h, b in rng.standard_normal((2000, 2)):
        fit = fit_corner(line(-HINGE * h, HINGE), line(skew + BOTTOM * b, BOTTOM), SQUARE, LIMIT)
        out.append((fit.pose[2] / np.sqrt(fit.covariance[2, 2]), fit.pose[2]))
    return np.array(out).T


def test_a_door_that_is_a_little_askew_is_not_stated_too_surely():
    normalized, _ = scores(0.05 * DEG, 3)
    assert np.mean(np.abs(normalized) > 5.0) < 0.02


def test_both_edges_still_tell_the_turn_of_a_square_door():
    normalized, errors = scores(0.0, 4)
    assert np.sqrt(np.mean(errors**2)) < 0.6 * HINGE
    assert np.sqrt(np.mean(normalized**2)) < 1.1


def test_the_hinge_edge_alone_tells_the_turn_of_one_that_is_plainly_askew():
    fit = fit_corner(line(0.0, 2e-5), line(2.0e-3, 2e-5), SQUARE, LIMIT)
    assert abs(fit.pose[2]) < 2e-5
    assert abs(fit.out_of_square - 2.0e-3) < 1e-6


def test_a_streak_is_not_taken_for_an_edge_that_is_not_square(camera, layout):
    item = next(iter(pictures("oak grain", 1, 9001)))
    with pytest.raises(WrongEdge, match=r"-0\.1\d\d degrees out of square, and streaks of 10 %"):
        localize(render_picture(item.scene, item.seed), camera, layout, item.scene.width, item.thickness)
