"""Whole doors: the standard door by one robot and by two, play in the gears, drawings, speeds."""

import math
from dataclasses import replace

import numpy as np
import pytest

from doormill_ros.robot_model.extended_model import load_compliance_model
from doormill_ros.simulation.judge.milled_part import inspect
from doormill_ros.toolpath.cuts.operation import operation
from doormill_ros.toolpath.door_checks import check_door, text_table
from doormill_ros.toolpath.door_plan import door_plan
from doormill_ros.toolpath.drawing import draw_program, save_png
from doormill_ros.toolpath.program import MotionKind
from doormill_ros.toolpath.settings import load_settings
from doormill_ros.toolpath.split import split
from support.cycle import require_cycle


@pytest.fixture(scope="module")
def standard(cell):
    recipe = cell.recipe("standard_door")
    T_base_door = cell.T_base_door(recipe, 0.004, -0.003, math.radians(-1.0))
    return recipe, T_base_door, cell.program(recipe, T_base_door)


@pytest.fixture(scope="module")
def shared(cell, standard):
    """Programs of the two robots, with their shares."""
    recipe, T_base_door, _ = standard
    shares = split(recipe, T_base_door, load_settings())
    return [(s, cell.program_of(recipe, s)) for s in shares]


def test_standard_door_is_milled_within_five_hundredths(cell, standard):
    recipe, T_base_door, program = standard
    corrected = inspect(recipe, T_base_door, cell.execute(program, cell.springs))
    for result in corrected.features:
        assert result.milled
        assert result.max_deviation < 5e-5
        assert np.abs(result.floor).max() < 5e-5
        assert result.uncleared < 1e-9
    without = inspect(recipe, T_base_door, cell.execute(program, cell.springs, corrected=False))
    assert min(r.max_deviation for r in without.features) > 2e-4


def test_a_rigid_robot_on_the_nominal_path_mills_the_recipe(cell, standard):
    """What is left is the chord of arcs that were so flat that they became lines."""
    recipe, T_base_door, program = standard
    part = inspect(recipe, T_base_door, cell.execute(program, None, corrected=False))
    assert part.max_deviation < load_settings().correction.bend


def test_wrong_model_shows_in_the_result(cell, standard):
    """The judge sees a robot that is 30 % softer than the model: a third of the deflection stays."""
    recipe, T_base_door, program = standard
    soft = type(cell.springs)(cell.robot, cell.springs.stiffness / 1.3)
    executed = cell.execute(program, soft)
    full = inspect(recipe, T_base_door, cell.execute(program, cell.springs, corrected=False))
    found = inspect(recipe, T_base_door, executed)
    assert len(found.features) == len(recipe.features) > 0
    for result in found.features:
        ratio = result.max_deviation / full.feature(result.feature).max_deviation
        assert 0.15 < ratio < 0.6


def test_motions_join_and_arcs_keep_the_limits(standard):
    _, _, program = standard
    assert program.motions[0].kind is MotionKind.ABSOLUTE
    names = [t.name for t in program.targets]
    assert len(set(names)) == len(names)
    to_targets = [m for m in program.motions if m.kind is not MotionKind.ABSOLUTE]
    used = {m.target for m in to_targets} | {m.via for m in to_targets} - {None}
    assert used == set(range(len(names)))
    for motion in program.motions:
        assert (motion.kind is MotionKind.CIRCULAR) == (motion.via is not None)
        assert motion.speed > 0.0
        assert motion.zone in ("fine", "z0", "z1")
        if not motion.cutting:
            assert not motion.wrench.any()
        if motion.cutting:
            assert motion.feature
            assert motion.spindle_speed > 0.0


def test_configuration_is_constant_through_each_feature(cell, standard):
    """Joint angles never jump while cutting, and the branch (cfx) stays."""
    recipe, _, program = standard
    assert len(recipe.features) == 6
    for feature in recipe.features:
        used = [m for m in program.motions if m.feature == feature.id]
        q = np.array([program.targets[m.target].q for m in used])
        assert np.abs(np.diff(q, axis=0)).max() < math.radians(25)
        assert len({program.targets[m.target].conf.cfx for m in used}) == 1


def test_two_robots_share_the_door_as_in_appendix_a1(shared):
    """Robot 1: two handle holes and the hinges; robot 2: two handle holes and the lock case."""
    done = [sorted(o.feature.id for o in share.operations) for share, _ in shared]
    assert done == [
        ["cylinder_hole", "handle_hole", "hinge_1", "hinge_2", "hinge_3"],
        ["cylinder_hole", "handle_hole", "lock_case"],
    ]
    depths = {(s.robot, o.feature.id): o.depth for s, _ in shared for o in s.operations}
    for hole in ("cylinder_hole", "handle_hole"):
        assert depths["first", hole] + depths["second", hole] == pytest.approx(0.040 + 0.002)


def test_two_robots_mill_one_door(cell, standard, shared):
    recipe, _, _ = standard
    (first, one), (second, two) = shared
    part = inspect(
        recipe,
        first.T_base_door,
        cell.execute(one, cell.springs),
        others=[(second.T_base_door, cell.execute(two, cell.springs))],
    )
    assert len(part.features) == len(recipe.features) > 0
    for result in part.features:
        assert result.milled
        assert result.max_deviation < 5e-5


def test_the_second_robot_faces_the_lock_edge_as_the_first_faces_the_hinge_edge(cell):
    """Lock edge and hinge edge stand at mirrored places for doors of any width."""
    settings = load_settings()
    for name in ("thesis_190_0deg", "thesis_1350_0deg"):
        recipe = cell.recipe(name)
        first, second = split(recipe, cell.T_base_door(recipe), settings)
        hinge = first.T_base_door @ [recipe.thickness, 0.0, 0.0, 1.0]
        lock = second.T_base_door @ [recipe.thickness, recipe.width, 0.0, 1.0]
        assert lock[1] == pytest.approx(hinge[1], abs=1e-12)
        assert second.T_base_door[:3, :3] == pytest.approx(np.diag([-1.0, -1.0, 1.0]), abs=1e-12)


def test_cycle_times_keep_appendix_a1(cell, standard, shared):
    recipe, _, _ = standard
    checks = [check_door(program, recipe, cell.robot) for _, program in shared]
    for check in checks:
        assert all(budget.kept for budget in check.budgets), text_table(check)
    assert [len(c.budgets) for c in checks] == [4, 4]
    assert require_cycle(checks) == max(c.time for c in checks) + 10.0


def test_checks_name_every_feature_and_its_margins(cell, standard):
    recipe, _, program = standard
    check = check_door(program, recipe, cell.robot)
    assert [f.feature for f in check.features] == [f.id for f in recipe.features]
    for row in check.features:
        targets = [program.targets[m.target] for m in program.motions if m.feature == row.feature]
        straight = min(math.asin(abs(math.sin(t.q[4]))) for t in targets)
        assert row.wrist == pytest.approx(straight, rel=0.05, abs=0.01)
        assert 0.0 < row.correction <= 0.001
        assert row.joint_margin > math.radians(1.0) - 0.002
        assert row.feature in text_table(check)
    # The start from home, the way home, and reading the file are the door's.
    assert 0.7 * check.time < sum(f.time for f in check.features) < check.time


def test_play_is_corrected_with_the_direction_of_each_joint(cell, play):
    """57 um/m of play in joint 1: what stays is near the places where the joint turns back."""
    recipe = cell.recipe("standard_door")
    recipe = replace(recipe, features=recipe.features[:1])
    T_base_door = cell.T_base_door(recipe)
    worn = play([5.7e-5, 0, 0, 0, 0, 0])
    deviation = {}
    for name, model in (("springs", cell.springs), ("play", worn)):
        program = cell.program(recipe, T_base_door, model=model)
        executed = cell.execute(program, worn)
        deviation[name] = np.abs(inspect(recipe, T_base_door, executed).features[0].deviation)
    # Joint 1 swings 57 urad by 1.6 m of radius.
    assert deviation["springs"].max() > 8e-5
    assert np.mean(deviation["play"]) < 0.35 * np.mean(deviation["springs"])
    assert np.mean(deviation["play"] > 5e-5) < 0.1


def test_an_extended_model_file_is_accepted(cell, tmp_path):
    """What a diagnosis leaves behind: joint 5 half as stiff, and play in joint 1."""
    stiffness = cell.robot.stiffness.tolist()
    path = tmp_path / "model.yaml"
    path.write_text(
        "schema: doormill/extended-model/1\n"
        f"robot: {cell.robot.name}\nsource: test\njoint_stiffness: {stiffness}\n"
        "causes:\n"
        "- {cause: joint_backlash, where: joint 1, parameters: {gap: 5.7e-05, crossing: 0.0}}\n",
        encoding="utf-8",
    )
    model = load_compliance_model(path)
    recipe = cell.recipe("thesis_1350_0deg")
    T_base_door = cell.T_base_door(recipe)
    plain, extended = cell.program(recipe, T_base_door), cell.program(recipe, T_base_door, model=model)
    steps = [
        np.array([t.T_base_tool_corrected[:3, 3] - t.T_base_tool_nominal[:3, 3] for t in p.targets])
        for p in (plain, extended)
    ]
    difference = np.linalg.norm(steps[1] - steps[0], axis=1)
    # At most the whole gap at the way that the tool stands from axis 1, and not nothing.
    far = max(np.hypot(*t.T_base_tool_corrected[:2, 3]) for t in plain.targets)
    assert 2e-5 < difference.max() < 5.7e-5 * 1.03 * far


def test_drawings(cell, standard, tmp_path):
    recipe, T_base_door, program = standard
    drawing = draw_program(recipe, program, T_base_door, factor=30.0)
    svg = drawing.save(tmp_path / "door.svg").read_text(encoding="utf-8")
    for layer in ("air", "path", "corrected"):
        assert f'<g id="{layer}">' in svg
    cut = sum(m.cutting for m in program.motions)
    # One line in the view and one in the panel of its feature.
    assert svg.split('<g id="corrected">')[1].split("</g>")[0].count("<polyline") == 2 * cut
    png = save_png(tmp_path / "door.png", recipe, program, T_base_door)
    assert png.read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"
    assert png.stat().st_size > 20_000


def test_exaggeration_is_of_the_correction_alone(cell, standard):
    """A factor of 1 draws the corrected targets themselves, 0 the nominal ones."""
    from doormill_ros.toolpath.drawing import _ways

    recipe, T_base_door, program = standard
    by_tool = [m.kind is not MotionKind.ABSOLUTE for m in program.motions]
    cuts = [i for i, own in enumerate(by_tool) if i and own and by_tool[i - 1]]
    assert {program.motions[i].feature for i in cuts} >= {feature.id for feature in recipe.features}
    for factor, pose in ((0.0, "T_base_tool_nominal"), (1.0, "T_base_tool_corrected")):
        for (points, feature, _), i in zip(_ways(program, T_base_door, factor), cuts, strict=True):
            motion = program.motions[i]
            end = getattr(program.targets[motion.target], pose)[:3, 3]
            assert feature == motion.feature
            assert T_base_door[:3, :3] @ points[-1] + T_base_door[:3, 3] == pytest.approx(end, abs=1e-9)


def test_speeds_that_hardly_differ_become_one_unless_the_chip_gets_too_thick(cell):
    """At 2 % fewer turns and the same feed the chip is 2 % thicker."""
    recipe = cell.recipe("standard_door")
    first, second = recipe.feature("hinge_1"), recipe.feature("hinge_2")
    slow = replace(first, cutting=replace(first.cutting, spindle_speed=0.985 * second.cutting.spindle_speed))
    chip = second.cutting.chip(second.tool)
    found = []
    for limit in (1.01 * chip, 1.02 * chip):
        tool = replace(second.tool, max_chip_load=limit)
        features = (replace(slow, tool=tool), replace(second, tool=tool))
        plan = door_plan(
            replace(recipe, features=features), [operation(f, recipe.size) for f in features], load_settings()
        )
        found.append({s.spindle_speed for s in plan.steps if s.cutting and s.feature == second.id})
    assert found == [{second.cutting.spindle_speed}, {slow.cutting.spindle_speed}]
