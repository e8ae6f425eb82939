"""A model.yaml that tells where the unloaded tool stands: what it says of a tool, and what is refused."""

import numpy as np
import pytest
import yaml

from doormill_ros.robot.description import load_robot
from doormill_ros.robot.kinematics import Kinematics
from doormill_ros.robot_model.displacement import Displacement
from doormill_ros.robot_model.elastic.causes.registry import build_cause
from doormill_ros.robot_model.errors import ExtendedModelError
from doormill_ros.robot_model.extended_document import model_document
from doormill_ros.robot_model.extended_model import SizedCause, load_model_of
from doormill_ros.simulation.truth.chain import chain
from doormill_ros.simulation.world.robot import WorldRobot
from doormill_ros.simulation.world.world_file import RobotOfWorld, ToolOfWorld

ROBOT = load_robot("irb6600_175_255")
TIP = np.array([0.0, 0.0, 0.3])
Q = np.random.default_rng(1).uniform(-0.8, 0.8, (20, 6))
PLACED = Displacement((1e-4, -2e-4, 3e-4), turn=2e-4, std=1e-5)
HEAVY = Displacement(mass=20.0, mass_std=0.5, centre=0.12)


def written(folder, standing):
    document = model_document(ROBOT.name, ROBOT.stiffness, (), "a test", standing=standing)
    path = folder / "model.yaml"
    path.write_text(yaml.safe_dump(document))
    return path


def tips(q):
    T = Kinematics(ROBOT).forward(q)
    return T[:, :3, :3] @ TIP + T[:, :3, 3]


def test_a_displaced_door_has_the_tool_on_its_other_side(tmp_path):
    model = load_model_of(ROBOT, written(tmp_path, PLACED))
    c, s = np.cos(PLACED.turn), np.sin(PLACED.turn)
    turned = tips(Q) @ np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]]).T
    door = turned + PLACED.shift - tips(Q)
    assert np.abs(model.standing(Q, TIP)[:, :3] + door).max() < 1e-7
    loaded = model.deflection(Q, np.full((20, 6), 50.0), TIP)
    springs = load_model_of(ROBOT).deflection(Q, np.full((20, 6), 50.0), TIP)
    assert np.allclose(loaded - springs, model.standing(Q, TIP), atol=1e-12)
    assert np.allclose(model.standing_spread(Q, TIP, np.zeros(6)).rest, PLACED.std)


def test_an_untold_weight_turns_every_joint_by_the_work_that_it_does(tmp_path):
    model = load_model_of(ROBOT, written(tmp_path, HEAVY))

    def height(q):
        T = Kinematics(ROBOT).forward(q)
        return (T[:, :3, :3] @ [0.0, 0.0, HEAVY.centre] + T[:, :3, 3])[:, 2]

    step = 1e-6
    turns = np.zeros_like(Q)
    for k in range(6):
        up, down = Q.copy(), Q.copy()
        up[:, k] += step
        down[:, k] -= step
        torque = -HEAVY.mass * 9.80665 * (height(up) - height(down)) / (2.0 * step)
        turns[:, k] = torque / ROBOT.stiffness[k]
    moved = tips(Q + turns) - tips(Q)
    assert np.abs(moved).max() > 5e-5
    assert np.abs(model.standing(Q, TIP)[:, :3] - moved).max() < 1e-6


@pytest.mark.parametrize(
    ("change", "complaint"),
    [
        ({"shift": [0.0, 0.0]}, "shift of standing is"),
        ({"std": -1e-6}, "std of standing is -1e-06"),
        ({"turn": float("nan")}, "standing has a number that is not finite"),
        ({"mass": None}, "cannot be used"),
    ],
)
def test_a_standing_of_no_use_is_refused(tmp_path, change, complaint):
    path = written(tmp_path, PLACED)
    document = yaml.safe_load(path.read_text())
    document["standing"] |= change
    path.write_text(yaml.safe_dump(document))
    with pytest.raises(ExtendedModelError, match=complaint):
        load_model_of(ROBOT, path)


def test_a_weight_bears_on_softer_springs_and_on_gaps_as_it_does_on_an_arm_that_has_them(tmp_path):
    # The arm of a world: it knows of torques, springs and gaps, and of no model.
    gap, soft = 1.5e-4, 0.6
    causes = [
        SizedCause(build_cause("joint_backlash", "joint 2"), np.array([gap, 0.0])),
        SizedCause(build_cause("joint_stiffness", "joint 3"), np.array([soft * ROBOT.stiffness[2]])),
    ]
    document = model_document(ROBOT.name, ROBOT.stiffness, causes, "a test", standing=HEAVY)
    (tmp_path / "model.yaml").write_text(yaml.safe_dump(document))
    model = load_model_of(ROBOT, tmp_path / "model.yaml")
    world = WorldRobot(
        ROBOT.dh,
        RobotOfWorld(gap=(0.0, gap, 0.0, 0.0, 0.0, 0.0), stiffness_factor=(1.0, 1.0, soft, 1.0, 1.0, 1.0)),
        ToolOfWorld(mass=HEAVY.mass, com=(0.0, 0.0, HEAVY.centre)),
    )
    rng = np.random.default_rng(3)
    wrench, direction = rng.normal(0.0, 60.0, (20, 6)), rng.choice([-1.0, 1.0], (20, 6))
    T = world.flange(Q, wrench, TIP, direction)
    moved = T[:, :3, :3] @ TIP + T[:, :3, 3] - tips(Q)
    told = model.deflection(Q, wrench, TIP, direction)[:, :3]
    assert np.abs(told - moved).max() < 2e-6  # to first order
    # Postures in which the weight pushes joint 2 the other way than the process does.
    light = load_model_of(ROBOT, written(tmp_path, Displacement()))
    alone = WorldRobot(ROBOT.dh, RobotOfWorld(), ToolOfWorld(mass=HEAVY.mass, com=(0.0, 0.0, HEAVY.centre)))
    torques = [
        arm.torques(chain(ROBOT.dh, Q), load, TIP)[:, 1]
        for arm, load in ((alone, 0.0 * wrench), (world, wrench))
    ]
    assert np.sum(torques[1] * (torques[1] - torques[0]) < 0.0) >= 3
    assert np.abs(light.deflection(Q, wrench, TIP, direction)[:, :3] - moved).max() > 1e-4
