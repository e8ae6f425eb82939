"""Which wood each cut of a pocket removes, seen in the forces of its steps."""

from dataclasses import replace

import numpy as np
import pytest

from doormill_ros.correction.cutting_force import COEFFICIENTS, DIRECTIONS, mean_force
from doormill_ros.recipes.documents import load_recipe
from doormill_ros.recipes.door import Material
from doormill_ros.toolpath.cuts.engagement import with_forces
from doormill_ros.toolpath.cuts.operation import operation
from doormill_ros.toolpath.cuts.pocket import pocket_steps
from doormill_ros.toolpath.settings import load_settings

RECIPE = load_recipe("standard_door")


def cuts(name, material=Material.SOFTWOOD, **changes):
    feature = replace(RECIPE.feature(name), **changes)
    item = operation(feature, RECIPE.size)
    settings = load_settings()
    steps = with_forces(pocket_steps(item, settings), item, material, settings.correction.blend)
    return [s for s in steps if s.cutting], item


def size(step):
    return float(np.linalg.norm(step.wrench_tool[:3]))


@pytest.fixture(scope="module")
def hinge():
    return cuts("hinge_1")


def test_the_plunge_pushes_the_tool_out_of_the_wood():
    steps, _ = cuts("hinge_1", tool=replace(RECIPE.feature("hinge_1").tool, centre_cutting=True))
    assert steps[0].wrench_tool[2] < 0.0
    assert not steps[0].wrench_tool[:2].any()


def test_a_ramp_pushes_it_out_as_a_plunge_and_across_as_a_slot_of_its_mean_depth(hinge):
    """It goes down as fast as a plunge, and cuts all round, where its tip is in the wood.

    Along a ramp from z0 to z1 the depth goes evenly from one to the other; over the surface, below zero, it is none. So
    its mean is the integral of z from max(z0, 0) to z1, by z1 - z0: (z1^2 - max(z0, 0)^2) / (2 (z1 - z0)). Across the
    axis moves only the level share of its feed, which is the cosine of its slope.
    """
    (plunge, *_), _ = cuts("hinge_1", tool=replace(RECIPE.feature("hinge_1").tool, centre_cutting=True))
    steps, item = hinge
    feature = item.feature
    assert steps[0].wrench_tool[2] == pytest.approx(plunge.wrench_tool[2])
    depths = [
        [float((end - item.T_door_feature[:3, 3]) @ item.T_door_feature[:3, 2]) for end in (c.start, c.end)]
        for c in (step.curve for step in steps)
    ]
    ramps = [(step, z0, z1) for step, (z0, z1) in zip(steps, depths, strict=True) if z1 > z0 + 1e-6]
    assert ramps[0][1] < 0.0 < ramps[0][2]  # from in front of the surface
    for step, z0, z1 in ramps:
        mean = (z1**2 - max(z0, 0.0) ** 2) / (2.0 * (z1 - z0))
        slope = np.arcsin((z1 - z0) / step.curve.length)
        slot = mean_force(
            np.ones(DIRECTIONS, dtype=bool),
            np.array([np.cos(slope), 0.0]),
            feature.cutting.chip(feature.tool),
            feature.tool.flutes,
            COEFFICIENTS[Material.SOFTWOOD],
        )
        across = np.linalg.norm(step.wrench_tool[:2])
        assert across == pytest.approx(mean * np.linalg.norm(slot), rel=0.01)


def test_the_first_ring_is_a_slot_and_the_wall_takes_less():
    steps, _ = cuts("hinge_1", width=0.045)
    roughing = max(size(s) for s in steps[1:] if not s.wall)
    wall = [size(s) for s in steps if s.wall]
    assert 0.0 < np.median(wall) < roughing


def test_where_the_wall_pass_closes_nothing_is_left_to_cut(hinge):
    steps, _ = hinge
    assert size([s for s in steps if s.wall][-1]) < 0.05 * max(map(size, steps))


def test_deeper_cuts_and_harder_wood_take_more():
    shallow, deep = (max(size(s) for s in cuts("hinge_1", depth=d)[0]) for d in (2.5e-3, 5e-3))
    assert deep == pytest.approx(2.0 * shallow, rel=0.5)
    assert deep < max(size(s) for s in cuts("hinge_1", Material.HARDWOOD)[0])


def test_a_thin_last_cut_is_under_less_force_than_the_roughing_of_a_deep_pocket():
    steps, _ = cuts("lock_case")
    wall = np.median([size(s) for s in steps if s.wall])  # the tight turns take more
    assert wall < max(size(s) for s in steps if not s.wall)


def test_no_force_stays_for_more_than_a_quarter_turn_or_the_way_on_which_it_is_spread():
    steps, _ = cuts("cylinder_hole", diameter=0.06)
    blend = load_settings().correction.blend
    flat = [
        s for s in steps if abs((s.curve.end - s.curve.start) @ s.R_door_tool[:, 2]) < 1e-9
    ]  # not the helix
    sweeps = [s.curve.sweep for s in flat if s.curve.is_arc and s.curve.length > blend]
    assert sweeps
    assert max(sweeps) < np.radians(90.1)
