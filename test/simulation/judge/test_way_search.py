"""The search that refusals are held against finds what is there, and only that."""

import dataclasses
import itertools

import numpy as np
import pytest

from doormill_ros.cell.places.layout import DoorOffset, load_layout
from doormill_ros.frames import transform
from doormill_ros.simulation.judge.bodies import Box
from doormill_ros.simulation.judge.links import BASE
from support import doors
from support.way_search import CLEARANCE, WaySearch

LAYOUT = load_layout()


@pytest.fixture(scope="module")
def search():
    door = doors.door_with("hinge_oblong", 2700, 800, 40)
    high = door.features[0].__class__(**{**vars(door.features[0]), "height": 1.5})
    T_base_door = LAYOUT.T_base_door(door.width, door.thickness, DoorOffset())
    return WaySearch(door, T_base_door), high


@pytest.fixture(scope="module")
def postures(search):
    one, feature = search
    return one.postures(feature)[0]


def test_a_way_leads_from_home_to_the_feature_and_is_free(search, postures):
    one, feature = search
    assert len(postures) >= 1
    goal = postures[np.argmin(np.abs(postures - one.home).max(axis=1))]
    way = one.way(goal, feature.tool.radius, tries=60)
    assert np.array_equal(way[0], one.home)
    assert np.array_equal(way[-1], goal)
    dense = np.concatenate([np.linspace(a, b, 400) for a, b in itertools.pairwise(way)])
    assert one.gap(dense, feature.tool.radius).min() > 0.5 * CLEARANCE


def test_postures_stand_in_front_of_the_feature(search, postures):
    one, feature = search
    assert len(postures) >= 1
    T = one.arm.forward(postures) @ one.cell.T_flange_tool
    in_feature = np.linalg.inv(one.T_base_door @ one.recipe.T_door_feature(feature)) @ T
    assert np.allclose(in_feature[:, 2, 3], -0.030, atol=1e-9)
    assert np.allclose(in_feature[:, 2, 2], 1.0, atol=1e-9)


def test_what_is_out_of_reach_has_no_posture(search):
    one, feature = search
    far = WaySearch(one.recipe, transform(translation=[2.0, 0.0, 0.0]) @ one.T_base_door)
    assert far.serves(feature) == "no posture: reach 192"


def test_no_way_leads_through_a_wall(search, postures):
    one, feature = search
    wall = Box("wall", BASE, transform(translation=[1.45, 0.0, 1.0]), np.array([0.02, 3.0, 3.0]))
    walled = WaySearch(one.recipe, one.T_base_door)
    walled.cell = dataclasses.replace(walled.cell, obstacles=(wall,))
    assert walled.way(postures[0], feature.tool.radius, tries=20) is None
