"""How far doors scatter, told by very few of them."""

import numpy as np
import pytest

from doormill_ros.diagnosis.parts.fitting.placement import scatter_between

STATED = np.array([85e-6, 50e-6, 80e-6]) ** 2
KNOWN = np.zeros((5, 3, 3))  #: by points all over the door
RECIPES = ("narrow", "wide", "turned", "narrow", "wide")


def drawn(seed, share, step=(0.0, 0.0, 0.0)):
    rng = np.random.default_rng(seed)
    places = share * np.sqrt(STATED) * rng.standard_normal((5, 3))
    places[3:] += step
    # Whatever is wrong with one recipe displaces all of its doors.
    wrong = dict(zip(RECIPES[:3], rng.normal(0.0, 1e-4, (3, 3)), strict=True))
    return places + [wrong[recipe] for recipe in RECIPES]


@pytest.mark.parametrize("share", [0.2, 0.3])
def test_five_doors_are_hardly_ever_taken_to_scatter_less_than_they_do(share):
    found = np.array([scatter_between(drawn(seed, share), RECIPES, STATED, KNOWN) for seed in range(400)])
    understated = np.mean(found[:, 0] < share**2 * STATED[0] * (1.0 - 1e-9))
    assert 0.02 < understated < 0.09
    assert np.all(found <= STATED)
    # Nor to scatter as far as the localizer says where they do not.
    assert np.median(np.sqrt(found[:, 0] / STATED[0])) < 5.0 * share


def test_a_step_that_two_recipes_show_alike_is_no_scatter():
    step = np.array([2e-4, -1e-4, 1e-4])
    plain, moved = (
        scatter_between(drawn(7, 0.1, way), RECIPES, STATED, KNOWN) for way in (np.zeros(3), step)
    )
    assert moved == pytest.approx(plain)
    assert np.sqrt(moved[0]) < 0.2 * step[0]


def test_a_step_that_one_of_two_recipes_shows_only_makes_it_larger():
    places = drawn(7, 0.1)
    plain = scatter_between(places, RECIPES, STATED, KNOWN)
    places[4] += 1e-3
    assert np.all(scatter_between(places, RECIPES, STATED, KNOWN) > plain)
    assert scatter_between(places, RECIPES, STATED, KNOWN) == pytest.approx(STATED)


def test_one_recipe_seen_twice_tells_nothing():
    assert scatter_between(drawn(7, 0.1)[:4], RECIPES[:4], STATED, KNOWN[:4]) == pytest.approx(STATED)


def test_what_a_door_with_one_hinge_does_not_tell_of_its_place_is_no_scatter():
    others, height, share = tuple("abcde"), 1.8, 0.15
    # A hinge high up tells where it lies itself: a turn about the corner moves it along y.
    own = np.array([[-height, 0.0, 1.0]]).T * 6e-5
    error = KNOWN + np.diag([2e-6, 2e-6, 1e-6]) ** 2
    error[2] += own @ own.T
    found, taken = [], []
    for seed in range(400):
        rng = np.random.default_rng(seed)
        places = share * np.sqrt(STATED) * rng.standard_normal((5, 3))
        places[3:] += [1.5e-4, -5e-5, 0.0]
        places += [rng.multivariate_normal(np.zeros(3), one) for one in error]
        found.append(scatter_between(places, others, STATED, error)[0])
        taken.append(scatter_between(places, others, STATED, KNOWN)[0])
    found, taken = (np.sqrt(np.array(values) / STATED[0]) for values in (found, taken))
    assert np.mean(found < share * (1.0 - 1e-9)) < 0.09
    assert np.median(found) < 3.0 * share
    assert np.median(taken) > np.median(found) + share
