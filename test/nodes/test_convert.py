"""Programs and paths as messages, through the wire format and back."""

from __future__ import annotations

import numpy as np
import pytest
from nav_msgs.msg import Path
from rclpy.serialization import deserialize_message, serialize_message
from scipy.spatial.transform import Rotation
from std_msgs.msg import Header

from doormill_interfaces.msg import TargetArray
from doormill_ros.nodes.convert.geometry import path_message
from doormill_ros.nodes.convert.program import program_into, program_of
from doormill_ros.toolpath.program import ConfData, MillingProgram, Motion, MotionKind, Target


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
        Motion(MotionKind.CIRCULAR, 3, 2, 0.02, "z0", "hinge_1", True, rng.normal(size=6), 400.0),
    )
    return MillingProgram("door", 3, targets, motions)


def over_the_wire(message: TargetArray | Path) -> TargetArray | Path:
    return deserialize_message(serialize_message(message), type(message))


def test_a_program_comes_back_as_it_was(program: MillingProgram) -> None:
    message = over_the_wire(program_into(TargetArray(), program))
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


def test_no_two_targets_share_a_message(program: MillingProgram) -> None:
    """They are filled in place, so a shared default would show the last one everywhere."""
    message = program_into(TargetArray(), program)
    poses = [p for t in message.targets for p in (t.nominal, t.corrected)]
    assert len({id(p) for p in poses}) == len({id(p.position) for p in poses}) == len(poses)
    vectors = [v for m in (*message.targets, *message.motions) for v in (m.wrench.force, m.wrench.torque)]
    assert len({id(v) for v in vectors}) == len(vectors)


def test_a_program_without_targets() -> None:
    back = program_of(over_the_wire(program_into(TargetArray(), MillingProgram("door", 1, (), ()))))
    assert (back.targets, back.motions) == ((), ())


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
