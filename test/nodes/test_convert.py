"""Programs and paths as messages, through the wire format and back."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import shapely
from rclpy.serialization import deserialize_message, serialize_message
from scipy.spatial.transform import Rotation
from std_msgs.msg import Header
from visualization_msgs.msg import Marker

from doormill_interfaces.msg import DoorPlacement, TargetArray
from doormill_interfaces.msg import ExecutedPath as ExecutedPathMessage
from doormill_ros.cell.places.layout import load_layout
from doormill_ros.messages.from_message import program_of, transform_of
from doormill_ros.nodes.base.nested_messages import reading
from doormill_ros.nodes.base.topics import PATH_TARGETS
from doormill_ros.nodes.convert.executed import executed_message, executed_of, milled_message, placed_at
from doormill_ros.nodes.convert.geometry import path_message
from doormill_ros.nodes.convert.markers import body_markers, program_markers
from doormill_ros.nodes.convert.program import Nested, program_into
from doormill_ros.recipes.documents import shipped_recipes
from doormill_ros.robot.bodies import Body
from doormill_ros.robot.configuration import ConfData
from doormill_ros.robot.description import load_robot
from doormill_ros.simulation.controller.records.executed_path import ExecutedPath
from doormill_ros.simulation.errors import RunMessageError
from doormill_ros.simulation.judge.milled_part import FeatureResult, MilledPart
from doormill_ros.toolpath.program import MillingProgram, Motion, MotionKind, Target
from doormill_ros.toolpath.settings import load_settings


def pose(rng: np.random.Generator) -> np.ndarray:
    T = np.eye(4)
    T[:3, :3] = Rotation.random(random_state=rng).as_matrix()
    T[:3, 3] = rng.uniform(-2.0, 2.0, 3)
    return T


def target(rng: np.random.Generator, index: int) -> Target:
    conf = ConfData(*(int(v) for v in rng.integers([-4, -4, -4, 0], [4, 4, 4, 8])))
    q, wrench, deflection = rng.normal(size=(3, 6))
    return Target(f"t{index}", pose(rng), pose(rng), q, conf, wrench, 1e-3 * deflection)


@pytest.fixture
def program() -> MillingProgram:
    rng = np.random.default_rng(6)
    targets = tuple(target(rng, i) for i in range(7))
    motions = (
        Motion(MotionKind.JOINT, 0, None, 0.5, "fine", "", False),
        Motion(MotionKind.LINEAR, 1, None, 0.02, "z1", "hinge_1", True, rng.normal(size=6), 400.0),
        Motion(
            MotionKind.CIRCULAR,
            3,
            2,
            0.02,
            "z0",
            "hinge_1",
            True,
            *rng.normal(size=(1, 6)),
            400.0,
            rng.normal(size=6),
        ),
    )
    return MillingProgram("door", 3, targets, motions)


def over_the_wire(message: Any) -> Any:
    return deserialize_message(serialize_message(message), type(message))


def as_nodes_hear_it(message: TargetArray) -> Any:
    heard: list[Any] = []
    reading(PATH_TARGETS, heard.append)(serialize_message(message))
    return heard[0]


both_ways = pytest.mark.parametrize("carried", [over_the_wire, as_nodes_hear_it])


@both_ways
def test_a_program_comes_back_as_it_was(program: MillingProgram, carried: Callable[[Any], Any]) -> None:
    message = carried(program_into(TargetArray(), program))
    assert message.largest_correction == program.largest_correction
    back = program_of(message)
    assert (back.door_id, back.recipe_version) == ("door", 3)
    assert len(back.targets) == len(program.targets)
    for found, wanted in zip(back.targets, program.targets, strict=True):
        assert (found.name, found.conf) == (wanted.name, wanted.conf)
        for name in ("T_base_tool_nominal", "T_base_tool_corrected"):
            assert np.abs(getattr(found, name) - getattr(wanted, name)).max() < 1e-14
        for name in ("q", "wrench", "deflection"):
            assert np.array_equal(getattr(found, name), getattr(wanted, name))
    assert len(back.motions) == len(program.motions)
    for found, wanted in zip(back.motions, program.motions, strict=True):
        fields = ("kind", "target", "via", "speed", "zone", "feature", "cutting", "spindle_speed")
        assert [getattr(found, f) for f in fields] == [getattr(wanted, f) for f in fields]
        assert np.array_equal(found.wrench, wanted.wrench)
        ends = [m.wrench if m.wrench_end is None else m.wrench_end for m in (found, wanted)]
        assert np.array_equal(*ends)


@both_ways
def test_ways_come_back_over_the_wire(carried: Callable[[Any], Any]) -> None:
    rng = np.random.default_rng(4)
    motions = (
        Motion(MotionKind.ABSOLUTE, 0, None, 0.5, "fine", "", False),
        Motion(MotionKind.JOINT, 0, None, 0.5, "fine", "hinge_1", False),
        Motion(MotionKind.JOINT, 0, None, 0.5, "fine", "hinge_2", False),
    )
    program = MillingProgram(
        "door",
        1,
        (),
        motions,
        tuple(rng.uniform(-3, 3, (5, 6))),
        rng.uniform(-3, 3, 6),
        (range(1, 3), range(3, 5)),
    )
    message = carried(program_into(TargetArray(), program))
    assert [(e.feature, e.first, e.last) for e in message.escapes] == [("hinge_1", 1, 2), ("hinge_2", 3, 4)]
    back = program_of(message)
    assert back.motions[0].kind is MotionKind.ABSOLUTE
    np.testing.assert_array_equal(back.points, program.points)
    np.testing.assert_array_equal(back.home, program.home)
    assert back.escapes == program.escapes


def test_every_body_is_shown_in_the_frame_that_moves_it() -> None:
    robot, layout, settings = load_robot("irb6600_175_255"), load_layout(), load_settings()
    post = Body("post", "capsule", radius=0.1, start=np.zeros(3), end=np.array([0.0, 0.3, 0.0]))
    markers = body_markers(robot, replace(layout, obstacles=(*layout.obstacles, post)), settings).markers
    shown = {(m.ns, m.id): m for m in markers}
    assert len(shown) == len(markers) == 11 + 1 + 6 + 3 + 3
    # Of the rack both holders, and the tool that is not in the spindle.
    assert ("tool rack_mill_12", 0) in shown
    assert ("tool rack_mill_16", 0) not in shown
    assert shown["holder of rack_mill_16", 0].scale.x == pytest.approx(0.21)
    disc = shown["turning disc", 0]
    assert (disc.header.frame_id, disc.pose.position.x, disc.scale.x) == ("link_6", 0.18, 0.04)
    assert shown["spindle", 0].header.frame_id == "flange"
    assert shown["floor", 0].header.frame_id == "base_link"
    # The cylinder's axis is z of its pose, the balls stand at its ends.
    assert transform_of(shown["post", 0].pose)[:3, 2] == pytest.approx([0.0, 1.0, 0.0])
    assert shown["post", 0].scale.z == pytest.approx(0.3)
    assert shown["post", 2].pose.position.y == pytest.approx(0.3)


def test_no_two_targets_share_a_message(program: MillingProgram) -> None:
    """They are filled in place, so a shared default would show the last one everywhere."""
    message = program_into(TargetArray(), program)
    poses = [p for t in message.targets for p in (t.nominal, t.corrected)]
    assert len({id(p) for p in poses}) == len({id(p.position) for p in poses}) == len(poses)
    wrenches = [m.wrench for m in (*message.targets, *message.motions)] + [
        m.wrench_end for m in message.motions
    ]
    vectors = [v for wrench in wrenches for v in (wrench.force, wrench.torque)]
    assert len({id(v) for v in vectors}) == len(vectors)


def test_a_message_tells_nothing_of_the_program_before(program: MillingProgram) -> None:
    """Its nested messages are those that told of it."""
    nested = Nested()
    program_into(TargetArray(), program, nested)
    shorter = replace(program, targets=program.targets[1:], motions=program.motions[1:])
    for wanted in (shorter, program):
        told = program_into(TargetArray(), wanted, nested)
        assert told == program_into(TargetArray(), wanted)
    assert told.targets[0] is nested.targets[0]
    assert told.motions[0] is nested.motions[0]


@both_ways
def test_a_program_without_targets(carried: Callable[[Any], Any]) -> None:
    back = program_of(carried(program_into(TargetArray(), MillingProgram("door", 1, (), ()))))
    assert (back.targets, back.motions) == ((), ())


def test_the_door_is_drawn_where_its_frame_says(program: MillingProgram) -> None:
    rng = np.random.default_rng(9)
    T_base_door = pose(rng)
    door = shipped_recipes()["thesis_190_0deg"]
    markers = program_markers(program, door, T_base_door, Header(frame_id="base_link")).markers
    (body,) = [marker for marker in markers if marker.ns == "door"]
    T_base_middle = transform_of(body.pose)
    half = np.array([body.scale.x, body.scale.y, body.scale.z]) / 2.0
    # Its corners in the door's frame: x into the thickness, y across the width, z up.
    for sides in itertools.product((0, 1), repeat=3):
        corner = T_base_middle @ [*((2.0 * np.array(sides) - 1.0) * half), 1.0]
        found = np.linalg.solve(T_base_door, corner)[:3]
        assert found == pytest.approx(np.array(sides) * [door.thickness, door.width, door.height], abs=1e-9)


def test_markers_show_every_target_and_a_hundredfold_correction(program: MillingProgram) -> None:
    door = shipped_recipes()["thesis_190_0deg"]
    markers = program_markers(program, door, np.eye(4), Header(frame_id="base_link")).markers
    assert markers[0].action == Marker.DELETEALL
    shown = {m.ns: np.array([[p.x, p.y, p.z] for p in m.points]) for m in markers}
    order = [0, 1, 2, 3]  # by the motions, the via target before the end of its arc
    nominal = np.array([program.targets[i].T_base_tool_nominal[:3, 3] for i in order])
    corrected = np.array([program.targets[i].T_base_tool_corrected[:3, 3] for i in order])
    assert np.abs(shown["nominal path"] - nominal).max() < 1e-12
    assert np.abs(shown["corrected path"] - corrected).max() < 1e-12
    assert np.abs(shown["correction x 100"][0::2] - nominal).max() < 1e-12
    drawn = shown["correction x 100"][1::2] - nominal
    assert drawn == pytest.approx(100.0 * (corrected - nominal), rel=1e-9)


def test_a_path_goes_through_the_poses(program: MillingProgram) -> None:
    header = Header(frame_id="base_link")
    wanted = [t.T_base_tool_nominal for t in program.targets]
    path = over_the_wire(path_message(header, wanted))
    assert path.header.frame_id == "base_link"
    assert len(path.poses) == len(wanted)
    for stamped, T in zip(path.poses, wanted, strict=True):
        p, q = stamped.pose.position, stamped.pose.orientation
        assert stamped.header.frame_id == "base_link"
        assert np.array_equal([p.x, p.y, p.z], T[:3, 3])
        assert np.abs(Rotation.from_quat([q.x, q.y, q.z, q.w]).as_matrix() - T[:3, :3]).max() < 1e-14
    assert over_the_wire(path_message(header, [])).poses == []


def test_an_executed_path_comes_back_as_it_was() -> None:
    rng = np.random.default_rng(8)
    n = 9
    path = ExecutedPath(
        time=np.sort(rng.uniform(0.0, 80.0, n)),
        T_base_tool=np.array([pose(rng) for _ in range(n)]),
        T_base_tool_commanded=np.array([pose(rng) for _ in range(n)]),
        q=rng.normal(size=(n, 6)),
        motion=np.arange(n) // 2,
        cutting=np.arange(n) % 3 == 0,
        feature=np.array(["", "hinge_1", "lock_case"] * 3),
        wrench=rng.normal(size=(n, 6)),
        tool=np.array(["", "mill_12", "mill_20"] * 3),
    )
    message = over_the_wire(executed_message(path, Header(), DoorPlacement(run_id="run", door_id="door")))
    assert (message.run_id, message.door_id) == ("run", "door")
    back = executed_of(message)
    for name in ("motion", "cutting", "feature", "tool"):
        np.testing.assert_array_equal(getattr(back, name), getattr(path, name))
    for name in ("time", "T_base_tool", "T_base_tool_commanded", "q", "wrench"):
        np.testing.assert_allclose(getattr(back, name), getattr(path, name), rtol=0.0, atol=1e-12)


def a_path(n: int = 4) -> ExecutedPathMessage:
    rng = np.random.default_rng(8)
    path = ExecutedPath(
        time=np.arange(float(n)),
        T_base_tool=np.array([pose(rng) for _ in range(n)]),
        T_base_tool_commanded=np.array([pose(rng) for _ in range(n)]),
        q=rng.normal(size=(n, 6)),
        motion=np.zeros(n, dtype=int),
        cutting=np.ones(n, dtype=bool),
        feature=np.array(["hinge_1"] * n),
        wrench=rng.normal(size=(n, 6)),
    )
    return executed_message(path, Header(), DoorPlacement(run_id="run_7", door_id="door"))


def far(message: ExecutedPathMessage) -> None:
    message.actual[1].position.x = 1e6


def strong(message: ExecutedPathMessage) -> None:
    message.wrench[2].force.z = -1e6


@pytest.mark.parametrize(
    ("spoil", "why"),
    [
        (lambda m: m.time.pop(), "T_base_tool has shape"),
        (lambda m: m.joint_positions.pop(), "reshape"),
        (lambda m: m.motion.pop(), "motion"),
        (lambda m: m.time.__setitem__(2, 0.5), "time"),
        (lambda m: m.time.__setitem__(3, float("nan")), "time"),
        (lambda m: m.time.__setitem__(3, 1e6), "time holds numbers beyond 100000"),
        (far, "T_base_tool holds numbers beyond 100000"),
        (strong, "wrench holds numbers beyond 100000"),
        (lambda m: m.joint_positions.__setitem__(0, 1e6), "q holds numbers beyond 100000"),
    ],
)
def test_an_executed_path_that_cannot_be_judged_says_why_and_of_which_run(
    spoil: Callable[[ExecutedPathMessage], object], why: str
) -> None:
    message = a_path()
    executed_of(message)
    spoil(message)
    with pytest.raises(
        RunMessageError, match=rf"executed path of run 'run_7' cannot be judged: .*{why}"
    ) as caught:
        executed_of(message)
    assert caught.value.data["run_id"] == "run_7"


@pytest.mark.parametrize("x", [1e6, -1e6, float("inf"), float("nan")])
def test_a_door_that_stands_nowhere_near_a_cell_is_not_judged(x: float) -> None:
    placement = DoorPlacement(run_id="run_7")
    placement.pose.orientation.w = 1.0
    placement.pose.position.x = 1.5
    assert placed_at(placement)[0, 3] == 1.5
    placement.pose.position.x = x
    with pytest.raises(
        RunMessageError, match="the door of run 'run_7' stands 100000 m or more away"
    ) as caught:
        placed_at(placement)
    assert caught.value.data["run_id"] == "run_7"


@pytest.mark.parametrize("floor", [(-3e-4, 1e-5), (-1e-5, 3e-4)])
def test_a_floor_counts_as_much_as_a_wall(floor: tuple[float, float]) -> None:
    recipe = shipped_recipes()["thesis_190_0deg"]

    def part(floor: tuple[float, float]) -> MilledPart:
        line, walls = np.arange(2.0), np.array([1e-4, -2e-4])
        shape = {"station": line, "points": np.zeros((2, 2)), "deviation": walls, "by_depth": walls[None]}
        rest = {"depths": np.zeros(1), "floor": floor, "uncleared": 0.0, "region": shapely.Polygon()}
        return MilledPart(
            tuple(FeatureResult(feature=f.id, milled=True, **shape, **rest) for f in recipe.features)
        )

    message = milled_message(recipe, part(floor), part((-9e-4, 0.0)), 5e-4, Header(), DoorPlacement())
    assert (message.corrected_max, message.uncorrected_max) == (3e-4, 9e-4)
    assert {(f.corrected_max, f.uncorrected_max) for f in message.features} == {(3e-4, 9e-4)}
