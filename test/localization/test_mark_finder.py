"""Dots are found where light says that they are; nothing else is taken for one."""

from __future__ import annotations

import numpy as np
import pytest

from doormill_ros.localization.marks.mark_finder import find_marks

RADIUS = 14.0
FINE = 8


def dot(
    centre: tuple[float, float], wall: float = 60.0, white: float = 190.0, stretch: float = 1.0
) -> np.ndarray:
    """A dot on its ring in a picture of 150 x 170 px, each pixel the mean of 64 places."""
    v, u = (np.mgrid[: 150 * FINE, : 170 * FINE] + 0.5) / FINE - 0.5
    away = np.hypot(u - centre[0], (v - centre[1]) * stretch)
    light = np.where(away < RADIUS, white, np.where(away < 2 * RADIUS, 12.0, wall))
    return light.reshape(150, FINE, 170, FINE).mean(axis=(1, 3))


def exposed(light: np.ndarray, noise: float = 0.0, seed: int = 0) -> np.ndarray:
    light = light + np.random.default_rng(seed).normal(0.0, noise, light.shape) if noise else light
    return np.clip(np.rint(light), 0, 255).astype(np.uint8)


@pytest.mark.parametrize("wall", [10.0, 60.0, 120.0, 190.0, 250.0])
@pytest.mark.parametrize("centre", [(70.0, 60.0), (70.37, 59.81), (76.5, 52.2)])
def test_a_dot_is_found_to_a_fiftieth_of_a_pixel(wall: float, centre: tuple[float, float]) -> None:
    ((u, v),) = find_marks(exposed(dot(centre, wall), 2.0), np.array([[70.0, 60.0]]), np.array([RADIUS]))
    assert np.hypot(u - centre[0], v - centre[1]) < 0.02


def test_light_that_falls_off_moves_it_little() -> None:
    shade = np.linspace(0.8, 1.2, 170)[None]  # five times what the workshop's lamps do across a dot
    ((u, v),) = find_marks(exposed(dot((70.3, 60.2)) * shade), np.array([[70.0, 60.0]]), np.array([RADIUS]))
    assert np.hypot(u - 70.3, v - 60.2) < 0.4
    assert abs(v - 60.2) < 0.02


@pytest.mark.parametrize(
    "light",
    [
        np.full((150, 170), 90.0),
        dot((70.0, 60.0), white=20.0),
        dot((70.0, 60.0), stretch=2.0),
        dot((110.0, 60.0)),
        dot((137.0, 60.0)),
        np.where(np.arange(170)[None] > 70, 200.0, 30.0) * np.ones((150, 1)),
    ],
    ids=["nothing", "faint", "no circle", "too far", "cut", "edge"],
)
def test_what_is_no_dot_is_not_found(light: np.ndarray) -> None:
    assert np.isnan(find_marks(exposed(light, 1.0), np.array([[70.0, 60.0]]), np.array([RADIUS]))).all()


@pytest.mark.parametrize("at", [(-50.0, 60.0), (1e9, 1e9), (np.nan, 3.0), (0.0, 0.0)])
def test_places_out_of_the_picture_are_not_looked_at(at: tuple[float, float]) -> None:
    assert np.isnan(find_marks(exposed(dot((70.0, 60.0))), np.array([at]), np.array([RADIUS]))).all()
