"""Lines and arcs against their definitions."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from doormill_ros.frames import apply, transform
from doormill_ros.toolpath.curves.curve import Line, arc_about, points_of, tangents_of

ANGLES = st.floats(0.05, 6.0)
SIGNS = st.sampled_from([-1.0, 1.0])


def some_arc(sweep, seed=0):
    rng = np.random.default_rng(seed)
    normal = Rotation.random(rng=rng).as_matrix()[:, 2]
    arm = np.cross(normal, rng.normal(size=3))
    return arc_about(rng.normal(size=3) + arm, arm, normal, sweep), normal


@given(ANGLES, SIGNS)
def test_arc_turns_its_start_about_the_axis(angle, sign):
    normal = np.array([0.6, 0.0, 0.8])
    centre, start = np.array([1.0, 2.0, 3.0]), np.array([1.0, 2.5, 3.0])
    arc = arc_about(start, centre, normal, sign * angle)
    for fraction in (0.0, 0.3, 1.0):
        turn = Rotation.from_rotvec(normal * sign * angle * fraction).as_matrix()
        assert arc.points([fraction])[0] == pytest.approx(centre + turn @ (start - centre), abs=1e-12)
    assert arc.length == pytest.approx(0.5 * angle)


@given(ANGLES, SIGNS, st.floats(0.0, 0.9), st.floats(0.05, 0.1))
def test_a_part_of_a_curve_lies_on_it(angle, sign, first, size):
    arc = arc_about([0.3, 0.1, 0.0], [0.0, 0.0, 0.0], np.array([0.0, 0.0, 1.0]), sign * angle)
    for curve in (arc, Line(np.zeros(3), np.array([1.0, 2.0, 3.0]))):
        part = curve.part(first, first + size)
        t = np.array([0.0, 0.2, 0.9, 1.0])
        assert part.points(t) == pytest.approx(curve.points(first + size * t), abs=1e-12)
        assert part.length == pytest.approx(size * curve.length)


@given(ANGLES, SIGNS)
def test_backwards_is_the_same_way(angle, sign):
    arc = arc_about([0.3, 0.1, 0.0], [0.1, 0.0, 0.0], np.array([0.0, 0.0, 1.0]), sign * angle)
    t = np.linspace(0.0, 1.0, 7)
    assert arc.backwards().points(t) == pytest.approx(arc.points(1.0 - t), abs=1e-12)
    line = Line(np.zeros(3), np.ones(3))
    assert line.backwards().points(t) == pytest.approx(line.points(1.0 - t))


def test_mapping_a_curve_maps_its_points():
    T = transform(Rotation.from_rotvec([0.3, -0.2, 0.9]).as_matrix(), np.array([1.0, 2.0, -3.0]))
    t = np.linspace(0.0, 1.0, 9)
    arc = arc_about([0.3, 0.1, 0.0], [0.1, 0.0, 0.0], np.array([0.0, 0.0, 1.0]), 2.0)
    for curve in (arc, Line(np.zeros(3), np.ones(3))):
        assert curve.mapped(T).points(t) == pytest.approx(apply(T, curve.points(t)), abs=1e-12)


def test_many_curves_at_once_are_the_same_as_one_by_one():
    curves = [
        arc_about([0.3, 0.1, 0.0], [0.1, 0.0, 0.0], np.array([0.0, 0.0, 1.0]), -2.0),
        Line(np.zeros(3), np.ones(3)),
        arc_about([1.0, 0.0, 0.0], [0.0, 0.0, 0.0], np.array([0.0, 1.0, 0.0]), math.pi),
    ]
    t = np.linspace(0.0, 1.0, 5)
    together = points_of(curves, np.repeat([0, 1, 2], 5), np.tile(t, 3)).reshape(3, 5, 3)
    for curve, points in zip(curves, together, strict=True):
        assert points == pytest.approx(curve.points(t), abs=1e-15)
    assert np.array_equal(together[0, -1], curves[0].end)


@given(ANGLES, st.floats(0.0, 1.0))
def test_one_point_is_one_of_many(sweep, fraction):
    arc, _ = some_arc(sweep)
    for curve in (arc, Line(np.zeros(3), np.array([1.0, 2.0, 3.0]))):
        assert curve.point(fraction) == pytest.approx(curve.points([fraction])[0], abs=1e-12)
        assert curve.point(0.0) == pytest.approx(curve.start, abs=0.0)
        assert curve.point(1.0) == pytest.approx(curve.end, abs=0.0)


@given(ANGLES, st.floats(0.1, 0.9))
def test_tangents_go_the_way_of_the_points(sweep, fraction):
    curves = [some_arc(sweep)[0], Line(np.zeros(3), np.array([1.0, 2.0, 3.0]))]
    index, t = np.array([1, 0, 1]), np.array([0.0, fraction, 1.0])
    found = tangents_of(curves, index, t)
    alone = [curves[i].tangent(at) for i, at in zip(index, t, strict=True)]
    assert found == pytest.approx(np.array(alone), abs=1e-12)
    ways = np.array(
        [curves[i].point(at + 1e-6) - curves[i].point(at - 1e-6) for i, at in zip(index, t, strict=True)]
    )
    assert found == pytest.approx(ways / np.linalg.norm(ways, axis=1)[:, None], abs=1e-6)
