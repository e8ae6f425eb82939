"""Every error has a code of its own and a sentence with feature, found, allowed and what to do."""

import inspect
import math
from dataclasses import replace

import numpy as np
import pytest
import yaml

from doormill_ros.cell.rapid_limits import MAX_TARGETS
from doormill_ros.collision.sweep import contact_along
from doormill_ros.collision.world import Mill, PlacedDoor, World
from doormill_ros.frames import transform
from doormill_ros.recipes.cutting import Cutting
from doormill_ros.recipes.features.hinge_pocket import LeafHinge
from doormill_ros.resources import resource
from doormill_ros.robot.bodies import Body
from doormill_ros.robot.description import load_robot
from doormill_ros.robot_model.elastic.joint_springs import JointSpringModel
from doormill_ros.toolpath import errors
from doormill_ros.toolpath.air.clearance import check_air
from doormill_ros.toolpath.air.route import route
from doormill_ros.toolpath.curves.arcs import check_arcs
from doormill_ros.toolpath.cuts.operation import operation
from doormill_ros.toolpath.door_checks import check_door
from doormill_ros.toolpath.program import MillingProgram, MotionKind
from doormill_ros.toolpath.settings import load_settings
from doormill_ros.toolpath.split import split
from support.cycle import require_cycle
from support.source_tree import ROOT

LEAVES = [
    c
    for _, c in inspect.getmembers(errors, inspect.isclass)
    if issubclass(c, errors.PathError) and c is not errors.PathError
]


def test_codes_are_unique_and_in_range():
    codes = [leaf.code for leaf in LEAVES]
    assert len(set(codes)) == len(codes)
    assert all(300 < code < 400 for code in codes)
    documented = (ROOT / "docs" / "errors.md").read_text(encoding="utf-8")
    for leaf in LEAVES:
        assert f"| {leaf.code} | `{leaf.__name__}` |" in documented


@pytest.fixture
def recipe(cell):
    return cell.recipe("standard_door")


def with_features(recipe, *features):
    return replace(recipe, features=features)


def refused(cell, recipe, kind, words, T_base_door=None, **options):
    """The error, after looking at its sentence."""
    T_base_door = cell.T_base_door(recipe) if T_base_door is None else T_base_door
    with pytest.raises(kind, match=words) as caught:
        cell.program(recipe, T_base_door, **options)
    message = caught.value.message
    assert "allowed" in message or "beyond" in message or "cannot reach" in message
    assert ";" in message  # what to do
    assert "\n" not in message
    return caught.value


@pytest.mark.parametrize(
    ("offset", "axis"),
    [((0.012, 0, 0), "y"), ((0, -0.0106, 0), "z"), ((0, 0, math.radians(2.2)), "rotation")],
)
def test_a_door_beyond_the_placement_limits(cell, recipe, offset, axis):
    error = refused(cell, recipe, errors.DoorPoseError, "place it again", cell.T_base_door(recipe, *offset))
    assert error.data["axis"] == axis


def test_a_door_at_the_placement_limits_is_milled(cell):
    recipe = cell.recipe("thesis_1350_0deg")
    for sign in (-1, 1):
        T = cell.T_base_door(recipe, sign * 0.010, -sign * 0.010, sign * math.radians(2))
        assert len(cell.program(recipe, T).targets) == 14


def test_a_door_out_of_its_clamp(cell, recipe):
    T = np.array(cell.T_base_door(recipe))
    T[0, 3] += 0.004
    refused(cell, recipe, errors.DoorPoseError, r"\+4.00 mm off in x.*close the clamp", T)


def test_nothing_to_mill(cell, recipe):
    refused(
        cell, recipe, errors.NothingToMillError, "standard_door leaves this robot 0 features", operations=[]
    )


def test_out_of_reach(cell):
    """The top of the highest door, 2.85 m above the robot's foot, is above the bottom robot's reach."""
    recipe = cell.recipe("thesis_190_0deg")
    high = replace(recipe.features[0], height=3.5)
    refused(
        cell,
        with_features(replace(recipe, height=3.6), high),
        errors.ReachError,
        "hinge_1, motion .* cannot reach",
    )


def test_beyond_a_joint_limit(cell):
    recipe = cell.recipe("thesis_190_0deg")
    ops = [operation(replace(recipe.features[0], side=type(recipe.features[0].side).REAR), recipe.size)]
    refused(cell, recipe, (errors.PathJointLimitError, errors.ReachError), "hinge_1, motion", operations=ops)


def test_too_close_to_a_singularity(cell, recipe):
    """On a door whose hinge edge is straight before the robot, at wrist height, axes 4 and 6 line up."""
    narrow = replace(recipe, width=0.670 + 2 * 0.025, height=3.0)
    stiff = JointSpringModel(cell.robot, 10.0 * cell.robot.stiffness)
    found = []
    for height in np.arange(1.6, 2.6, 0.05):
        hinge = replace(recipe.feature("hinge_1"), height=float(height), length=0.12)
        try:
            cell.program(with_features(narrow, hinge), cell.T_base_door(narrow), model=stiff)
        except errors.PathSingularityError as error:
            found.append(error)
    assert found
    assert all("axis 5 is" in e.message and "allowed is 3" in e.message for e in found)


def test_a_feed_that_a_joint_cannot_follow(cell, recipe):
    fast = replace(
        recipe.feature("hinge_1"), cutting=Cutting(spindle_speed=300.0, feed=0.5, plunge_feed=0.005)
    )
    slow = load_settings()
    slow = replace(slow, checks=replace(slow.checks, joint_speed_share=0.05))
    error = refused(
        cell, with_features(recipe, fast), errors.JointSpeedError, "lower the feed from 500 to", settings=slow
    )
    # The feed it names is one that passes.
    possible = float(error.message.split(" to ")[-1].split(" mm/s")[0]) * 1e-3
    good = replace(fast, cutting=Cutting(spindle_speed=300.0, feed=0.98 * possible, plunge_feed=0.005))
    cell.program(with_features(recipe, good), cell.T_base_door(recipe), settings=slow)


def test_air_motions_are_slowed_instead(cell, recipe):
    slow = load_settings()
    slow = replace(slow, checks=replace(slow.checks, joint_speed_share=0.1))
    speeds = []
    for settings in (load_settings(), slow):
        program = cell.program(recipe, cell.T_base_door(recipe), settings=settings)
        speeds.append([m.speed for m in program.motions if not m.cutting])
    assert 0.2 in speeds[0]  # the speed towards the wood, as it is set
    assert 0.2 not in speeds[1]
    assert len(speeds[0]) == len(speeds[1])
    assert all(0.0 < after <= before for before, after in zip(*speeds, strict=True))


def test_a_correction_beyond_the_limit(cell, recipe):
    soft = JointSpringModel(cell.robot, cell.robot.stiffness / 5.0)
    error = refused(
        cell,
        recipe,
        errors.CorrectionLimitError,
        r"hinge_\d, target \d+: the robot bends by [1-9].* mm",
        model=soft,
    )
    assert error.data["found"] > error.data["allowed"] == 0.001


def test_a_model_that_jumps(cell, recipe):
    class Jumping:
        """Deflects by 0.3 mm to whichever side of the nominal hinge the tool stands on."""

        def deflection(self, q, wrench, load_point, direction=None):
            z = (cell.kinematics.forward(q) @ cell.layout.T_flange_tool)[:, 2, 3]
            twist = np.zeros((len(q), 6))
            twist[:, 2] = 1.5e-4 * np.where(np.floor(z / 1e-4) % 2 == 0, 1.0, -1.0)
            return twist * (np.abs(wrench).max(axis=1) > 0)[:, None]

    one = with_features(recipe, recipe.feature("hinge_1"))
    refused(cell, one, errors.CorrectionSettleError, "the robot model jumps there", model=Jumping())


def test_too_many_targets(cell, recipe):
    tight = load_settings()
    tight = replace(tight, checks=replace(tight.checks, targets=100.0))
    refused(cell, recipe, errors.ProgramSizeError, "targets, allowed are 100", settings=tight)


def test_a_door_for_which_the_tool_would_have_to_be_changed(cell, recipe):
    """Without a rack the hinges would be milled with the lock case's mill."""
    hinge = recipe.feature("hinge_1")
    other = replace(hinge, tool=replace(hinge.tool, name="mill_12", diameter=0.012))
    two = with_features(recipe, other, recipe.feature("lock_case"))
    words = r"lock_case: the door takes 2 tools \(mill_12 for hinge_1, mill_16 for lock_case\), allowed are 1 where"
    bare = replace(cell.layout, rack=None)
    error = refused(cell, two, errors.ToolChangeError, words, layout=bare)
    assert error.data == {"feature": "lock_case", "found": 2, "allowed": 1}
    many = load_settings()
    many = replace(many, checks=replace(many.checks, tools=2.0))
    assert cell.program(two, cell.T_base_door(two), settings=many).targets
    for share in split(two, cell.T_base_door(two), load_settings()):
        assert cell.program(two, share.T_base_door, operations=share.operations).targets


def test_no_more_targets_than_the_rapid_module_keeps():
    assert load_settings().checks.targets == MAX_TARGETS


def test_an_arc_that_no_movec_follows(cell, recipe):
    program = cell.program(recipe, cell.T_base_door(recipe))
    i = next(k for k, m in enumerate(program.motions) if m.via is not None and m.feature == "hinge_2")
    motion = program.motions[i]
    start = program.targets[program.motions[i - 1].target]
    for via, words in (
        (start.T_base_tool_corrected, "are 0.000 mm apart"),
        (
            0.5 * (start.T_base_tool_corrected + program.targets[motion.target].T_base_tool_corrected),
            "bends by",
        ),
    ):
        targets = list(program.targets)
        targets[motion.via] = replace(targets[motion.via], T_base_tool_corrected=via)
        with pytest.raises(errors.ArcError, match=rf"hinge_2, target .*{words}.*check radius and tool"):
            check_arcs(MillingProgram("x", 0, tuple(targets), program.motions))


def world_of(cell, recipe, T, width=0.0, mill=None, layout=None):
    approach = load_settings().approach
    size = np.array([recipe.thickness, recipe.width + width, recipe.height])
    mill = mill or Mill(approach.nose, approach.mill_radius)
    return World(cell.robot, layout or cell.layout, mill, PlacedDoor(size, T))


def routed(cell, recipe, T, layout=None):
    ops = [operation(f, recipe.size) for f in recipe.features]
    return route(recipe, ops, T, layout or cell.layout, cell.robot, load_settings())


def test_a_way_through_the_wood(cell, recipe):
    """The door made wider than it was when a swing round its edge was planned clear of it."""
    T = cell.T_base_door(recipe)
    plan, path = routed(cell, recipe, T)
    check_air(plan.steps, path, world_of(cell, recipe, T))
    with pytest.raises(
        errors.AirMoveError, match=r"on the way there \w+ and door (pass|overlap).* 12 mm"
    ) as found:
        check_air(plan.steps, path, world_of(cell, recipe, T, width=0.2))
    assert found.value.data["obstacle"] == "door"
    assert found.value.data["found"] < found.value.data["allowed"] == pytest.approx(0.012)


def test_of_a_swing_the_motion_is_named_that_touches_something(cell, recipe):
    T = cell.T_base_door(recipe)
    plan, path = routed(cell, recipe, T)
    swings = [i for i, step in enumerate(plan.steps) if i and step.kind is MotionKind.ABSOLUTE]
    assert swings[1] == swings[0] + 1
    wider = world_of(cell, recipe, T, width=0.2)
    touching = [i for i in swings if contact_along(wider, path.stations[[i - 1, i], -1])]
    only = [step if step.kind is MotionKind.ABSOLUTE else step.changed(cutting=True) for step in plan.steps]
    with pytest.raises(errors.AirMoveError) as found:
        check_air(only, path, wider)
    assert found.value.data["motion"] == touching[0] + 1
    assert touching[0] > swings[0]


def test_a_mill_longer_than_the_way_in_front_of_the_face(cell, recipe):
    T = cell.T_base_door(recipe)
    plan, path = routed(cell, recipe, T)
    longer = transform(np.eye(3), np.array([0.0, 0.0, 0.019]))
    long = replace(cell.layout, T_flange_tool=cell.layout.T_flange_tool @ longer)
    for mill, found in ((Mill(0.05, 0.01), 1), (Mill(0.05, 0.025), 11)):
        with pytest.raises(errors.AirMoveError, match=f"mill and door pass at {found} mm"):
            check_air(plan.steps, path, world_of(cell, recipe, T, mill=mill, layout=long))


@pytest.mark.parametrize("diameter", [0.040, 0.060])
def test_a_wide_mill_needs_the_room_of_a_wide_mill(cell, recipe, diameter):
    """A leaf 2 mm above the lower end of a thick door: its wall is at the same place for every mill."""
    hinge = recipe.feature("hinge_1")
    shared = {k: getattr(hinge, k) for k in ("id", "side", "passes", "wrench_table", "wrench_point")}
    low = LeafHinge(
        **shared, height=0.052, backset=0.095, width=0.07, length=0.1, depth=0.008, corner_radius=0.03,
        tool=replace(hinge.tool, diameter=diameter, cutting_length=0.06),
        cutting=Cutting(spindle_speed=400.0, feed=0.03),
    )  # fmt: skip
    door = replace(recipe, width=0.19, thickness=0.06, features=(low,))
    # Up to 15 mm below the nominal door.
    sill = obstacle("high sill", [1.925, 0.335, -0.3325], [0.2, 0.17, 0.335])
    with pytest.raises(errors.BodyContactError, match=r"hinge_1: .*mill and high sill pass at [\d.]+ mm"):
        routed(cell, door, cell.T_base_door(door, z=-0.01), among(cell, sill))
    high = replace(door, features=(replace(low, height=1.0),))
    routed(cell, high, cell.T_base_door(high, z=-0.01), among(cell, sill))


def obstacle(name, position, size):
    return Body(name, "box", size=np.array(size), position=np.array(position), rotation=np.zeros(3))


def among(cell, *obstacles):
    return replace(cell.layout, obstacles=(*cell.layout.obstacles, *obstacles))


def test_an_arm_that_touches_something_while_the_tool_is_in_a_feature(cell, recipe):
    T = cell.T_base_door(recipe)
    _, path = routed(cell, recipe, T)
    elbow = cell.kinematics.link_frames(path.stations[1, -1])[2, :3, 3]
    layout = among(cell, obstacle("lamp", elbow + np.array([0.1, 0.0, 0.3]), [0.1, 2.0, 0.1]))
    with pytest.raises(
        errors.BodyContactError, match=r"hinge_1: with the tool in it .* and lamp overlap by"
    ) as found:
        routed(cell, recipe, T, layout)
    assert (found.value.code, found.value.data["feature"]) == (317, "hinge_1")


def test_a_home_inside_something(cell, recipe):
    tip = (cell.kinematics.forward(cell.layout.home) @ cell.layout.T_flange_tool)[:3, 3]
    layout = among(cell, obstacle("shelf", tip, [0.2, 0.2, 0.2]))
    with pytest.raises(errors.HomeContactError, match=r"at home .* and shelf overlap"):
        routed(cell, recipe, cell.T_base_door(recipe), layout)


def test_a_cage_that_no_way_leads_out_of(cell, recipe):
    """A thin wall right across the cell between home and the door, as high and as low as the arm reaches."""
    layout = among(cell, obstacle("wall", [1.57, 0.0, 1.5], [0.01, 6.0, 4.0]))
    with pytest.raises(errors.PathError) as found:
        routed(cell, recipe, cell.T_base_door(recipe), layout)
    assert found.value.data["obstacle"] == "wall"


def test_a_pocket_deeper_than_the_mill_reaches_out_of_the_spindle(cell, recipe):
    deep = replace(recipe.feature("lock_case"), depth=0.1101)
    words = "lock_case: it is 110.1 mm deep, allowed are 110.0 mm"
    error = refused(cell, with_features(recipe, deep), errors.HolderError, words)
    assert error.data["found"] == pytest.approx(0.1101)
    just = with_features(recipe, replace(deep, depth=0.1099))
    assert cell.program(just, cell.T_base_door(just)).targets


def test_a_cycle_that_takes_too_long(cell, recipe):
    slow = replace(recipe.feature("lock_case"), cutting=Cutting(spindle_speed=300.0, feed=0.01))
    recipe = with_features(recipe, slow)
    program = cell.program(recipe, cell.T_base_door(recipe))
    with pytest.raises(
        errors.CycleTimeError, match=r"lock_case: it takes .* allowed are 80.0 s; raise its feed"
    ):
        require_cycle([check_door(program, recipe, cell.robot)])


@pytest.mark.parametrize(
    ("part", "key", "value"),
    [("correction", "limit", -1.0), ("approach", "retreats", [0.1, "far"]), ("checks", "wrist", float("nan")),
     ("cycle", "total", None), ("second_robot", "position", [1.0, 2.0]), ("correction", "colour", 1.0),
     ("cycle", "slots", 5.0), ("cycle", "hinges", "long"), ("cycle", "hole_side", None), ("checks", "targets", 2001)],
)  # fmt: skip
def test_settings_that_cannot_be(tmp_path, part, key, value):
    document = yaml.safe_load(resource("config/toolpath.yaml").read_text(encoding="utf-8"))
    document[part][key] = value
    path = tmp_path / "toolpath.yaml"
    path.write_text(yaml.safe_dump(document), encoding="utf-8")
    with pytest.raises(errors.PathSettingsError, match="allowed") as error:
        load_settings(path)
    assert part in error.value.message
    assert str(path) in error.value.message


def test_an_unknown_time_budget_is_refused_with_those_that_features_have(tmp_path):
    path = tmp_path / "toolpath.yaml"
    text = resource("config/toolpath.yaml").read_text(encoding="utf-8")
    path.write_text(text.replace("  hole_side:", "  hole_sides:"), encoding="utf-8")
    words = "cycle.hole_sides is unknown, allowed are .*, hinges, lock_case, hole_side; compare it with"
    with pytest.raises(errors.PathSettingsError, match=words):
        load_settings(path)


def test_another_robot_works_too(cell, recipe):
    """The cell of appendix A.1 has IRB 6700-235/2.65."""
    robot = load_robot("irb6700_235_265")
    from doormill_ros.toolpath.generate import generate_program

    program = generate_program(recipe, cell.T_base_door(recipe), cell.layout, robot, JointSpringModel(robot))
    assert len({m.feature for m in program.motions} - {""}) == len(recipe.features)
