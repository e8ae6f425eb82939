"""Corrected postures against a general root finder, and the cases in which no correction exists."""

import numpy as np
import pytest
from scipy.optimize import fsolve
from scipy.spatial.transform import Rotation

from doormill_ros.cell.places.layout import load_layout
from doormill_ros.correction.compensate import MAX_ITERATIONS, compensate
from doormill_ros.correction.loaded_robot import LoadedRobot
from doormill_ros.correction.loads import certain
from doormill_ros.robot.description import load_robot
from doormill_ros.robot.kinematics import Kinematics
from doormill_ros.robot_model.elastic.joint_springs import JointSpringModel

# Bottom and top hinge of the thesis' table 4.6, and poses between and beside them; degrees.
POSTURES = np.radians(
    [
        [-13.58, 69.54, 34.97, -14.01, -104.10, -93.48],
        [13.58, 6.89, -44.31, -21.68, 39.46, -72.94],
        [0.0, 40.0, 0.0, 10.0, -60.0, 0.0],
        [25.0, 55.0, 20.0, 30.0, -80.0, 45.0],
    ]
)
WRENCH = np.array([-209.0, 29.0, 12.0, -5.0, -43.0, 3.0])


@pytest.fixture(scope="module")
def bench():
    robot = load_robot("irb6600_175_255")
    # Twice as soft as the real one, so that the correction is not small.
    return LoadedRobot(
        Kinematics(robot), JointSpringModel(robot, 0.5 * robot.stiffness), load_layout().T_flange_tool
    )


def loads(n, seed=0):
    rng = np.random.default_rng(seed)
    return WRENCH * rng.uniform(-2.0, 2.0, size=(n, 6))


def perturbed(n, seed=1):
    rng = np.random.default_rng(seed)
    return POSTURES[rng.integers(len(POSTURES), size=n)] + rng.uniform(-0.1, 0.1, size=(n, 6))


def loaded_pose(bench, q, wrench):
    """Where the loaded tool stands, one posture, with scipy's rotations."""
    T = bench.kinematics.forward(q) @ bench.T_flange_tool
    d = bench.model.deflection(q[None], wrench[None], bench.load_point)[0]
    return T[:3, 3] + d[:3], Rotation.from_rotvec(d[3:]).as_matrix() @ T[:3, :3]


def test_loaded_tool_is_back_on_the_nominal_pose(bench):
    q, wrench = perturbed(100), loads(100)
    T = bench.kinematics.forward(q) @ bench.T_flange_tool
    found = bench.corrected(T, q, certain(wrench, np.zeros((100, 6))))
    assert found.iterations <= 5
    worst = 0.0
    for k in range(100):
        position, rotation = loaded_pose(bench, found.q[k], wrench[k])
        assert np.linalg.norm(position - T[k, :3, 3]) < 1e-6
        turn = Rotation.from_matrix(rotation @ T[k, :3, :3].T).magnitude()
        assert turn < 1e-6
        worst = max(worst, np.linalg.norm(found.T_base_tool[k, :3, 3] - T[k, :3, 3]))
        assert found.T_base_tool[k] == pytest.approx(
            bench.kinematics.forward(found.q[k]) @ bench.T_flange_tool, abs=1e-12
        )
    assert worst > 5e-4  # otherwise the test has not moved anything


def test_one_mirrored_step_would_not_do(bench):
    """Subtracting the deflection of the nominal posture, as the thesis does, is off by more than 0.1 um."""
    q, wrench = POSTURES[:1], 3.0 * WRENCH[None]
    T = bench.kinematics.forward(q) @ bench.T_flange_tool
    d = bench.model.deflection(q, wrench, bench.load_point)
    found = bench.corrected(T, q, certain(wrench, np.zeros((1, 6))))
    exact = T[0, :3, 3] - found.T_base_tool[0, :3, 3]
    assert np.linalg.norm(exact - d[0, :3]) > 1e-7
    assert np.linalg.norm(exact - d[0, :3]) < 2e-5


@pytest.mark.parametrize("row", range(4))
def test_agrees_with_a_general_root_finder(bench, row):
    q, wrench = POSTURES[row], 2.0 * WRENCH
    T = bench.kinematics.forward(q) @ bench.T_flange_tool

    def missing(angles):
        position, rotation = loaded_pose(bench, angles, wrench)
        turn = Rotation.from_matrix(rotation @ T[:3, :3].T).as_rotvec()
        return np.concatenate([position - T[:3, 3], turn])

    expected = fsolve(missing, q, xtol=1e-13)
    found = bench.corrected(T[None], q[None], certain(wrench[None], np.zeros((1, 6))))
    assert found.q[0] == pytest.approx(expected, abs=2e-6)
    assert np.abs(expected - q).max() > 1e-4


def test_a_shared_target_is_corrected_for_the_mean_of_its_loads(bench):
    q = POSTURES[2:3]
    T = bench.kinematics.forward(q) @ bench.T_flange_tool
    wrench = np.stack([WRENCH, -0.4 * WRENCH])
    found = bench.corrected_for_all(T, q, np.array([0, 0]), certain(wrench, np.zeros((2, 6))))
    for one, sign in ((wrench[0], 1.0), (wrench[1], -1.0)):
        position, _ = loaded_pose(bench, found.q[0], one)
        half = bench.model.deflection(found.q, (wrench[:1] - wrench[1:]) / 2, bench.load_point)[0, :3]
        assert position - T[0, :3, 3] == pytest.approx(sign * half, abs=1.5e-6)


def test_direction_of_motion_reaches_the_model(bench):
    """A model that only bends when joint 1 moves forwards gets corrected only then."""

    class OneWay:
        def deflection(self, q, wrench, load_point, direction=None):
            twist = np.zeros((len(q), 6))
            twist[:, 1] = 1e-4 * (direction[:, 0] > 0)
            return twist

    one_way = LoadedRobot(bench.kinematics, OneWay(), bench.T_flange_tool)
    q = np.tile(POSTURES[0], (3, 1))
    T = bench.kinematics.forward(q) @ bench.T_flange_tool
    direction = np.zeros((3, 6))
    direction[:, 0] = [-1, 0, 1]
    found = one_way.corrected(T, q, certain(np.zeros((3, 6)), direction))
    step = found.T_base_tool[:, :3, 3] - T[:, :3, 3]
    assert step == pytest.approx(np.array([[0, 0, 0], [0, 0, 0], [0, -1e-4, 0]]), abs=1e-6)


def test_a_step_without_solution_ends_at_it_and_says_so(bench):
    """Deflection that jumps over the nominal place: the residual is what the step leaves."""
    q = POSTURES[:1]
    T = bench.kinematics.forward(q) @ bench.T_flange_tool
    y0 = T[0, 1, 3]

    def deflect(angles):
        y = (bench.kinematics.forward(angles) @ bench.T_flange_tool)[:, 1, 3]
        twist = np.zeros((1, 6))
        twist[:, 1] = np.where(y > y0 - 5e-5, 8e-5, 2e-5)
        return twist

    found = compensate(T, q, deflect, bench.kinematics, bench.T_flange_tool)
    assert found.iterations == MAX_ITERATIONS
    # The jump lies at 50 um before the nominal place: 30 um are missing below it and too much above.
    assert found.residual[0] == pytest.approx(3e-5, abs=1e-7)


def test_many_targets_at_once_are_the_same_as_one_by_one(bench):
    q, wrench = perturbed(12, seed=6), loads(12, seed=7)
    T = bench.kinematics.forward(q) @ bench.T_flange_tool
    together = bench.corrected(T, q, certain(wrench, np.zeros((12, 6))))
    for k in range(12):
        alone = bench.corrected(T[k : k + 1], q[k : k + 1], certain(wrench[k : k + 1], np.zeros((1, 6))))
        assert together.q[k] == pytest.approx(alone.q[0], abs=1e-8)
