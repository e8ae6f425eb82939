"""Doors of several tools: order, ways to the rack, refusals, and any such door judged."""

import itertools
import os
from dataclasses import replace

import numpy as np
import pytest

from doormill_ros.abb.target_file.target_file import render_target_file
from doormill_ros.cell.errors import BadCellFile
from doormill_ros.cell.places.rack import check_rack
from doormill_ros.errors import DoormillError
from doormill_ros.pipeline.plan import load_setup, plan
from doormill_ros.recipes.documents import load_recipe
from doormill_ros.simulation.judge.bodies import load_cell
from doormill_ros.simulation.judge.judge import judge
from doormill_ros.toolpath import errors
from doormill_ros.toolpath.door_plan import whole_door
from doormill_ros.toolpath.mills.tool_order import tool_shares
from doormill_ros.toolpath.program import RACK_KINDS, MotionKind
from support.file_run import run_file
from support.judged_doors import draw, rigid
from support.two_tools import table, two_tool_door

NAMES = ("rack_mill_16", "rack_mill_12")
# More of them: DOORMILL_DOORS=20 pytest ...
DOORS = int(os.environ.get("DOORMILL_DOORS", "1"))
DRAWN = 60 * DOORS  # of which those with two tools and not too many motions are looked at
MOTIONS = 330


@pytest.fixture(scope="module")
def setup():
    return rigid(load_setup())


def with_tools(recipe, names):
    tools = table()
    features = (replace(f, tool=tools[name]) for f, name in zip(recipe.features, names, strict=True))
    return replace(recipe, features=tuple(features))


def changes(tools):
    """How often the tool is changed that begins and ends with the first place's."""
    line = [NAMES[0], *tools, NAMES[0]]
    return sum(a != b for a, b in itertools.pairwise(line))


@pytest.mark.parametrize("seed", range(12))
def test_no_other_order_changes_tools_more_rarely(setup, seed):
    """All orders of six features that keep those in turn of which one belongs to the other."""
    recipe = load_recipe("leaf_hinge_door")
    drawn = np.random.default_rng(seed).choice(NAMES, size=len(recipe.features))
    # Of the order alone: each tool is taken for long enough for any hole of this thick door.
    features = [
        replace(f, tool=replace(f.tool, cutting_length=0.1)) for f in with_tools(recipe, drawn).features
    ]
    operations = whole_door(replace(recipe, features=tuple(features)))
    shares = tool_shares(operations, setup.layout.rack, 1)
    found = [item for share in shares for item in share.operations]
    assert sorted(item.feature.id for item in found) == sorted(f.id for f in recipe.features)
    related = [
        (a.feature.id, b.feature.id)
        for a, b in itertools.combinations(operations, 2)
        if a.feature.belongs_to == b.feature.id or b.feature.belongs_to == a.feature.id
    ]
    assert len(related) == 2

    def kept(order):
        at = {item.feature.id: i for i, item in enumerate(order)}
        return all(at[a] < at[b] for a, b in related)

    assert kept(found)
    least = min(
        changes([i.feature.tool.name for i in order])
        for order in itertools.permutations(operations)
        if kept(order)
    )
    assert changes([item.feature.tool.name for item in found]) == least
    for share in shares:
        assert {item.feature.tool.name for item in share.operations} == {
            setup.layout.rack.places[share.place].tool
        }


def test_a_door_that_takes_the_other_tool_alone_brings_it_back(setup):
    recipe = two_tool_door(lock_case="rack_mill_12")
    program = plan(recipe, setup.layout.T_base_door(recipe.width, recipe.thickness), setup).program
    work = [(m.kind, m.via) for m in program.motions if m.kind in RACK_KINDS]
    put, take, measure = MotionKind.PUT, MotionKind.TAKE, MotionKind.MEASURE
    assert work == [(put, 0), (take, 1), (measure, 1), (put, 1), (take, 0), (measure, 0)]
    first_cut = next(i for i, m in enumerate(program.motions) if m.cutting)
    assert [m.kind in RACK_KINDS for m in program.motions[:first_cut]].count(True) == 3


def test_a_door_of_the_first_tool_is_planned_as_without_a_rack(setup):
    recipe = two_tool_door()
    recipe = replace(recipe, features=recipe.features[:1])
    T_base_door = setup.layout.T_base_door(recipe.width, recipe.thickness)
    bare = replace(setup, layout=replace(setup.layout, rack=None))
    files = [render_target_file(plan(recipe, T_base_door, s).program, "run") for s in (setup, bare)]
    assert files[0] == files[1]


def test_tools_that_cannot_be_had_are_refused(setup):
    recipe = two_tool_door()
    T_base_door = setup.layout.T_base_door(recipe.width, recipe.thickness)
    rack = setup.layout.rack
    without = replace(setup, layout=replace(setup.layout, rack=replace(rack, places=rack.places[:1])))
    with pytest.raises(
        errors.ToolPlaceError, match=r"hinge_1: tool 'rack_mill_12' stands in no place.*;"
    ) as caught:
        plan(recipe, T_base_door, without)
    assert caught.value.code == 323
    none = replace(setup, layout=replace(setup.layout, rack=None))
    with pytest.raises(errors.ToolChangeError, match="has no rack; describe the cell's rack there"):
        plan(recipe, T_base_door, none)


def test_a_place_that_is_blocked_is_refused(setup):
    recipe = two_tool_door()
    rack = setup.layout.rack
    T_base_door = setup.layout.T_base_door(recipe.width, recipe.thickness)
    deep = replace(setup, layout=replace(setup.layout, rack=replace(rack, depth=1.6)))
    with pytest.raises(errors.NoWayError, match=r"into a place of the rack|out of the robot's reach"):
        plan(recipe, T_base_door, deep)


def test_a_rack_has_each_tool_once(setup):
    rack = setup.layout.rack
    with pytest.raises(BadCellFile, match="tool 'rack_mill_16' in two places"):
        check_rack(replace(rack, places=rack.places[:1] * 2))
    with pytest.raises(BadCellFile, match="holds 0 places"):
        check_rack(replace(rack, places=()))


def test_any_door_of_two_tools_touches_nothing(setup):
    """Drawn doors, their two tools called as those of the rack; sizes and all else stay as they were drawn."""
    cell, judged = load_cell(), 0
    for recipe, offset in draw(DRAWN, 5):
        if len(recipe.tools) != 2 or judged == DOORS:
            continue
        called = dict(zip(recipe.tools, NAMES, strict=True))
        features = (replace(f, tool=replace(f.tool, name=called[f.tool.name])) for f in recipe.features)
        recipe = replace(recipe, features=tuple(features))
        T_base_door = setup.layout.T_base_door(recipe.width, recipe.thickness, offset)
        try:
            program = plan(recipe, T_base_door, setup).program
        except DoormillError:
            continue
        if len(program.motions) > MOTIONS:
            continue
        executed, turned = run_file(render_target_file(program, "run").decode())
        verdict = judge(recipe, T_base_door, executed, cell, turned)
        assert verdict.error is None, verdict.sentence
        assert set(executed.tool) == {"", *NAMES}
        judged += 1
    assert judged == DOORS
