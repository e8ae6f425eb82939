import math

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from doormill_ros.recipes.documents import load_recipe
from doormill_ros.recipes.outline import RoundedRectangle
from doormill_ros.recipes.recipe import Recipe

SIZE = st.integers(5000, 300000).map(lambda um: um * 1e-6)


@st.composite
def shapes(draw):
    width, length, share = draw(SIZE), draw(SIZE), draw(st.sampled_from([0.0, 0.1, 0.5, 0.9, 1.0]))
    return RoundedRectangle(width, length, share * min(width, length) / 2)


@given(shapes(), st.booleans())
@settings(max_examples=200, deadline=None)
def test_outline_closes_and_has_the_area_and_length_of_its_formula(shape, split):
    outline = shape.outline(split)
    ends = [segment.end for segment in outline.segments]
    starts = [segment.start for segment in outline.segments[1:]] + [outline.segments[0].start]
    np.testing.assert_allclose(ends, starts, atol=1e-15)
    w, h, r = shape.width, shape.length, shape.radius
    assert outline.length == pytest.approx(2 * (w + h) - 8 * r + 2 * math.pi * r, rel=1e-9)
    area = w * h - (4 - math.pi) * r * r
    assert outline.polygon(1e-7).area == pytest.approx(area, abs=1e-7 * outline.length + 1e-12)


@given(shapes(), st.sampled_from([0.1, 0.5, 0.99]))
@settings(max_examples=200, deadline=None)
def test_every_point_of_an_inset_is_so_far_from_the_wall(shape, share):
    """Measured by shapely against the outline as a fine polygon."""
    distance = share * min(shape.width, shape.length) / 2
    wall = shape.outline().polygon(1e-8).exterior
    points = shape.inset(distance).outline().points(step=shape.length / 20)
    assert len(points) >= 4  # one at each corner, if nothing else is left
    for point in points:
        assert wall.distance(shapely.Point(point)) == pytest.approx(distance, abs=3e-8)


@given(shapes(), st.booleans())
@settings(max_examples=100, deadline=None)
def test_order_of_the_outline_is_climb_milling(shape, split):
    """The tooth at the wall moves against the feed, for a spindle that turns clockwise along the tool axis.

    The tool axis is the feature's +z, so the spindle turns with +z. At a point of the wall with
    outward normal n the tooth moves along z x n; climb milling means that the tool's feed is opposite.
    """
    judged = 0
    for segment in shape.outline(split).segments:
        for fraction in (0.2, 0.5, 0.8):
            a, b = segment.points(np.array([fraction - 1e-4, fraction + 1e-4]))
            feed = (b - a) / np.linalg.norm(b - a)
            centre = segment.points(np.array([fraction]))[0]
            sides = [centre + 1e-7 * np.array([-feed[1], feed[0]]) * s for s in (1, -1)]
            polygon = shape.outline().polygon(1e-8)
            outside = [side for side in sides if not polygon.contains(shapely.Point(side))]
            if len(outside) != 1:
                continue  # nearer to a chord's end than the polygon resolves
            normal = (outside[0] - centre) / np.linalg.norm(outside[0] - centre)
            tooth = np.cross([0, 0, 1], [*normal, 0])[:2]
            assert tooth @ feed == pytest.approx(-1.0, abs=1e-3)
            judged += 1
    assert judged >= 3


@given(shapes())
@settings(max_examples=100, deadline=None)
def test_arcs_are_arcs(shape):
    arcs = [segment for segment in shape.outline().segments if segment.is_arc]
    # Sharp corners have none, an oblong one at either end, all others one a corner.
    assert len(arcs) == (0 if shape.radius == 0 else 2 if 2 * shape.radius == shape.width else 4)
    for segment in arcs:
        points = segment.points(np.linspace(0, 1, 9))
        np.testing.assert_allclose(
            np.linalg.norm(points - segment.centre, axis=1), segment.radius, rtol=1e-9, atol=1e-12
        )
        np.testing.assert_allclose(points[0], segment.start, atol=1e-12)
        np.testing.assert_allclose(points[4], segment.via, atol=1e-12)
        np.testing.assert_allclose(points[-1], segment.end, atol=1e-12)


def test_thesis_points_run_as_path_20():
    """Figure 3.41: MoveC 10 to 12, MoveL 14, MoveC 15 to 13, MoveL 11, starting at 11."""
    feature = load_recipe("thesis_190_0deg").features[0]
    p = dict(zip(range(10, 16), feature.point_positions(), strict=True))
    moves = feature.outline().segments
    assert [move.name for move in moves] == ["top_turn", "right_line", "bottom_turn", "left_line"]
    visited = [
        moves[0].start,
        moves[0].via,
        moves[0].end,
        moves[1].end,
        moves[2].via,
        moves[2].end,
        moves[3].end,
    ]
    np.testing.assert_allclose(visited, [p[i] for i in (11, 10, 12, 14, 15, 13, 11)], atol=1e-15)
    assert p[10][1] > p[11][1] == p[12][1] > p[13][1] == p[14][1] > p[15][1]
    assert p[11][0] == p[13][0] < p[10][0] == p[15][0] < p[12][0] == p[14][0]


def test_tool_path_of_the_thesis_hinge_by_hand():
    """30 x 120 mm outline, 19 mm mill: half-turns of 5.5 mm about centres 45 mm from the middle."""
    p = load_recipe("thesis_190_0deg").features[0].point_positions(inset=0.0095)
    expected = [[0, 50.5], [-5.5, 45], [5.5, 45], [-5.5, -45], [5.5, -45], [0, -50.5]]
    np.testing.assert_allclose(p * 1000, expected, atol=1e-9)


def test_nine_points_lie_on_the_outline_in_rows(document):
    document["features"][0]["points"] = 9
    feature = Recipe.from_document(document).features[0]
    p = feature.point_positions(inset=0.008)
    assert p.shape == (9, 2)
    ring = feature.outline(0.008).polygon(1e-8).exterior
    assert max(ring.distance(shapely.Point(q)) for q in p) < 1e-7
    np.testing.assert_allclose(p[8], p[1])
    np.testing.assert_allclose(p[3:5, 1], 0, atol=1e-15)
    assert [segment.name for segment in feature.outline().segments].count("left_line") == 2


def test_inset_beyond_the_middle_is_refused():
    with pytest.raises(ValueError, match="leaves nothing"):
        RoundedRectangle(0.02, 0.1, 0.01).inset(0.0101)
