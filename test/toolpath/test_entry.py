"""Ramps and helices: never steeper than told, on the contour, and the whole contour is milled from where they end."""

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from doormill_ros.frames import inverse
from doormill_ros.recipes.cutting import Passes
from doormill_ros.recipes.documents import load_recipe
from doormill_ros.recipes.outline import RoundedRectangle
from doormill_ros.toolpath.curves.curve import Arc, Line, arc_about, arc_through
from doormill_ros.toolpath.cuts.entry import descent, straight_descent
from doormill_ros.toolpath.cuts.operation import operation
from doormill_ros.toolpath.cuts.pocket import pocket_steps
from doormill_ros.toolpath.settings import load_settings

RECIPE = load_recipe("standard_door")
INWARD = np.array([0.0, 0.0, 1.0])
ZONE = {"z0": 0.3e-3, "z1": 1e-3}  # of the controller [m]
FINE = np.linspace(0.0, 1.0, 101)


def contour(width, length, radius, depth):
    """A closed contour as one has it of an outline: lines, and arcs of half a turn at most."""
    pieces = []
    for segment in RoundedRectangle(width, length, radius).outline().segments:
        start, end = np.array([*segment.start, depth]), np.array([*segment.end, depth])
        if segment.length < 1e-7:
            continue
        if segment.centre is None:
            pieces.append((Line(start, end), segment.name))
        else:
            centre = np.array([*segment.centre, depth])
            pieces.append((replace(arc_about(start, centre, INWARD, segment.angle), end=end), segment.name))
    return pieces


def steepest(curves):
    """Of curves, from differences of their points."""
    slopes = []
    for curve in curves:
        way = np.diff(curve.points(FINE), axis=0)
        slopes.append(np.arctan2(way[:, 2], np.linalg.norm(way[:, :2], axis=1)).max())
    return max(slopes)


@given(st.integers(0, 10_000))
def test_an_arc_through_three_points_goes_through_them(number):
    start, via, end = np.random.default_rng(number).normal(size=(3, 3))
    arc = arc_through(start, via, end)
    assert arc.points([0.0, 1.0]) == pytest.approx(np.array([start, end]), abs=1e-9)
    dense = arc.points(np.linspace(0.0, 1.0, 4001))
    assert np.linalg.norm(dense - via, axis=1).min() < 1e-3 * arc.length
    assert np.linalg.norm(dense - arc.centre, axis=1) == pytest.approx(np.full(4001, arc.radius), rel=1e-6)
    assert math.dist(dense[-2], end) < arc.length / 2000.0


@settings(max_examples=150, deadline=None)
@given(
    st.floats(4e-4, 0.03),
    st.floats(1.0, 10.0),
    st.floats(0.05, 1.0),
    st.floats(5e-4, 0.04),
    st.floats(2.0, 40.0),
    st.floats(0.0, 1.0),
)
def test_a_descent_keeps_its_slope_and_leaves_a_whole_lap(width, ratio, roundness, drop, degrees, begin):
    slope, depth = math.radians(degrees), 0.05
    pieces = contour(width, ratio * width, roundness * width / 2.0, depth)
    lap = sum(curve.length for curve, _ in pieces)
    for at in (np.array([1.0, 0.0, depth - drop]), pieces[0][0].points([begin])[0] - drop * INWARD):
        found = descent(pieces, at, drop, slope, INWARD)
        assert steepest(found.ramp) <= slope + 1e-3
        assert found.slope <= slope + 1e-9
        ways = [*found.ramp, *(curve for curve, _ in found.lap)]
        for a, b in itertools.pairwise(ways):
            assert math.dist(a.points([1.0])[0], b.points([0.0])[0]) < 1e-8
        assert ways[0].start[2] == pytest.approx(depth - drop, abs=1e-9)
        assert sum(curve.length for curve, _ in found.lap) == pytest.approx(lap, abs=1e-7)
        # Seen from above a ramp never leaves the contour outwards.
        points = np.concatenate([curve.points(FINE) for curve in found.ramp])[:, :2]
        half = np.array([width, ratio * width]) / 2.0 - roundness * width / 2.0
        beyond = np.linalg.norm(np.maximum(np.abs(points) - half, 0.0), axis=1) - roundness * width / 2.0
        assert beyond.max() < 1e-8
    on_line = isinstance(pieces[0][0], Line) or begin == 0.0
    if on_line:
        assert math.dist(ways[0].start, at) < 1e-8


def test_a_straight_descent_ends_where_it_shall():
    line = straight_descent(
        np.array([0.01, 0.0, 0.005]), np.array([0.0, 1.0, 0.0]), 0.005, math.radians(20.0), INWARD
    )
    assert line.start == pytest.approx([0.01, -0.005 / math.tan(math.radians(20.0)), 0.0])
    assert math.degrees(steepest([line])) == pytest.approx(20.0)


def planned(feature, **tool):
    op = operation(replace(feature, tool=replace(feature.tool, **tool)), RECIPE.size)
    return op, pocket_steps(op, load_settings())


def into(op, step):
    """Slopes of a step into the wood."""
    way = np.diff(step.curve.points(FINE), axis=0)
    along = way @ op.T_door_feature[:3, 2]
    return np.arctan2(along, np.linalg.norm(way - np.outer(along, op.T_door_feature[:3, 2]), axis=1))


@pytest.mark.parametrize("degrees", [5.0, 20.0, 40.0])
@pytest.mark.parametrize("feature", RECIPE.features, ids=lambda f: f.id)
def test_no_cut_goes_down_steeper_than_the_tool_may(feature, degrees):
    op, steps = planned(feature, max_ramp=math.radians(degrees))
    cuts = [step for step in steps if step.cutting]
    assert max(into(op, step).max() for step in cuts) <= math.radians(degrees) + 1e-3
    assert any(step.kind_of_feature and into(op, step).max() > math.radians(1.0) for step in cuts)
    # What goes down is no faster along the tool's axis than the plunge feed.
    plunge = feature.cutting.plunge(feature.tool)
    assert all(step.speed * math.sin(max(into(op, step).max(), 0.0)) <= 1.6 * plunge for step in cuts)


@pytest.mark.parametrize("feature", RECIPE.features, ids=lambda f: f.id)
def test_a_mill_that_cuts_with_its_middle_goes_straight_down(feature):
    op, steps = planned(feature, centre_cutting=True)
    down = [step for step in steps if step.cutting and into(op, step).max() > math.radians(1.0)]
    assert down
    assert all(into(op, step).min() > math.radians(89.0) for step in down)


@pytest.mark.parametrize("allowance", [0.0, 3e-4])
def test_where_no_line_is_long_enough_it_goes_down_round_the_middle(allowance):
    hinge = replace(RECIPE.feature("hinge_1"), length=0.032, depth=0.02, passes=Passes(0.02, allowance))
    op, steps = planned(hinge)
    ramp = [step for step in steps if step.cutting and into(op, step).max() > math.radians(1.0)]
    assert any(isinstance(step.curve, Arc) for step in ramp)
    assert max(into(op, step).max() for step in ramp) <= hinge.tool.max_ramp + 1e-3


def test_a_round_hole_is_one_helix_unless_its_turns_are_deeper_than_the_step():
    hole = RECIPE.feature("handle_hole")
    _, steps = planned(hole)
    laps = [step for step in steps if step.cutting and not step.wall and step.curve.is_arc]
    helix = [step for step in laps if abs(step.curve.end[0] - step.curve.start[0]) > 1e-4]
    assert len(laps) - len(helix) <= 3  # one flat lap, at the bottom
    shallow = replace(hole, passes=Passes(1e-3, hole.passes.finish_allowance))
    _, stepwise = planned(shallow)
    assert sum(step.cutting and not step.wall for step in stepwise) > 3 * len(laps)


def flown_by(steps, op):
    """Where the tip goes, feature axes, shape (n, 3): corners on parabolas from zone to zone, as a controller goes."""
    legs = [0.0]
    for a, b in itertools.pairwise(steps):
        lengths = (a.curve.length, b.curve.length)
        legs.append(0.0 if a.zone == "fine" else min(ZONE[a.zone], 0.5 * min(lengths)))
    points = []
    for step, after, begin, end in zip(steps, [*steps[1:], None], legs, [*legs[1:], 0.0], strict=True):
        length = step.curve.length
        if length < 1e-9:
            continue
        shares = np.linspace(begin / length, 1.0 - end / length, max(2, int(length / 2e-4)))
        points.append(step.curve.points(shares))
        if end:
            corner, first, last = (
                step.curve.end,
                points[-1][-1],
                after.curve.points([end / after.curve.length])[0],
            )
            t = np.linspace(0.0, 1.0, 42)[1:-1, None]
            points.append((1.0 - t) ** 2 * first + 2.0 * t * (1.0 - t) * corner + t**2 * last)
    T = inverse(op.T_door_feature)
    return np.concatenate(points) @ T[:3, :3].T + T[:3, 3]


def wood_taken_steeply(points, radius, slope):
    """The deepest that it goes into wood in one piece of the way that is steeper than a slope [m].

    Where it was before counts as cut as far as it covered the whole middle, a quarter of the radius, of where it is.
    """
    worst = taken = 0.0
    for i in range(1, len(points)):
        way = points[i] - points[i - 1]
        steep = way[2] > 1e-9 and np.arctan2(way[2], np.hypot(*way[:2])) > slope
        near = np.hypot(*(points[:i, :2] - points[i, :2]).T) < 0.75 * radius
        new = points[i, 2] - points[:i, 2][near].max(initial=0.0)
        taken = taken + max(0.0, float(new)) if steep else 0.0
        worst = max(worst, taken)
    return worst


SIZES = {
    "turned back to its wall on every level": (19.0, 22.26, 141.321, 10.475, 5.247),
    "turned back to a ring": (10.0, 27.522, 104.543, 11.097, 3.709),
    "turned back below the ramp": (20.0, 23.4, 26.4, 13.919, 8.415),
    "a groove of the mill's width": (10.0, 10.0, 13.0, 7.485, 6.535),
    "a long groove of the mill's width": (16.0, 16.0, 116.0, 25.0, 8.73),
}


@pytest.mark.parametrize("size", SIZES.values(), ids=SIZES)
def test_corners_of_ramps_flown_by_take_no_wood_steeper_than_the_ramp(size):
    diameter, width, length, depth, step = (1e-3 * value for value in size)
    hinge = RECIPE.feature("hinge_1")
    tool = replace(hinge.tool, diameter=diameter, cutting_length=0.1)
    hinge = replace(hinge, tool=tool, width=width, length=length, depth=depth, passes=Passes(step, 0.0))
    op, steps = planned(hinge)
    slope = hinge.tool.max_ramp + math.radians(
        2.0
    )  # of arcs a little more: a chord of an arc is shorter than it
    assert wood_taken_steeply(flown_by(steps, op), tool.radius, slope) < 2e-5
