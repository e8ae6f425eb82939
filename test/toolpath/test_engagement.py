"""Which wood each cut of a pocket removes, seen in the forces of its steps."""

from dataclasses import replace

import numpy as np
import pytest

from doormill_ros.recipes.documents import load_recipe
from doormill_ros.recipes.door import Material
from doormill_ros.toolpath.engagement import with_forces
from doormill_ros.toolpath.operation import operation
from doormill_ros.toolpath.pocket import pocket_steps
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


def test_a_ramp_pushes_it_out_as_a_plunge_and_across_less_than_the_slot_that_it_becomes(hinge):
    """It goes down as fast as a plunge, and cuts all round at less than half the depth in the mean."""
    (plunge, *_), _ = cuts("hinge_1", tool=replace(RECIPE.feature("hinge_1").tool, centre_cutting=True))
    ramp = hinge[0][0]
    assert ramp.wrench_tool[2] == pytest.approx(plunge.wrench_tool[2])
    slot = max(np.linalg.norm(s.wrench_tool[:2]) for s in hinge[0][1:])
    assert 0.1 * slot < np.linalg.norm(ramp.wrench_tool[:2]) < 0.6 * slot


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
