"""Doors that stand elsewhere by no cause that is named: where the next one will, and that the path undoes it."""

import numpy as np
import pytest

from doormill_ros.diagnosis.parts.correction.in_use import in_use_document
from doormill_ros.diagnosis.parts.correction.level import Level, current_level
from doormill_ros.diagnosis.parts.correction.standing import level_left, standing_of
from doormill_ros.diagnosis.parts.kind import Inspections
from support.gauged_shift import SCATTER
from support.random_shift import PLACING, next_doors, random_doors, random_shift
from support.shift_loop import knowing, loop_worth
from support.shift_worlds import draw_shift

DOORS, STEP = 12, 8
MOVED = np.array([1e-4, -5e-5, 0.0])
OWN = np.diag(SCATTER) ** 2


def level_of(places):
    found, covariance, since = current_level(places, np.tile(OWN, (len(places), 1, 1)), PLACING)
    return Level(found, covariance, np.zeros(3), since)


def scattered(seed):
    return np.random.default_rng(seed).normal(0.0, SCATTER, (DOORS, 3))


def test_a_level_is_that_of_the_doors_since_it_stepped():
    places = scattered(1)
    places[STEP:] += MOVED
    level = level_of(places)
    assert level.since == STEP
    assert level.seen
    assert np.all(np.abs(level.place - MOVED) < 3.0 * np.sqrt(np.diag(level.covariance)))
    assert level.place == pytest.approx(places[STEP:].mean(axis=0), abs=1e-6)


def test_a_level_that_never_stepped_is_that_of_all_doors():
    level = level_of(scattered(2) + MOVED)
    assert level.since == 0
    assert level.place == pytest.approx((scattered(2) + MOVED).mean(axis=0), abs=3e-6)


def test_the_scatter_of_doors_is_hardly_ever_a_level():
    assert sum(level_of(scattered(seed)).seen for seed in range(500)) <= 3


def test_what_a_level_displaces_is_known_as_well_as_shift_and_turn_are():
    covariance, corner = np.diag([4e-12, 9e-12, 1e-12]), np.array([1.0, 2.0, 3.0])
    level = Level(np.zeros(3), covariance, corner, 0)
    points = corner + np.array([[5.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 4.0]])
    assert level.std(points) == pytest.approx(np.sqrt(13e-12 + (4e-12 + 16e-12) / 3.0))


#: Shifts whose camera or clamp moved two doors before the end: not named, or named as a link that is confusable.
UNNAMED = {"camera": 8270, "clamp beside a weight": 8382, "clamp as a link": 8410}


def asked(folder, seed):
    drawn = draw_shift(seed, longest=40)
    doors = random_shift(folder, drawn.world, random_doors(seed, len(drawn.doors)), seed)
    return drawn, Inspections().diagnose(doors, lambda line: None)


@pytest.mark.parametrize("label", UNNAMED)
def test_doors_that_stand_elsewhere_are_milled_there_though_nothing_is_named(label, tmp_path):
    seed = UNNAMED[label]
    drawn, diagnosis = asked(tmp_path, seed)
    keys = {finding.cause.key for finding in diagnosis.findings}
    shifts = [one for one in drawn.hidden if one.cause in ("camera_shift", "clamp_shift")]
    assert not any((one.cause, one.where) in keys for one in shifts)
    level, standing = level_left(diagnosis), standing_of(diagnosis)
    moved = np.array(drawn.world.get("camera", {}).get("moved") or drawn.world["clamp"]["shift"])
    assert level.since in (shifts[0].from_door, shifts[0].from_door + 1)
    at_corner = np.array(standing.shift) + np.cross([standing.turn, 0.0, 0.0], level.corner)
    assert np.linalg.norm(at_corner - moved) < 0.35 * np.linalg.norm(moved)
    judged = in_use_document(diagnosis, "", level.since)
    assert judged["expected_error_extended"] < judged["expected_error"]
    worth = loop_worth(tmp_path, diagnosis, len(drawn.doors), seed, knowing(), doors=next_doors(seed))
    assert not worth.worse
    assert worth.after < 2.0 * worth.told
