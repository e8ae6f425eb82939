"""How far doors scatter, told by very few of them."""

import numpy as np
import pytest

from doormill_ros.diagnosis.parts.fitting.place_scatter import place_error, scatter_between
from doormill_ros.diagnosis.parts.fitting.placement import seen_columns

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
    others, share, noise = tuple("abcde"), 0.15, 1e-5
    columns = [
        hinged(noise, *heights) for heights in ([0.3, 1.5], [0.4, 1.2], [1.7], [0.3, 1.0, 1.8], [0.2, 1.8])
    ]
    error = np.array([place_error(one, STATED) for one in columns])
    found, taken = [], []
    for seed in range(400):
        rng = np.random.default_rng(seed)
        places = share * np.sqrt(STATED) * rng.standard_normal((5, 3))
        places[3:] += [1.5e-4, -5e-5, 0.0]
        off = [
            one @ place + rng.standard_normal(len(one)) for one, place in zip(columns, places, strict=True)
        ]
        seen = np.array([np.linalg.lstsq(*pair, rcond=None)[0] for pair in zip(columns, off, strict=True)])
        found.append(scatter_between(seen, others, STATED, error)[0])
        taken.append(scatter_between(seen, others, STATED, KNOWN)[0])
    found, taken = (np.sqrt(np.array(values) / STATED[0]) for values in (found, taken))
    assert np.mean(found < share * (1.0 - 1e-9)) < 0.09
    assert np.median(found) < 3.0 * share
    assert np.median(taken) > np.median(found) + share


def test_a_direction_that_no_point_tells_is_not_told():
    assert np.all(np.isfinite(place_error(np.zeros((4, 3)), STATED)))
    assert place_error(hinged(1e-5, 0.2, 1.8), STATED)[0, 0] < 1e-2 * STATED[0]
    assert place_error(hinged(1e-5, 1.8), STATED)[0, 0] > STATED[0]


def hinged(noise, *heights):
    """What the place of a door does to walls of hinges at heights [m], whitened, shape (n, 3)."""
    sides = [
        ([0.0, side * 0.01, z], [0.0, side, 0.0])
        for side in (-1.0, 1.0)
        for z in np.linspace(-0.05, 0.05, 30)
    ]
    ends = [
        ([0.0, y, end * 0.05], [0.0, 0.0, end]) for end in (-1.0, 1.0) for y in np.linspace(-0.01, 0.01, 6)
    ]
    point, normal = np.moveaxis(np.array(sides + ends), 1, 0)
    found = [seen_columns(point + np.array([0.0, 0.0, height]), normal, np.zeros(3)) for height in heights]
    return np.concatenate(found) / noise
