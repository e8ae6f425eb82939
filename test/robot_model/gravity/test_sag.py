"""Torques of weight against Pinocchio and potential energy, the sag against finite turns, what teaching takes up."""

from dataclasses import replace

import numpy as np
import pinocchio
import pytest
from scipy.spatial.transform import Rotation

from doormill_ros.robot.description import load_robot
from doormill_ros.robot.kinematics import Kinematics
from doormill_ros.robot_model.gravity.sag import GravitySag, rigid_part
from doormill_ros.robot_model.gravity.weights import Weight, torque_by_mass, torques
from support.inverse_kinematics import inverse

POINT = np.array([0.0, 0.0, 0.25])
G = 9.80665
STIFF = 30.0  #: what is of second order in the turns becomes small beside them


@pytest.fixture(scope="module")
def robot():
    return load_robot("irb6600_175_255")


def some_weights(seed=0, carried=1.0, carried_std=0.0):
    rng = np.random.default_rng(seed)
    shares, stds = np.full(6, carried), np.full(6, carried_std)
    return [
        Weight(link, mass, 0.2 * mass, rng.uniform(-0.4, 0.4, 3), shares, stds)
        for link, mass in [*enumerate(rng.uniform(3.0, 150.0, 6), start=1), (6, 25.0)]
    ]


def some_postures(robot, n, seed=1):
    return np.random.default_rng(seed).uniform(robot.lower, robot.upper, (n, 6))


def test_torques_are_the_generalized_gravity_of_pinocchio(robot):
    weights, kinematics = some_weights(), Kinematics(robot)
    model = pinocchio.buildModelFromUrdf(str(robot.urdf))
    model.gravity.linear = np.array([0.0, 0.0, -G])
    for joint in range(1, 7):
        model.inertias[joint] = pinocchio.Inertia.Zero()
    data = model.createData()
    pinocchio.forwardKinematics(model, data, np.zeros(6))
    frames = kinematics.link_frames(np.zeros(6))
    for weight in weights:
        place = data.oMi[weight.link].inverse() * pinocchio.SE3(frames[weight.link])
        point = pinocchio.Inertia(weight.mass, np.array(weight.centre), np.zeros((3, 3)))
        model.appendBodyToJoint(weight.link, point, place)
    data = model.createData()
    q = some_postures(robot, 50)
    held = np.array([pinocchio.computeGeneralizedGravity(model, data, row) for row in q])
    assert np.abs(held[:, 1]).max() > 500.0
    np.testing.assert_allclose(torques(kinematics, q, weights), -held, atol=1e-9)


def test_torques_are_the_loss_of_potential_energy(robot):
    weights, kinematics = some_weights(2), Kinematics(robot)
    q, step = some_postures(robot, 20, 3), 1e-6

    def energy(angles):
        frames = kinematics.link_frames(angles)
        return sum(
            w.mass * G * (frames[:, w.link, :3, :3] @ w.centre + frames[:, w.link, :3, 3])[:, 2]
            for w in weights
        )

    by_difference = np.stack(
        [
            (energy(q - step * np.eye(6)[k]) - energy(q + step * np.eye(6)[k])) / (2.0 * step)
            for k in range(6)
        ],
        axis=1,
    )
    np.testing.assert_allclose(torques(kinematics, q, weights), by_difference, atol=1e-5)


def test_the_sag_is_where_turned_joints_put_the_tool(robot):
    weights, kinematics = some_weights(carried=0.7), Kinematics(robot)
    springs = STIFF * robot.stiffness
    sag = GravitySag(kinematics, springs, weights, np.zeros((0, 6)))
    q = some_postures(robot, 30, 4)
    bent = q + 0.7 * torques(kinematics, q, weights) / springs
    before, after = (kinematics.forward(a) for a in (q, bent))
    moved = (after - before)[:, :3, :3] @ POINT + (after - before)[:, :3, 3]
    turned = Rotation.from_matrix(after[:, :3, :3] @ np.swapaxes(before[:, :3, :3], 1, 2)).as_rotvec()
    found = sag.twist(q, POINT)
    assert np.abs(moved).max() > 1e-4
    np.testing.assert_allclose(found[:, :3], moved, atol=2e-7)
    np.testing.assert_allclose(found[:, 3:], turned, atol=2e-7)


#: Flange at the three hinges of the standard door in the region of table 4.4, tool along x [m].
HINGES = [(1.365, -0.0025, height) for height in (0.05, 0.87, 1.69)]


def test_what_hangs_on_the_flange_moves_only_by_its_weight(robot):
    """No weight, no sag; twice the weight, twice the sag; a stiff robot, none."""
    q, kinematics = some_postures(robot, 5), Kinematics(robot)

    def twist(mass, stiffness=1.0):
        load = Weight(6, mass, 0.0, np.array([0.0, 0.0, 0.1]), np.ones(6), np.zeros(6))
        return GravitySag(kinematics, stiffness * robot.stiffness, [load], np.zeros((0, 6))).twist(q, POINT)

    assert np.abs(twist(0.0)).max() == 0.0
    np.testing.assert_allclose(twist(50.0), 2.0 * twist(25.0))
    np.testing.assert_allclose(twist(25.0, 1e3), 1e-3 * twist(25.0))


def taught_sag(robot, taught, seed=0):
    return GravitySag(Kinematics(robot), STIFF * robot.stiffness, some_weights(seed), taught)


def near(robot, n, seed=5):
    middle = np.radians([10.0, 30.0, -10.0, 20.0, 50.0, -30.0])
    return middle + np.random.default_rng(seed).uniform(-0.4, 0.4, (n, 6))


def test_one_taught_posture_takes_up_its_own_displacement_everywhere(robot):
    q = near(robot, 9)
    free, taught = taught_sag(robot, np.zeros((0, 6))), taught_sag(robot, q[:1])
    found = taught.twist(q, POINT)
    np.testing.assert_allclose(found[0, :3], 0.0, atol=1e-15)
    left = free.twist(q, POINT)
    np.testing.assert_allclose(found[:, :3], left[:, :3] - left[0, :3], atol=1e-15)
    np.testing.assert_allclose(found[:, 3:], left[:, 3:], atol=1e-15)


def test_teaching_takes_up_what_a_rigid_fit_of_the_touched_points_takes_up(robot):
    """The fit is Kabsch's, of where the tip was believed to be and where it was."""
    taught, q = near(robot, 6), near(robot, 20, 6)
    kinematics, free = Kinematics(robot), taught_sag(robot, np.zeros((0, 6)))

    def places(angles):
        T = kinematics.forward(angles)
        return T[:, :3, :3] @ POINT + T[:, :3, 3]

    believed = places(taught)
    touched = believed + free.twist(taught, POINT)[:, :3]
    R, _ = Rotation.align_vectors(touched - touched.mean(axis=0), believed - believed.mean(axis=0))
    real = places(q) + free.twist(q, POINT)[:, :3]
    in_taught = R.inv().apply(real - touched.mean(axis=0)) + believed.mean(axis=0)
    found = taught_sag(robot, taught).twist(q, POINT)
    assert np.abs(free.twist(q, POINT)[:, :3]).max() > 1e-4
    np.testing.assert_allclose(found[:, :3], in_taught - places(q), atol=2e-7)
    np.testing.assert_allclose(found[:, 3:], free.twist(q, POINT)[:, 3:] - R.as_rotvec(), atol=2e-7)


@pytest.mark.parametrize("points", [[[1.0, 0.2, 0.5]] * 3, [[1.0, 0.2, 0.5], [1.0005, 0.2, 0.5]]])
def test_points_in_one_place_tell_no_turn(points):
    moved = np.random.default_rng(7).normal(size=(len(points), 2, 3))
    shift, turn, centre = rigid_part(np.array(points), moved)
    assert np.abs(turn).max() == pytest.approx(0.0, abs=1e-9)
    np.testing.assert_allclose(shift, moved.mean(axis=0))
    np.testing.assert_allclose(centre, np.mean(points, axis=0))


def test_points_on_a_line_tell_the_two_turns_that_move_them():
    points = np.array([[1.0, 0.2, z] for z in (0.0, 0.7, 2.0)])
    turned = np.array([3e-4, -2e-4, 0.0])
    moved = 1e-3 + np.cross(turned, points - points.mean(axis=0))
    _, turn, _ = rigid_part(points, moved[:, None])
    np.testing.assert_allclose(turn[0], turned, atol=1e-12)


@pytest.mark.parametrize("taught", [0, 4])
def test_the_spread_is_that_of_drawn_masses_balances_and_springs(robot, taught):
    rng, kinematics = np.random.default_rng(8), Kinematics(robot)
    weights = some_weights(carried=0.8, carried_std=0.1)
    at, q, relative = near(robot, taught), near(robot, 3, 9), rng.uniform(0.05, 0.3, 6)
    spread = GravitySag(kinematics, robot.stiffness, weights, at).spread(q, POINT, relative)
    found = np.sqrt(np.sum(spread.joints**2, axis=(1, 2)) + spread.rest**2)
    plain = GravitySag(kinematics, robot.stiffness, weights, at).twist(q, POINT)
    small, drawn = 0.05, []  # first order: a twentieth of every deviation
    for _ in range(1000):
        balance = 0.8 + small * 0.1 * rng.normal(size=6)
        others = [replace(w, mass=w.mass + small * w.std * rng.normal(), carried=balance) for w in weights]
        springs = robot.stiffness * (1.0 + small * relative * rng.normal(size=6))
        drawn.append(GravitySag(kinematics, springs, others, at).twist(q, POINT) - plain)
    scatter = np.sqrt(np.mean(np.sum(np.array(drawn)[..., :3] ** 2, axis=2), axis=0)) / small
    np.testing.assert_allclose(found, scatter, rtol=0.1)


def test_torque_by_mass_asks_for_no_mass(robot):
    weights = some_weights()
    q = some_postures(robot, 4)
    each = torque_by_mass(Kinematics(robot), q, weights)
    total = sum(each[:, i] * w.mass for i, w in enumerate(weights))
    np.testing.assert_allclose(total, torques(Kinematics(robot), q, weights))


def test_a_spindle_of_25_kg_moves_the_hinges_as_an_outside_look_found(robot):
    """456, 593 and 787 um down, by another program that had the springs and the lengths alone."""
    load = Weight(6, 25.0, 0.0, np.array([0.0, 0.0, 0.1]), np.ones(6), np.zeros(6))
    sag = GravitySag(Kinematics(robot), robot.stiffness, [load], np.zeros((0, 6)))
    T = np.eye(4)
    T[:3, :3] = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])  # tool along x
    down = []
    for place in HINGES:
        T[:3, 3] = place
        q = inverse(robot, T)
        q = q[((q > robot.lower) & (q < robot.upper)).all(axis=1)]
        down.append(-sag.twist(q, POINT)[0, 2])
    # At what depth of the pockets it looked is not known.
    np.testing.assert_allclose(down, [456e-6, 593e-6, 787e-6], rtol=0.015)
    assert down[2] - down[0] == pytest.approx(331e-6, rel=0.015)
