"""A step in where doors stand is told from recipes that differ, from warmth and from scatter."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from doormill_ros.diagnosis.parts.fitting.place_scatter import chance_of_places
from doormill_ros.diagnosis.parts.fitting.place_step import place_step
from support.shift_worlds import diagnosed, draw_shift, judged

SCATTER = 1e-5  # m, m, rad
RECIPES = ("narrow", "wide", "turned")


def _places(rng: np.random.Generator, count: int, *, warm: bool) -> tuple[np.ndarray, list[str]]:
    """Doors of three recipes, each with an offset of its own, in a cell that may warm up."""
    recipe = rng.integers(0, len(RECIPES), count)
    offset = rng.normal(0.0, 5e-5, (len(RECIPES), 3))
    growth = rng.normal(0.0, 5e-5, 3) * (1.0 - np.exp(-np.arange(count) / 20.0))[:, None] * warm
    return offset[recipe] + growth + rng.normal(0.0, SCATTER, (count, 3)), [RECIPES[k] for k in recipe]


@pytest.mark.parametrize("warm", [False, True])
def test_doors_that_stand_alike_show_no_step(warm: bool) -> None:
    rng = np.random.default_rng(41)
    found = [place_step(*_places(rng, int(rng.integers(8, 40)), warm=warm)) for _ in range(300)]
    assert np.count_nonzero(found) <= 3


@pytest.mark.parametrize("warm", [False, True])
def test_a_step_of_ten_times_the_scatter_is_found_at_its_door(warm: bool) -> None:
    rng = np.random.default_rng(42)
    away = []
    for _ in range(200):
        places, recipes = _places(rng, int(rng.integers(16, 40)), warm=warm)
        begins = int(rng.integers(4, len(places) - 3))
        way = rng.normal(size=3)
        places[begins:] += 10.0 * SCATTER * way / np.linalg.norm(way)
        away.append(abs(place_step(places, recipes) - begins))
    assert np.mean(np.array(away) <= 1) >= 0.95


def test_another_recipe_is_no_step() -> None:
    rng = np.random.default_rng(43)
    recipes = ["narrow"] * 8 + ["wide"] * 8
    places = np.repeat([[0.0] * 3, [1e-3] * 3], 8, axis=0) + rng.normal(0.0, SCATTER, (16, 3))
    assert place_step(places, recipes) == 0
    assert place_step(places, ["narrow"] * 16) == 8


@pytest.mark.parametrize("count", [0, 1, 2, 5])
def test_few_doors_show_none(count: int) -> None:
    assert place_step(np.arange(3.0 * count).reshape(count, 3), ["narrow"] * count) == 0


def test_places_that_scatter_more_than_they_are_taken_to_are_no_chance() -> None:
    rng = np.random.default_rng(44)
    variance = np.full(3, SCATTER**2)
    chances = [
        chance_of_places(rng.normal(0.0, SCATTER, (12, 3)), variance, np.zeros((12, 3, 3)))
        for _ in range(400)
    ]
    assert 0.02 <= np.mean(np.array(chances) < 0.05) <= 0.09
    moved = rng.normal(0.0, SCATTER, (5, 3))
    moved[3:, 0] += 1e-4
    assert chance_of_places(moved, variance, np.zeros((5, 3, 3))) < 1e-6


@pytest.mark.parametrize("seed", [875, 896])
def test_a_camera_that_moved_in_the_last_doors_is_found_beside_what_else_is_wrong(
    seed: int, tmp_path: Path
) -> None:
    # 875: with a gap and a force from the same one of five doors on. 896: in the last 4 of 44 doors of a warming cell.
    drawn = draw_shift(seed)
    found = judged(diagnosed(tmp_path / "shift", drawn, seed), drawn.hidden)
    assert "camera_shift" in {one.cause for one in drawn.hidden}
    assert (found.missed, found.wrong, found.late) == ((), (), ())
