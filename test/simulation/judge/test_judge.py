"""Runs whose verdict is known by hand, or from another method."""

import dataclasses

import numpy as np
import pytest
import shapely

from doormill_ros.frames import transform
from doormill_ros.recipes.door import R_DOOR_FEATURE, Side
from doormill_ros.simulation.errors import BodyTouched, WoodOutsideFeatures
from doormill_ros.simulation.judge.bodies import Box, Capsule, load_cell
from doormill_ros.simulation.judge.judge import judge
from doormill_ros.simulation.judge.links import BASE, FLANGE
from support import doors
from support.flights import HOME, flight, joint_flight, straight

FRONT = R_DOOR_FEATURE[Side.FRONT]
RADIUS = 8e-3
FAR = transform(translation=[1.6, 0.0, 0.0])


@pytest.fixture(scope="module")
def cell():
    """The shipped cell without its clamp, whose parts the tools of these tests do not know."""
    return dataclasses.replace(load_cell(), obstacles=())


@pytest.fixture(scope="module")
def door():
    """A door 40 mm thick with one oblong hinge, 30 x 120 x 5 mm, centre 25 mm from the edge, 500 mm up."""
    return doors.door_with("hinge_oblong", 2000, 800, 40, centre_cutting=True)


@pytest.fixture(scope="module")
def hinge(door):
    """Tips of the tool that mills the hinge, door frame, shape (n, 3)."""
    feature = door.features[0]
    ring = feature.outline(inset=feature.tool.radius).points(step=5e-4)
    ring = np.concatenate([ring, ring[:1]])
    across, high = 0.025, 0.5
    mouth = np.column_stack([np.full(len(ring), 0.005), across + ring[:, 0], high + ring[:, 1]])
    before = mouth[0] - [0.035, 0.0, 0.0]
    return np.concatenate([straight(before, mouth[0]), mouth, straight(mouth[-1], before)])


def test_a_tool_driven_through_the_door(cell, door):
    tips = straight([-0.1, 0.4, 1.0], [0.1, 0.4, 1.0], step=5e-3)
    verdict = judge(door, FAR, flight(FAR, tips, FRONT), cell)
    assert [type(verdict.error), len(verdict.gone), len(verdict.touches)] == [WoodOutsideFeatures, 1, 0]
    (gone,) = verdict.gone
    assert gone.volume == pytest.approx(np.pi * RADIUS**2 * 0.040, rel=0.01)
    assert gone.depth == pytest.approx(0.040, abs=1e-3)
    assert gone.motion == 1
    assert gone.time == pytest.approx(0.2, abs=0.011)  # 100 mm in steps of 5 mm and 10 ms
    assert gone.place == pytest.approx([0.040, 0.4, 1.0], abs=9e-3)
    inside = (tips[:, 0] > 0.5e-3).nonzero()[0]
    assert verdict.touched_samples == pytest.approx(len(inside), abs=1)


@pytest.mark.parametrize("slope", [0.0, 20.0, 45.0])
def test_a_slanting_tool_takes_as_much_as_its_slope_makes_of_the_thickness(cell, door, slope):
    c, s = np.cos(np.radians(slope)), np.sin(np.radians(slope))
    turn = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]) @ FRONT
    axis = turn[:, 2]
    tips = straight(np.array([0.02, 0.4, 1.0]) - 0.1 * axis, np.array([0.02, 0.4, 1.0]) + 0.055 * axis)
    verdict = judge(door, FAR, flight(FAR, tips, turn), cell)
    assert verdict.volume == pytest.approx(np.pi * RADIUS**2 * 0.040 / c, rel=0.01)


def test_a_hinge_that_is_milled_as_the_recipe_says_is_no_touch(cell, door, hinge):
    run = flight(FAR, hinge, FRONT, "hinge_oblong")
    verdict = judge(door, FAR, run, cell)
    assert verdict.error is None
    assert (verdict.judged, verdict.touched_samples, verdict.volume) == (len(run), 0, 0.0)
    assert verdict.sentence == f"nothing was touched but the wood to be cut in {len(run)} samples"


def test_the_same_hinge_milled_a_millimetre_too_deep(cell, door, hinge):
    verdict = judge(door, FAR, flight(FAR, hinge + np.array([1e-3, 0, 0]), FRONT, "hinge_oblong"), cell)
    area = 0.030 * 0.090 + np.pi * 0.015**2
    assert isinstance(verdict.error, WoodOutsideFeatures)
    assert verdict.volume == pytest.approx(area * 1e-3, rel=0.02)
    assert verdict.gone[0].depth == pytest.approx(1e-3, abs=1e-6)


def test_the_same_hinge_milled_a_millimetre_aside(cell, door, hinge):
    verdict = judge(door, FAR, flight(FAR, hinge + np.array([0, 1e-3, 0]), FRONT, "hinge_oblong"), cell)
    wall = shapely.LineString([(0, -0.045), (0, 0.045)]).buffer(0.015, quad_segs=256)
    beside = shapely.affinity.translate(wall, 1e-3, 0).difference(wall).area
    assert isinstance(verdict.error, WoodOutsideFeatures)
    assert verdict.volume == pytest.approx(beside * 5e-3, rel=0.03)
    assert verdict.gone[0].depth == pytest.approx(1e-3, abs=1e-6)


@pytest.mark.parametrize("shift", [[0.4e-3, 0, 0], [0, 0.4e-3, 0], [0, 0, -0.4e-3]])
def test_four_tenths_of_a_millimetre_are_within_the_tolerance(cell, door, hinge, shift):
    assert judge(door, FAR, flight(FAR, hinge + shift, FRONT, "hinge_oblong"), cell).error is None


@pytest.mark.parametrize("shift", [[0.6e-3, 0, 0], [0, 0.6e-3, 0], [0, 0, -0.6e-3]])
def test_six_tenths_are_not(cell, door, hinge, shift):
    verdict = judge(door, FAR, flight(FAR, hinge + shift, FRONT, "hinge_oblong"), cell)
    assert isinstance(verdict.error, WoodOutsideFeatures)
    assert verdict.gone[0].depth == pytest.approx(0.6e-3, abs=1e-5)


def test_wood_of_a_feature_may_be_taken_only_while_it_is_milled(cell, door, hinge):
    verdict = judge(door, FAR, flight(FAR, hinge, FRONT), cell)
    area = 0.030 * 0.090 + np.pi * 0.015**2
    assert verdict.volume == pytest.approx(area * 5e-3, rel=0.01)


def join(first, second):
    """One run after the other."""
    later = dataclasses.replace(
        second, time=second.time + first.time[-1] + 0.01, motion=second.motion + first.motion[-1] + 1
    )
    names = [f.name for f in dataclasses.fields(first) if getattr(first, f.name) is not None]
    return type(first)(**{n: np.concatenate([getattr(first, n), getattr(later, n)]) for n in names})


def test_a_pocket_that_was_milled_is_free_for_all_that_follows(cell, door, hinge):
    mill = flight(FAR, hinge, FRONT, "hinge_oblong")
    back = flight(FAR, hinge[::-1][::20], FRONT, motion=0)
    assert judge(door, FAR, join(mill, back), cell).error is None
    assert judge(door, FAR, join(back, mill), cell).error is not None


def test_a_standing_mill_touches(cell, door, hinge):
    run = flight(FAR, hinge, FRONT, "hinge_oblong")
    verdict = judge(door, FAR, run, cell, turning=np.zeros(len(run), bool))
    assert isinstance(verdict.error, BodyTouched)
    assert verdict.volume == 0.0
    assert {(touch.body, touch.obstacle) for touch in verdict.touches} == {("standing mill", "door")}
    # Drawn out of its own pocket it does not.
    turning = np.arange(len(run)) < len(run) - 60
    assert judge(door, FAR, run, cell, turning).error is None


def test_a_spindle_that_enters_the_door_with_its_mill(cell, door):
    (spindle,) = (body for body in cell.bodies if body.name == "spindle")
    tips = straight([-0.05, 0.4, 1.0], [0.150, 0.4, 1.0], step=2e-3)  # 150 - 120 mm of nose
    verdict = judge(door, FAR, flight(FAR, tips, FRONT), cell)
    (touch,) = verdict.touches
    assert (touch.body, touch.obstacle, touch.motion) == (spindle.name, "door", 1)
    assert touch.depth == pytest.approx(0.030, abs=1e-6)
    assert isinstance(verdict.error, BodyTouched)
    assert "spindle touched the door in motion 1" in verdict.error.message
    assert "30.0 mm deep" in verdict.error.message


def test_a_body_within_a_hole_that_was_milled_does_not_touch(cell):
    door = doors.door_with("handle_hole", 2000, 800, 40, centre_cutting=True)
    hole = door.features[0]
    ring = hole.outline(inset=RADIUS).points(step=5e-4)
    y, z = 0.75, hole.height
    rim = np.column_stack([np.full(len(ring), 0.042), y + ring[:, 0], z + ring[:, 1]])
    tips = np.concatenate(
        [straight(rim[0] - [0.06, 0, 0], rim[0]), rim, straight(rim[-1], rim[-1] - [0.06, 0, 0])]
    )
    mill = flight(FAR, tips, FRONT, hole.id)
    pin = Capsule("pin", FLANGE, np.array([0, 0, 0.2]), np.array([0, 0, 0.24]), 5e-3)
    middle = straight([-0.05, y, z], [0.03, y, z], step=2e-3)
    one = dataclasses.replace(cell, bodies=(pin,))
    assert judge(door, FAR, join(mill, flight(FAR, middle, FRONT)), one).error is None
    aside = flight(
        FAR, middle + np.array([0, 7e-3, 0]), FRONT
    )  # through the wall, where the turning mill takes wood too
    found = judge(door, FAR, join(mill, aside), one)
    assert [touch.body for touch in found.touches] == ["pin"]


def test_nothing_is_missed_between_samples(cell, door):
    tips = np.array([[0.02, -0.3, 2.02], [0.02, 0.3, 1.97]])  # across a corner of the door
    verdict = judge(door, FAR, flight(FAR, tips, FRONT), cell)
    assert [gone.motion for gone in verdict.gone] == [1]
    assert verdict.touched_samples >= 1


def test_the_arm_against_a_box_is_found_as_by_dense_looks(cell, door):
    rng = np.random.default_rng(5)
    found = 0
    for _ in range(12):
        q = HOME + np.array([rng.uniform(-0.9, 0.9, 6), rng.uniform(-0.9, 0.9, 6)])
        box = Box(
            "post",
            BASE,
            transform(translation=rng.uniform([0.6, -0.8, 0.2], [1.6, 0.8, 2.0])),
            np.full(3, 0.1),
        )
        lone = dataclasses.replace(cell, obstacles=(box,))
        away = transform(translation=[50.0, 0.0, 0.0])
        verdict = judge(door, away, joint_flight(cell, q), lone)
        dense = q[0] + np.linspace(0, 1, 1501)[:, None] * (q[1] - q[0])
        T = np.linalg.inv(box.at)
        expected = {}
        for body in cell.bodies:
            gap = body.gap(T @ cell.links.frames(dense)[body.link], box.half).min()
            if gap < -1e-3:
                expected[body.name] = -gap
        said = {touch.body: touch.depth for touch in verdict.touches if touch.body != "mill"}
        found += len(expected)
        assert set(expected) <= set(said)
        for name, depth in said.items():
            assert depth == pytest.approx(expected.get(name, 0.0), abs=1.5e-3)
    assert found > 5
