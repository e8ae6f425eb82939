"""The thesis' two-hinge door: 14 targets, Path_20, and equations 3.46 to 3.50."""

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest

from doormill_ros.frames import quaternion_wxyz
from doormill_ros.simulation.judge.milled_part import inspect
from doormill_ros.toolpath.program import MotionKind
from support.configuration import conf_data

THESIS_DOORS = ["thesis_190_0deg", "thesis_190_2deg", "thesis_1350_0deg", "thesis_1350_2deg"]

# Figures 3.36 and 3.40: line of the file to target.
FILE_ORDER = ["init", "10", "11", "12", "13", "14", "15", "init2", "20", "21", "22", "23", "24", "25"]
# Figure 3.41 without the two home positions, which are not in the file.
PATH_20 = [
    ("MoveL", None, "init"),
    ("MoveL", None, "11"),
    ("MoveC", "10", "12"),
    ("MoveL", None, "14"),
    ("MoveC", "15", "13"),
    ("MoveL", None, "11"),
    ("MoveL", None, "init"),
    ("MoveL", None, "init2"),
    ("MoveL", None, "21"),
    ("MoveC", "20", "22"),
    ("MoveL", None, "24"),
    ("MoveC", "25", "23"),
    ("MoveL", None, "21"),
    ("MoveL", None, "init2"),
]


@pytest.fixture(scope="module", params=THESIS_DOORS)
def door(request, cell):
    recipe = cell.recipe(request.param)
    T_base_door = cell.placed(recipe)
    return recipe, T_base_door, cell.program(recipe, T_base_door)


def by_name(program):
    return {t.name: t for t in program.targets}


def test_targets_are_the_thesis_14_in_file_order(door):
    _, _, program = door
    assert [t.name for t in program.targets] == FILE_ORDER


def test_motions_are_those_of_path_20(door):
    _, _, program = door
    names = [t.name for t in program.targets]
    motions = [m for m in program.motions if m.kind is not MotionKind.ABSOLUTE]
    found = [(m.kind.value, None if m.via is None else names[m.via], names[m.target]) for m in motions]
    assert found == PATH_20
    assert {m.zone for m in motions} == {"z0"}
    # Its ways from and to home are points of joint space, before the first of its motions and behind the last.
    first, last = program.motions.index(motions[0]), program.motions.index(motions[-1])
    assert list(program.motions[first : last + 1]) == motions


def test_turns_too_narrow_for_three_targets_are_milled_by_the_general_program(cell, door):
    recipe, T_base_door, _ = door
    for spare, targets in ((0.0025, True), (0.0019, False)):
        hinges = []
        for hinge in recipe.features:
            width = hinge.tool.diameter + 2.0 * spare
            hinges.append(replace(hinge, width=width, length=0.120))
        narrow = replace(recipe, features=tuple(hinges))
        program = cell.program(narrow, T_base_door)
        assert (len(program.targets) == 14) is targets
        part = inspect(narrow, T_base_door, cell.execute(program, cell.springs))
        assert len(part.features) == 2
        assert max(f.max_deviation for f in part.features) < (5e-4 if targets else 5e-5)


def equations_3_46_to_3_50(x_local, z_local, yaw, correction=0.0):
    """The thesis' own way to a point of the displaced door, in its letters; x across, z up."""
    length = math.sqrt(x_local**2 + (z_local + correction) ** 2)
    alpha = math.acos(x_local / length)
    beta = alpha + yaw
    return length * math.cos(beta), length * math.sin(beta)


@pytest.mark.parametrize("name", THESIS_DOORS)
@pytest.mark.parametrize("yaw_deg", [-2.0, 0.0, 1.3, 2.0])
def test_nominal_points_obey_the_thesis_equations(cell, name, yaw_deg):
    recipe = cell.recipe(name)
    yaw, y0, z0 = math.radians(yaw_deg), 0.007, -0.004
    program = cell.program(recipe, cell.T_base_door(recipe, y0, z0, yaw))
    targets = by_name(program)
    # Outline less the tool radius, from the recipe's figures: 30 x 120 mm, tool 19 mm, 25 mm backset.
    half, straight, backset, depth = 0.015 - 0.0095, 0.045, 0.025, 0.005
    local = {
        "0": (0.0, straight + half),
        "1": (-half, straight),
        "2": (half, straight),
        "3": (-half, -straight),
        "4": (half, -straight),
        "5": (0.0, -straight - half),
    }
    heights = {"1": 0.150, "2": recipe.height - 0.150}
    for hinge, height in heights.items():
        for point, (across, along) in local.items():
            y, z = equations_3_46_to_3_50(backset + across, height + along, yaw)
            found = targets[hinge + point].T_base_tool_nominal[:3, 3]
            corner_y = 0.335 - recipe.width / 2 + y0
            assert found == pytest.approx([1.925 - 0.050 + depth, corner_y + y, -0.150 + z0 + z], abs=1e-12)


LEFT_LINES = {("13", "11"), ("23", "21")}


@pytest.mark.parametrize("yaw_deg", [0.0, 2.0])
def test_forces_of_table_4_8_act_across_and_along_the_door_by_hand(cell, yaw_deg):
    """Left line: Fx across the door, Fy up along it, Fz into the wood, which is the base's x.

    The moments, measured 0.208 m behind the tip, are taken to it: Mx + d Fy, My - d Fx.
    """
    recipe = cell.recipe("thesis_190_0deg")
    program = cell.program(recipe, cell.T_base_door(recipe, rotation=math.radians(yaw_deg)))
    c, s = math.cos(math.radians(yaw_deg)), math.sin(math.radians(yaw_deg))
    force = [12.0, -209.0 * c - 29.0 * s, -209.0 * s + 29.0 * c]
    mx, my, mz = -5.0 + 0.208 * 29.0, -43.0 + 0.208 * 209.0, 3.0
    moment = [mz, mx * c - my * s, mx * s + my * c]
    names = [t.name for t in program.targets]
    motions = itertools.pairwise(m for m in program.motions if m.kind is not MotionKind.ABSOLUTE)
    left = [after for before, after in motions if (names[before.target], names[after.target]) in LEFT_LINES]
    assert len(left) == 2
    for motion in left:
        assert motion.wrench == pytest.approx([*force, *moment], abs=1e-9)


def test_init_stands_straight_in_front_of_the_first_point(door):
    _, _, program = door
    targets = by_name(program)
    for init, first in (("init", "11"), ("init2", "21")):
        way = targets[first].T_base_tool_nominal[:3, 3] - targets[init].T_base_tool_nominal[:3, 3]
        assert way == pytest.approx([0.035, 0.0, 0.0], abs=1e-12)


def test_only_the_two_quaternion_values_of_the_yaw_come_up(cell):
    """Section 3.8: the door's rotation brings up two of the four values, q2 and q4 here."""
    recipe = cell.recipe("thesis_190_2deg")
    straight = cell.program(recipe, cell.T_base_door(recipe)).targets[0]
    turned = cell.program(recipe, cell.T_base_door(recipe, rotation=math.radians(2))).targets[0]
    r, half = math.sqrt(0.5), math.radians(1)
    assert quaternion_wxyz(straight.T_base_tool_nominal) == pytest.approx([r, 0, r, 0], abs=1e-12)
    expected = [r * math.cos(half), r * math.sin(half), r * math.cos(half), r * math.sin(half)]
    assert quaternion_wxyz(turned.T_base_tool_nominal) == pytest.approx(expected, abs=1e-12)


def test_joint_angles_reach_the_corrected_poses_in_the_stated_configuration(cell, door):
    _, _, program = door
    assert len(program.targets) == 14
    for target in program.targets:
        T_base_tool = cell.kinematics.forward(target.q) @ cell.layout.T_flange_tool
        assert T_base_tool == pytest.approx(target.T_base_tool_corrected, abs=1e-9)
        assert target.conf == conf_data(target.q, cell.robot)
        assert np.all((target.q > cell.robot.lower) & (target.q < cell.robot.upper))


def test_one_configuration_a_hinge_and_no_branch_change(door):
    _, _, program = door
    targets = by_name(program)
    for hinge in "12":
        assert len({targets[hinge + p].conf for p in "012345"}) == 1
    assert len({t.conf.cfx for t in program.targets}) == 1


def test_corrected_poses_deflect_onto_the_nominal_ones(cell, door):
    """To 1 um, orientation too; the deflection comes from the model at the stated joint angles."""
    _, _, program = door
    q = np.array([t.q for t in program.targets])
    wrench = np.array([t.wrench for t in program.targets])
    assert len(q) == 14
    twist = cell.springs.deflection(q, wrench, cell.layout.T_flange_tool[:3, 3])
    for target, d in zip(program.targets, twist, strict=True):
        loaded = target.T_base_tool_corrected[:3, 3] + d[:3]
        assert np.linalg.norm(loaded - target.T_base_tool_nominal[:3, 3]) < 1e-6
        turn = target.T_base_tool_nominal[:3, :3] @ target.T_base_tool_corrected[:3, :3].T
        axis = 0.5 * np.array([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]])
        assert axis == pytest.approx(d[3:], abs=1e-6)
        assert target.deflection == pytest.approx(d, abs=1e-12)


def test_deflections_are_of_the_size_the_thesis_reports(door):
    """Section 4: the largest compensation is 0.3 mm; the whole translation may be a little more.

    Our door stands 0.275 m further off than the thesis', and the longer arm gives way by a fifth more.
    """
    _, _, program = door
    assert 0.0002 < program.largest_correction < 0.0007


def test_milled_door_is_within_tolerance_and_better_than_uncorrected(cell, door):
    from doormill_ros.simulation.judge.milled_part import inspect

    recipe, T_base_door, program = door
    found = {}
    for corrected in (False, True):
        executed = cell.execute(program, cell.springs, corrected)
        found[corrected] = inspect(recipe, T_base_door, executed)
    assert found[True].max_deviation < 0.5 * found[False].max_deviation
    assert found[True].max_deviation < 0.0005  # the thesis' tolerance
    # A target between two segments has one pose for two loads: half of what the tool gives way
    # from one load to the other must stay. Target 11 has a third load, none, when the tool comes
    # and goes.
    half_step = 0.0
    for (_, name), before, after in joints_of(program):
        if name not in ("11", "21"):
            target = by_name(program)[name]
            load = np.array([before.wrench, after.wrench])
            twist = cell.springs.deflection(np.tile(target.q, (2, 1)), load, cell.layout.T_flange_tool[:3, 3])
            across = (twist[1, :3] - twist[0, :3]) @ T_base_door[:3, 1]
            half_step = max(half_step, 0.5 * abs(across))
    assert half_step < 0.5 * found[False].max_deviation
    for result in found[True].features:
        entry = np.linalg.norm(result.points - [-0.015, 0.045], axis=1) < 0.012
        assert np.abs(result.deviation[~entry]).max() < half_step + 1e-5


def joints_of(program):
    """Targets at which one cut follows another, with both motions."""
    motions = program.motions
    for i in range(1, len(motions)):
        if motions[i - 1].cutting and motions[i].cutting:
            yield (i, program.targets[motions[i - 1].target].name), motions[i - 1], motions[i]
