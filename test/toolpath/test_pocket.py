"""Pockets on the nominal plan: cleared, climb milled, led in and out, within the MoveC limits."""

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from doormill_ros.frames import apply, inverse
from doormill_ros.recipes.cutting import Direction, Passes
from doormill_ros.recipes.documents import load_recipe
from doormill_ros.recipes.features.hinge_pocket import LeafHinge, OutlinePoints
from doormill_ros.toolpath.cuts.operation import operation
from doormill_ros.toolpath.cuts.pocket import pocket_steps
from doormill_ros.toolpath.cuts.rings import levels, rings
from doormill_ros.toolpath.errors import ToolFitError
from doormill_ros.toolpath.program import MotionKind
from doormill_ros.toolpath.settings import load_settings
from support.doors import exactly_known

RECIPE = load_recipe("standard_door")
RECIPE = replace(RECIPE, features=tuple(map(exactly_known, RECIPE.features)))
SETTINGS = load_settings()


def planned(feature, **options):
    op = operation(feature, RECIPE.size, **options)
    return op, pocket_steps(op, SETTINGS)


def in_feature(op, points):
    return apply(inverse(op.T_door_feature), points)


def leaf(width, length, radius, diameter, depth=4.0e-3, **changes):
    hinge = RECIPE.feature("hinge_1")
    shared = {
        k: getattr(hinge, k) for k in ("id", "side", "height", "cutting", "wrench_table", "wrench_point")
    }
    tool = replace(hinge.tool, diameter=diameter)
    passes = changes.pop("passes", Passes(depth_step=2e-3, finish_allowance=0.0))
    return LeafHinge(
        **shared, backset=0.05, width=width, length=length, depth=depth, corner_radius=radius, tool=tool,
        passes=passes, **changes,
    )  # fmt: skip


@given(st.floats(1e-3, 0.2), st.floats(5e-4, 0.1))
def test_levels_reach_the_depth_in_equal_steps(depth, step):
    found = np.array([0.0, *levels(depth, step)])
    assert found[-1] == pytest.approx(depth)
    assert np.diff(found) == pytest.approx(np.full(len(found) - 1, depth / (len(found) - 1)))
    assert np.diff(found).max() <= step * (1 + 1e-6)


@given(st.floats(2e-3, 0.01), st.floats(0.0, 1.0), st.floats(1.05, 12.0))
def test_rings_run_from_the_middle_to_the_wall(radius, allowance, ratio):
    half = ratio * radius
    inset = min(radius + 1e-3 * allowance, half)
    found = rings(inset, half, radius)
    assert found[-1] == inset
    assert np.all(np.diff(found) < 0)
    assert np.all(-np.diff(found) <= 1.6 * radius * (1 + 1e-9))
    assert found[0] + radius > half  # the innermost reaches past the middle


@settings(max_examples=60, deadline=None)
@given(
    st.floats(0.012, 0.05),
    st.floats(1.1, 5.0),
    st.floats(0.0, 1.0),
    st.floats(0.2, 1.0),
    st.floats(0.0, 1e-3),
)
def test_every_pocket_is_cleared_and_nothing_beyond(width, ratio, roundness, tool, allowance):
    """The union of all discs is the outline: no wood in the middle, none taken outside."""
    diameter = min(tool * 0.95 * width, width - 1.1e-3)
    radius = diameter / 2 + roundness * (width / 2 - diameter / 2) * 0.98
    feature = leaf(width, ratio * width, radius, diameter, passes=Passes(2e-3, allowance))
    op, steps = planned(feature)
    ways = []
    for step in steps:
        points = in_feature(op, step.curve.points(np.linspace(0, 1, 40 if step.curve.is_arc else 2)))
        if points[:, 2].min() > 4e-3 - 1e-9:
            ways.append(shapely.LineString(points[:, :2]))
    swept = shapely.union_all(shapely.buffer(ways, diameter / 2, quad_segs=32))
    outline = feature.outline().polygon(chord_error=1e-6)
    assert outline.buffer(-2e-5).difference(swept).area < 1e-10
    assert swept.difference(outline.buffer(2e-5)).area < 1e-10


@pytest.mark.parametrize(
    ("diameter", "width", "length", "corner"),
    [
        (12e-3, 13e-3, 13.01e-3, 6.01e-3),
        (10e-3, 11e-3, 11e-3, 5.01e-3),
        (8e-3, 9e-3, 9e-3, 4e-3),
        (40e-3, 41e-3, 41e-3, 20e-3),
    ],
)
def test_the_way_out_of_a_small_pocket_leaves_its_wall_alone(diameter, width, length, corner):
    """Where the straight is hardly longer than lead-in and lead-out the mill turns away before its end."""
    feature = leaf(width, length, corner, diameter, passes=Passes(5e-3, 1e-3))
    op, steps = planned(feature)
    points = [in_feature(op, step.curve.points(np.linspace(0, 1, 80))) for step in steps]
    ways = [shapely.LineString(p[:, :2]) for p in points if p[:, 2].min() > 4e-3 - 1e-9]
    swept = shapely.union_all(shapely.buffer(ways, diameter / 2, quad_segs=64))
    beyond = swept.difference(feature.outline().polygon(chord_error=1e-7).buffer(1e-5))
    assert beyond.area < 1e-10


@pytest.mark.parametrize("direction", list(Direction))
@pytest.mark.parametrize("name", ["hinge_1", "lock_case", "handle_hole"])
def test_climb_milling_keeps_the_wood_on_the_right_of_the_travel(name, direction):
    """A spindle turning with the clock, seen from behind it, climbs when the wall is on its left side.

    Seen along the tool axis the edge in front of the tool then moves towards the wall against
    which it started at full chip: velocity of the edge at the wall is against the feed.
    """
    op, steps = planned(replace(RECIPE.feature(name), direction=direction))
    into_wood = op.T_door_feature[:3, 2]
    middle = op.T_door_feature[:3, 3]
    spin = into_wood  # clockwise seen along the axis is a right-handed turn about it
    looked_at = 0
    for step in steps:
        if not step.wall or step.curve.length < 4e-3:
            continue
        start, centre, end = step.curve.points([0.45, 0.5, 0.55])
        feed = (end - start) / np.linalg.norm(end - start)
        across = np.cross(into_wood, feed)
        to_wall = across * -np.sign(across @ (middle - centre))
        edge = np.cross(spin, to_wall)  # velocity of the edge where it meets the wall
        sign = -1.0 if direction is Direction.CLIMB else 1.0
        if abs(across @ (middle - centre)) > 1e-4:
            assert sign * (edge @ feed) > 0.99
            looked_at += 1
    assert looked_at >= 2


@pytest.mark.parametrize("name", [f.id for f in RECIPE.features])
def test_steps_join_and_start_and_end_in_front(name):
    op, steps = planned(RECIPE.feature(name))
    for before, after in itertools.pairwise(steps):
        assert np.linalg.norm(before.curve.end - after.curve.start) < 1e-9
    ends = in_feature(op, np.array([steps[0].curve.end, steps[-1].curve.end]))
    assert ends[:, 2] == pytest.approx([-SETTINGS.approach.clearance] * 2)
    assert not steps[0].cutting
    assert not steps[-1].cutting


def tangent(curve, fraction, small=1e-5):
    a, b = (fraction, fraction + small) if fraction < 0.5 else (fraction - small, fraction)
    start, end = curve.points([a, b])
    return (end - start) / np.linalg.norm(end - start)


@pytest.mark.parametrize("name", [f.id for f in RECIPE.features])
def test_the_wall_is_entered_and_left_along_its_tangent(name):
    """Lead-in and lead-out are arcs inside the pocket; between them nothing turns sharply."""
    op, steps = planned(RECIPE.feature(name))
    runs, run = [], []
    for step in steps:
        if step.wall:
            run.append(step)
        elif run:
            runs.append(run)
            run = []
    assert runs
    for run in runs:
        assert run[0].curve.is_arc
        assert run[-1].curve.is_arc
        for before, after in itertools.pairwise(run):
            assert tangent(before.curve, 1.0) @ tangent(after.curve, 0.0) > 1 - 1e-6
        feature = op.feature
        path = feature.outline(feature.tool.radius).polygon(chord_error=1e-7)
        for at in (run[0].curve.start, run[-1].curve.end):
            point = shapely.Point(in_feature(op, at[None])[0, :2])
            assert path.contains(point)
            assert path.exterior.distance(point) > 4e-4


def test_nothing_left_to_cut_means_no_force():
    """Where the wall pass runs past its start, and on the way out, the wrench is zero."""
    _, steps = planned(RECIPE.feature("hinge_1"))
    last = [s for s in steps if s.wall][-3:]
    idle = [s for s in steps if s.wall and not s.wrench_tool.any()]
    assert idle[-1] is last[-1]
    assert sum(s.curve.length for s in idle[:-1]) == pytest.approx(0.005, abs=1e-6)


def test_finishing_is_one_pass_at_full_depth_after_roughing():
    hinge = replace(RECIPE.feature("hinge_1"), passes=Passes(depth_step=2e-3, finish_allowance=3e-4))
    op, steps = planned(hinge)
    walls = [s for s in steps if s.wall]
    assert {round(in_feature(op, s.curve.end[None])[0, 2], 9) for s in walls} == {0.005}
    first = next(i for i, s in enumerate(steps) if s.wall)
    assert not any(s.cutting and not s.wall for s in steps[first + len(walls) :])
    rough = [in_feature(op, s.curve.points(np.linspace(0, 1, 20)))[:, :2] for s in steps[:first] if s.cutting]
    outline = hinge.outline().polygon(chord_error=1e-7).exterior
    nearest = outline.distance(shapely.MultiPoint(np.concatenate(rough)))
    assert nearest == pytest.approx(hinge.tool.radius + 3e-4, abs=1e-6)


def test_sharp_corners_of_the_path_are_stopped_at():
    """A corner radius equal to the tool's leaves the path a corner: a fly-by would cut it off."""
    _, steps = planned(leaf(0.03, 0.08, 0.0095, 0.019))
    walls = [i for i, s in enumerate(steps) if s.wall]
    corners = 0
    for i in walls[:-1]:
        if i + 1 in walls:
            turn = tangent(steps[i].curve, 1.0) @ tangent(steps[i + 1].curve, 0.0)
            assert (steps[i].zone == "fine") == (turn < math.cos(math.radians(5)))
            corners += turn < 0.5
    assert corners == 4 * 2  # four a level


def test_nine_points_keep_the_middles_of_the_lines():
    hinge = RECIPE.feature("hinge_1")
    op, steps = planned(replace(hinge, points=OutlinePoints.NINE))
    ends = in_feature(op, np.array([s.curve.end for s in steps if s.wall]))[:, :2]
    inset = hinge.width / 2 - hinge.tool.radius
    for middle in ([inset, 0.0], [-inset, 0.0]):
        assert np.linalg.norm(ends - middle, axis=1).min() < 1e-9


def test_a_tool_that_is_too_wide_is_refused():
    with pytest.raises(
        ToolFitError, match=r"hinge_1: the tool mill_16 is 40 mm wide, allowed are 30 mm"
    ) as error:
        planned(leaf(0.03, 0.08, 0.0095, 0.040))
    assert error.value.code == 305
    assert error.value.data["feature"] == "hinge_1"


def test_arcs_stay_arcs():
    _, steps = planned(RECIPE.feature("hinge_1"))
    for step in steps:
        assert (step.kind is MotionKind.CIRCULAR) == step.curve.is_arc
        if step.curve.is_arc:
            assert step.curve.sweep <= math.pi + 1e-9
    turns = [s for s in steps if s.wall and s.curve.is_arc and s.curve.length > 0.01]
    assert len(turns) == 2
