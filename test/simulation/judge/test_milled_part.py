"""The judge against paths whose milled outline is known beforehand."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis.strategies import floats
from scipy.spatial.transform import Rotation

from doormill_ros.cell.places.layout import DoorOffset, load_layout
from doormill_ros.frames import transform
from doormill_ros.recipes.documents import load_recipe
from doormill_ros.simulation.controller.records.executed_path import ExecutedPath
from doormill_ros.simulation.judge.milled_part import inspect

RADIUS, WIDTH, LENGTH, DEPTH = 0.0095, 0.030, 0.120, 0.005  # hinge of the thesis doors
OUTSIDE = -0.03  # z of the feature frame: in front of the wood
R_FEATURE_TOOL = np.array([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])


@pytest.fixture(scope="module")
def hinge():
    recipe = load_recipe("thesis_190_0deg")
    return replace(recipe, features=recipe.features[:1])


@pytest.fixture(scope="module")
def T_base_door(hinge):
    return load_layout().T_base_door(hinge.width, hinge.thickness, DoorOffset(0.003, -0.006, 0.03))


def oblong(radius, straight=LENGTH / 2 - WIDTH / 2, n=1500):
    """Closed path round an oblong, made here from its definition; shape (m, 2)."""
    angle = np.linspace(math.pi, 0.0, n)
    top = np.column_stack([radius * np.cos(angle), straight + radius * np.sin(angle)])
    return np.concatenate([top, -top, top[:1]])


def executed(recipe, T_base_door, xy, depth=DEPTH, tilt=None, feature="hinge_1"):
    """Plunge, follow the points, draw back."""
    depths = np.broadcast_to(depth, len(xy))
    points = np.column_stack([xy, depths])
    points = np.concatenate([[[*xy[0], OUTSIDE]], points, [[*xy[-1], OUTSIDE]]])
    T_feature_tool = np.tile(np.eye(4), (len(points), 1, 1))
    T_feature_tool[:, :3, :3] = (
        R_FEATURE_TOOL if tilt is None else Rotation.from_rotvec(tilt).as_matrix() @ R_FEATURE_TOOL
    )
    T_feature_tool[:, :3, 3] = points
    T = T_base_door @ recipe.T_door_feature(recipe.features[0]) @ T_feature_tool
    n = len(points)
    cutting = np.ones(n, dtype=bool)
    cutting[[0, -1]] = False
    return ExecutedPath(
        np.arange(n), T, T, np.zeros((n, 6)), np.zeros(n), cutting, np.full(n, feature), np.zeros((n, 6))
    )


@pytest.mark.parametrize("error", [0.0, 1e-6, -1e-6, 25e-6, -0.0004])
def test_uniform_error_is_read_to_a_tenth_of_a_micrometre(hinge, T_base_door, error):
    """A path `error` too far out everywhere takes that much too much wood everywhere."""
    path = executed(hinge, T_base_door, oblong(WIDTH / 2 - RADIUS + error))
    result = inspect(hinge, T_base_door, path).feature("hinge_1")
    assert result.milled
    assert result.deviation == pytest.approx(np.full(len(result.points), error), abs=1e-7)
    assert result.uncleared == 0.0


@pytest.mark.parametrize("shift", [(1e-6, 0.0), (0.0, 1e-6), (3e-5, -2e-5)])
def test_a_shifted_path_reads_the_shift_along_the_normal(hinge, T_base_door, shift):
    path = executed(hinge, T_base_door, oblong(WIDTH / 2 - RADIUS) + shift)
    result = inspect(hinge, T_base_door, path).feature("hinge_1")
    middle = np.clip(result.points[:, 1], -0.045, 0.045)
    normal = result.points - np.column_stack([np.zeros(len(middle)), middle])
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    assert result.deviation == pytest.approx(normal @ shift, abs=1.5e-7)


def test_a_door_that_is_not_where_it_is_believed_shows(hinge, T_base_door):
    """Milled for one place while the door stands 40 um higher."""
    path = executed(hinge, T_base_door, oblong(WIDTH / 2 - RADIUS))
    higher = T_base_door.copy()
    higher[2, 3] += 40e-6
    result = inspect(hinge, higher, path).feature("hinge_1")
    top, bottom = result.points[:, 1].argmax(), result.points[:, 1].argmin()
    expected = 40e-6 * math.cos(0.03)
    assert result.deviation[[top, bottom]] == pytest.approx([-expected, expected], abs=2e-7)


def test_a_leaning_tool_cuts_a_leaning_wall(hinge, T_base_door):
    """Tip on the nominal path, axis tilted about y: above the floor the wall moves with the height."""
    angle = 1e-3
    path = executed(hinge, T_base_door, oblong(WIDTH / 2 - RADIUS), tilt=[0.0, angle, 0.0])
    result = inspect(hinge, T_base_door, path).feature("hinge_1")
    right = np.argmin(np.linalg.norm(result.points - [WIDTH / 2, 0.0], axis=1))
    above = DEPTH - result.depths
    # The axis points along (sin a, 0, cos a): behind the tip the tool stands to the left.
    assert result.by_depth[:, right] == pytest.approx(-above * math.tan(angle), abs=2e-8)


def test_floor_is_measured_apart_from_the_wall(hinge, T_base_door):
    xy = oblong(WIDTH / 2 - RADIUS)
    depth = DEPTH + np.where(xy[:, 1] > 0.0, 50e-6, -30e-6)
    result = inspect(hinge, T_base_door, executed(hinge, T_base_door, xy, depth)).feature("hinge_1")
    assert result.floor == pytest.approx((-30e-6, 50e-6), abs=1e-7)
    assert result.max_deviation < 1e-6


@pytest.mark.parametrize("shallow", [0.0, 2e-4, 2.6e-4, 3e-4, 1e-3])
@pytest.mark.parametrize("aside", [0.0, 3e-4, 9e-4])
def test_a_shallow_floor_is_no_worse_than_it_is_shallow(hinge, T_base_door, shallow, aside):
    """A door that stands off along and across the tool is off by the larger of both, and not by the way to anything."""
    lean = 1e-3
    path = executed(
        hinge,
        T_base_door,
        oblong(WIDTH / 2 - RADIUS) + np.array([aside, 0.0]),
        DEPTH - shallow,
        tilt=[0.0, lean, 0.0],
    )
    result = inspect(hinge, T_base_door, path).feature("hinge_1")
    leaning = math.tan(lean) * DEPTH
    assert result.milled
    assert result.worst == pytest.approx(max(shallow, aside), abs=2e-6 + leaning)
    assert result.floor == pytest.approx((-shallow, -shallow), abs=2e-6)
    assert result.max_deviation < max(shallow, aside) + 2e-6 + leaning
    assert result.by_depth.max() == pytest.approx(aside, abs=2e-6 + leaning)
    assert result.uncleared == pytest.approx(0.0, abs=1e-9) or aside > 4e-4


@settings(max_examples=20)
@given(high=floats(0.0, 1e-3), low=floats(-3e-4, 1e-3), aside=floats(-1e-3, 1e-3), along=floats(-1e-3, 1e-3))
def test_an_uneven_floor_is_as_shallow_as_its_shallowest_place(hinge, T_base_door, high, low, aside, along):
    """One half less deep than the other, and both off to the side: the walls are not off by more than that."""
    xy = oblong(WIDTH / 2 - RADIUS, n=300)
    depth = DEPTH - np.where(xy[:, 1] > 0.0, high, low)
    path = executed(hinge, T_base_door, xy + np.array([aside, along]), depth)
    result = inspect(hinge, T_base_door, path).feature("hinge_1")
    walls = math.hypot(aside, along) if abs(along) > 2e-6 else abs(aside)
    assert result.worst == pytest.approx(max(abs(high), abs(low), walls), abs=5e-6)


def test_a_pocket_of_half_the_depth_or_half_the_length_is_grossly_wrong(hinge, T_base_door):
    xy = oblong(WIDTH / 2 - RADIUS)
    half = inspect(hinge, T_base_door, executed(hinge, T_base_door, xy, DEPTH / 2.0)).features[0]
    assert half.worst == pytest.approx(DEPTH / 2.0, abs=2e-6)
    assert half.max_deviation > 0.4 * DEPTH
    short = inspect(hinge, T_base_door, executed(hinge, T_base_door, np.minimum(xy, [1.0, 0.02]))).features[0]
    assert short.max_deviation == pytest.approx(WIDTH / 2 + 0.025 - RADIUS, abs=1e-6)
    # Its upper end is not milled, and what is milled lacks 0.3 mm of its depth.
    both = executed(hinge, T_base_door, np.minimum(xy, [1.0, 0.02]), DEPTH - 3e-4)
    assert inspect(hinge, T_base_door, both).features[0].max_deviation > 0.03


def test_wood_that_stands_in_the_corner_of_floor_and_wall_is_the_walls(hinge, T_base_door):
    """Cut to its depth well inside the wall only, and at the wall 1 mm less deep."""
    inside, wall = (oblong(WIDTH / 2 - RADIUS - left) for left in (3e-4, 0.0))
    xy = np.concatenate([inside, wall])
    depth = np.repeat([DEPTH, DEPTH - 1e-3], [len(inside), len(wall)])
    result = inspect(hinge, T_base_door, executed(hinge, T_base_door, xy, depth)).features[0]
    assert result.worst == pytest.approx(3e-4, abs=2e-6)


def test_one_short_gouge_is_found(hinge, T_base_door):
    """A tool pushed 20 um into the wall at one point only."""
    xy = oblong(WIDTH / 2 - RADIUS)
    at = len(xy) // 5
    outwards = xy[at] - [0.0, 0.045]
    dent = xy[at] + 20e-6 * outwards / np.linalg.norm(outwards)
    xy = np.concatenate([xy[: at + 1], [dent], xy[at:]])
    result = inspect(hinge, T_base_door, executed(hinge, T_base_door, xy)).feature("hinge_1")
    assert result.max_deviation == pytest.approx(20e-6, abs=1e-6)


def test_wood_left_in_the_middle_counts_as_uncleared():
    """A contour alone round a wide pocket leaves an island of known size."""
    recipe = load_recipe("thesis_190_0deg")
    wide = replace(recipe.features[0], width=0.060, backset=0.050)
    recipe = replace(recipe, features=(wide,))
    T_base_door = load_layout().T_base_door(recipe.width, recipe.thickness)
    path = executed(recipe, T_base_door, oblong(0.030 - RADIUS, straight=0.030))
    result = inspect(recipe, T_base_door, path).feature("hinge_1")
    left = 0.030 - 2 * RADIUS  # half the width of the island: its outline is two tool radii inside
    island = math.pi * left**2 + 2 * left * 0.060
    assert result.max_deviation < 1e-6
    assert result.uncleared == pytest.approx(island, rel=1e-3)


def test_a_feature_that_was_never_milled_says_so(hinge, T_base_door):
    path = executed(hinge, T_base_door, oblong(WIDTH / 2 - RADIUS), depth=-0.001)
    part = inspect(hinge, T_base_door, path)
    assert not part.features[0].milled
    assert part.max_deviation > WIDTH / 2 * 0.99
    other = executed(hinge, T_base_door, oblong(WIDTH / 2 - RADIUS), feature="hinge_2")
    assert not inspect(hinge, T_base_door, other).features[0].milled


def test_a_hole_from_both_sides_needs_both_robots():
    """Each robot mills half a hole in its own base frame; the far one 30 um off to the side."""
    recipe = load_recipe("standard_door")
    hole = recipe.feature("handle_hole")
    recipe = replace(recipe, features=(hole,))
    T_base_door = load_layout().T_base_door(recipe.width, recipe.thickness)
    ring = oblong(hole.diameter / 2 - hole.tool.radius, straight=0.0)
    near = executed(recipe, T_base_door, ring, depth=0.021, feature="handle_hole")
    alone = inspect(recipe, T_base_door, near)
    assert not alone.features[0].milled
    T_first_second = transform(Rotation.from_euler("z", math.pi).as_matrix(), [3.2, 0.7, 0.1])
    far = executed(recipe, np.eye(4), ring + np.array([30e-6, 0.0]), depth=0.021, feature="handle_hole")
    # The far robot comes from the rear: half a turn about the feature's y axis at the other face.
    T_door_feature = recipe.T_door_feature(hole)
    turn = transform(np.diag([-1.0, 1.0, -1.0]), [0.0, 0.0, recipe.thickness])
    T_second_door = np.linalg.inv(T_first_second) @ T_base_door
    far = replace(
        far,
        T_base_tool=T_second_door @ T_door_feature @ turn @ np.linalg.inv(T_door_feature) @ far.T_base_tool,
    )
    both = inspect(recipe, T_base_door, near, others=[(T_second_door, far)]).features[0]
    assert both.milled
    assert both.by_depth[0].max() < 1e-6
    # Its own x axis points the other way: towards negative x of the feature.
    left, right = both.points[:, 0].argmin(), both.points[:, 0].argmax()
    assert both.by_depth[-1][[left, right]] == pytest.approx([30e-6, -30e-6], abs=5e-7)


def test_executed_path_refuses_what_is_no_path():
    pose = np.tile(np.eye(4), (3, 1, 1))
    path = {
        "time": np.arange(3.0),
        "T_base_tool": pose,
        "T_base_tool_commanded": pose,
        "q": np.zeros((3, 6)),
        "motion": np.zeros(3),
        "cutting": np.zeros(3, bool),
        "feature": np.array(["", "a", "a"]),
        "wrench": np.zeros((3, 6)),
    }
    assert len(ExecutedPath(**path)) == 3
    for key, value, words in (
        ("time", np.array([0.0, 2.0, 1.0]), "runs backwards"),
        ("q", np.zeros((2, 6)), "q has shape"),
        ("wrench", np.full((3, 6), np.nan), "not finite"),
    ):
        with pytest.raises(ValueError, match=words):
            ExecutedPath(**{**path, key: value})
    kept = ExecutedPath(**path)
    with pytest.raises(ValueError, match="read-only"):
        kept.q[0] = 1.0
