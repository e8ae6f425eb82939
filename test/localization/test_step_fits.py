"""Fits of steps to mean profiles: places, derivatives and what is known of the blur."""

from math import erf, sqrt

import numpy as np
import pytest

from doormill_ros.localization.edge_points import step_grid, step_models
from doormill_ros.localization.edge_points.blur import bin_places
from doormill_ros.localization.edge_points.step_grid import nearness, two_starts
from doormill_ros.localization.rims.step_fits import (
    Sharp,
    fit_disc,
    fit_one,
    fit_ramp,
    fit_two,
)

PLACE = bin_places(47)


def soft(at, blur):
    """A step at `at` seen with a Gaussian point spread and the pixel's own width."""
    sigma = sqrt(blur**2 + 1 / 12)
    return np.array([0.5 * (1 + erf((x - at) / sigma / sqrt(2))) for x in PLACE])


def test_one_step_is_placed():
    fit = fit_one(soft(0.37, 1.3), np.full(PLACE.size, 250.0), 0.9)
    assert fit.places == pytest.approx([0.37, 1.3], abs=1e-3)
    assert fit.misfit < 0.05


@pytest.mark.parametrize(("width", "share", "blur"), [(1.8, 0.2, 0.85), (2.4, 0.4, 0.95), (8.0, 0.5, 1.1)])
def test_two_steps_are_placed_from_the_grid(width, share, blur):
    profile = share * soft(1.1, blur) + (1 - share) * soft(1.1 - width, blur)
    weight = np.full(PLACE.size, 250.0)
    starts = two_starts(profile, weight)
    best = min((fit_two(profile, weight, start) for start in starts), key=lambda fit: fit.misfit)
    assert best.places == pytest.approx([1.1, width, blur], abs=0.02)
    assert best.heights == pytest.approx([share, 1 - share], abs=0.01)


def test_deviation_is_the_scatter_of_the_place():
    noise, rng = 2e-3, np.random.default_rng(8)
    profile = 0.3 * soft(1.5, 1.0) + 0.7 * soft(-1.5, 1.0)
    weight = np.full(PLACE.size, 1 / noise)
    start = np.array([1.4, 2.8, 1.1])
    fits = [fit_two(profile + noise * rng.standard_normal(PLACE.size), weight, start) for _ in range(120)]
    scatter = np.std([fit.places[0] for fit in fits])
    assert scatter == pytest.approx(np.mean([fit.deviation for fit in fits]), rel=0.25)


def test_a_blur_that_is_known_places_what_the_profile_leaves_open():
    profile = 0.45 * soft(0.6, 1.0) + 0.55 * soft(-0.6, 1.0)
    weight, start = np.full(PLACE.size, 250.0), np.array([0.6, 1.2, 1.0])
    free, known = fit_two(profile, weight, start), fit_two(profile, weight, start, Sharp(1.0, 0.02))
    assert known.deviation < 0.9 * free.deviation
    assert known.places[0] == pytest.approx(0.6, abs=0.05)


def test_what_thins_out_evenly_is_no_disc():
    reach = 2.5
    profile = np.mean([soft(at, 0.8) for at in np.linspace(-reach, reach, 201)], axis=0)
    weight = np.full(PLACE.size, 250.0)
    ramp = fit_ramp(profile, weight, 2.0, 0.8)
    assert ramp.places == pytest.approx([0.0, reach, 0.8], abs=0.03)
    assert ramp.misfit < 0.3 * fit_disc(profile, weight, 2.0).misfit


@pytest.mark.parametrize(
    "model",
    [
        step_models.OneStep(47),
        step_models.TwoSteps(47),
        step_models.SpreadStep(47, step_models.DISC, 2),
        step_models.SpreadStep(47, step_models.RAMP, 3),
        step_models.RoundedStep(47, 0.3),
    ],
)
def test_slopes_are_those_of_the_columns(model):
    heights = np.array([0.3, 0.6]) if isinstance(model, step_models.TwoSteps) else np.array([0.9])
    p = np.array([0.4, 1.7, 0.9])[: len(model.jacobian) - model.count]
    h = 1e-5
    ahead, behind = (
        np.array([heights @ model.at((p + move).tolist())[1:] for move in side * np.eye(p.size)])
        for side in (h, -h)
    )
    columns = model.at(p.tolist()).copy()
    slopes = model.slopes(heights.tolist())
    np.testing.assert_array_equal(slopes[: model.count], columns)
    np.testing.assert_allclose(slopes[model.count :], (ahead - behind) / (2 * h), atol=1e-6)


def left_of_two(profile, weight, places):
    """Squared deviations from two steps of the best heights, by plain least squares; weights (m,) or (m, m)."""
    shift, width, blur = places
    columns = np.stack([np.ones(PLACE.size), soft(shift, blur), soft(shift - width, blur)], axis=1)
    white = np.diag(weight) if weight.ndim == 1 else weight
    heights = np.linalg.lstsq(white @ columns, white @ profile, rcond=None)[0]
    return float(np.sum((white @ (columns @ heights - profile)) ** 2))


def test_the_grid_starts_where_least_squares_are_least():
    rng = np.random.default_rng(3)
    profile = 0.4 * soft(1.2, 1.1) + 0.6 * soft(-2.0, 1.1) + 4e-3 * rng.standard_normal(PLACE.size)
    weight = 250.0 * rng.uniform(0.5, 1.0, PLACE.size)
    parameters = step_grid._grid(PLACE.size)[0]
    left = np.array([left_of_two(profile, weight, places) for places in parameters])
    best = parameters[np.argmin(left)]
    other = np.abs(parameters[:, 1] / best[1] - 1) > 0.5
    second = parameters[np.argmin(np.where(other, left, np.inf))]
    np.testing.assert_array_equal(two_starts(profile, weight), [best, second])


def test_nearness_is_that_of_least_squares():
    rng = np.random.default_rng(4)
    profile = 0.3 * soft(0.9, 1.0) + 0.7 * soft(-0.9, 1.0) + 4e-3 * rng.standard_normal(PLACE.size)
    weight = np.tril(0.1 * rng.standard_normal((PLACE.size, PLACE.size))) * 20.0 + 250.0 * np.eye(PLACE.size)
    places = np.array([[0.9, 1.8, 1.0], [0.5, 1.2, 0.9], [2.2, 2.2, 1.3]])
    wanted = [left_of_two(profile, weight, each) for each in places]
    np.testing.assert_allclose(nearness(profile, weight, places), wanted, rtol=1e-5)
