import itertools

import numpy as np
import pytest

from doormill_ros.frames import transform
from doormill_ros.robot.configuration import configuration_index
from doormill_ros.robot.errors import GeometryError
from doormill_ros.robot.inverse import inverse_branches
from doormill_ros.robot.kinematics import Kinematics
from doormill_ros.robot.ortho_parallel import ortho_parallel
from support.inverse_kinematics import inverse, inverse_all

# Flange z along base +x, flange x along base -y: the orientation that table 2.1 gives for the
# angles of table 4.6.
R_AT_HINGE = np.array([[0, 0, 1], [-1, 0, 0], [0, -1, 0.0]])

# Table 4.6 with the flange positions of tables 4.4 and 4.5.
TABLE_4_6 = [
    ((1.4, -0.29, 0.0), [-13.58, 69.54, 34.97, -14.01, -104.10, -93.48]),
    ((1.4, 0.29, 0.0), [13.58, 69.54, 34.97, 14.01, -104.10, -86.52]),
    ((1.4, -0.29, 2.7), [-13.58, 6.89, -44.31, 21.68, 39.46, -107.06]),
    ((1.4, 0.29, 2.7), [13.58, 6.89, -44.31, -21.68, 39.46, -72.94]),
]


def configurations(robot, n, seed):
    return np.random.default_rng(seed).uniform(robot.lower, robot.upper, (n, 6))


def nearest(solutions, q):
    return np.abs(solutions - q).max(axis=1).min()


@pytest.mark.parametrize(("position", "angles"), TABLE_4_6)
def test_table_4_6_to_the_printed_hundredth_of_a_degree(irb6600, position, angles):
    found = np.degrees(inverse(irb6600, transform(R_AT_HINGE, np.array(position))))
    row = found[np.abs(found - angles).max(axis=1).argmin()]
    assert np.abs(row - angles).max() < 0.01


def test_table_4_6_was_cut_off_not_rounded(irb6600):
    # The rows of the widest door are our angles cut off after two decimals, every one of them; the
    # others are their mirror image, so that joint 6 of the narrowest is -180 deg minus a cut angle.
    assert len(TABLE_4_6) == 4
    for (position, widest), (_, narrowest) in zip(TABLE_4_6[0::2], TABLE_4_6[1::2], strict=True):
        found = np.degrees(inverse(irb6600, transform(R_AT_HINGE, np.array(position))))
        row = found[np.abs(found - widest).max(axis=1).argmin()]
        np.testing.assert_allclose(np.trunc(row * 100) / 100, widest, atol=1e-9)
        mirrored = np.array(widest) * [-1, 1, 1, -1, 1, -1] - [0, 0, 0, 0, 0, 180]
        np.testing.assert_allclose(mirrored, narrowest, atol=1e-9)


@pytest.mark.parametrize("branch", range(8))
def test_ten_thousand_poses_of_every_branch_come_back(robot, branch):
    # Joint angles drawn within the limits until the branch has its ten thousand.
    rng = np.random.default_rng(100 + branch)
    drawn = []
    while sum(map(len, drawn)) < 10_000:
        q = rng.uniform(robot.lower, robot.upper, (60_000, 6))
        drawn.append(q[configuration_index(robot, q) == branch])
    q = np.concatenate(drawn)[:10_000]
    kinematics = Kinematics(robot)
    T = kinematics.forward(q)
    found = inverse_all(robot, T)
    np.testing.assert_allclose(kinematics.forward(found.q), T[found.pose], atol=1e-9)
    np.testing.assert_array_equal(configuration_index(robot, found.q), found.branch)
    # The angles that made the pose are among the solutions, under their own branch.
    own = found.branch == branch
    distance = np.full(len(q), np.inf)
    np.minimum.at(distance, found.pose[own], np.abs(found.q[own] - q[found.pose[own]]).max(axis=1))
    assert distance.max() < 1e-6


def test_solutions_reach_the_pose_by_plain_denavit_hartenberg(irb6600, table_2_1, frames_of):
    solved = []
    for q in configurations(irb6600, 200, 7):
        T = frames_of(table_2_1, q)[6]
        solutions = inverse(irb6600, T)
        solved.append(len(solutions) > 0)
        for solution in solutions:
            np.testing.assert_allclose(frames_of(table_2_1, solution)[6], T, atol=1e-9)
    assert solved == [True] * 200


def test_every_turn_within_the_limits_and_none_beyond(irb6600):
    T = Kinematics(irb6600).forward(configurations(irb6600, 300, 8))
    found = inverse_all(irb6600, T)
    branches = inverse_branches(irb6600, T)
    turns = 2 * np.pi * np.array(list(itertools.product((-1, 0, 1), repeat=6)))
    for pose in range(len(T)):
        candidates = (branches[pose][:, None] + turns).reshape(-1, 6)
        legal = candidates[((candidates >= irb6600.lower) & (candidates <= irb6600.upper)).all(axis=1)]
        ours = found.q[found.pose == pose]
        assert len(ours) == len(legal)
        assert all(nearest(ours, row) < 1e-12 for row in legal)
    assert np.all(np.diff(found.pose) >= 0)
    assert np.all(np.diff(found.pose * 8 + found.branch) >= 0)


def test_a_pose_at_the_ends_of_axis_1_has_both(irb6600):
    # Axis 1 reaches -180 and +180 deg, which is one place.
    q = np.array([np.pi, 0.2, 0.1, 0.3, 0.7, -0.4])
    found = inverse(irb6600, Kinematics(irb6600).forward(q))
    assert nearest(found, q) < 1e-9
    assert nearest(found, q - [2 * np.pi, 0, 0, 0, 0, 0]) < 1e-9


@pytest.mark.parametrize("bend", [0.0, 1e-12, -1e-9, 1e-7, -1e-5, 1e-3])
def test_a_nearly_straight_wrist_keeps_its_precision(irb6600, bend):
    q = configurations(irb6600, 500, 9)
    q[:, 4] = bend
    kinematics = Kinematics(irb6600)
    T = kinematics.forward(q)
    found = inverse_all(irb6600, T)
    assert len(np.unique(found.pose)) == len(q)
    np.testing.assert_allclose(kinematics.forward(found.q), T[found.pose], atol=1e-10)


def test_out_of_reach_is_empty(irb6600):
    assert inverse(irb6600, transform(R_AT_HINGE, np.array([3.5, 0.0, 1.0]))).shape == (0, 6)


@pytest.mark.parametrize("seed", range(20))
def test_closed_form_arguments_follow_from_any_table_of_the_kind(irb6600, frames_of, seed):
    # Our derivation of lengths and offsets, on arms with other lengths, a sideways offset and
    # arbitrary zero positions of the joints.
    import py_opw_kinematics as opw

    rng = np.random.default_rng(seed)
    table = irb6600.dh.copy()
    table[:, 0] += rng.uniform(-3, 3, 6)
    table[[0, 1, 2, 0, 3, 5, 2], [2, 2, 2, 1, 1, 1, 1]] = rng.uniform(-1, 1, 7)
    arm = ortho_parallel(table)
    solver = opw.Robot(opw.KinematicModel(**arm.__dict__), degrees=False)
    q = rng.uniform(-np.pi, np.pi, 6)
    np.testing.assert_allclose(solver.forward(tuple(q)).as_matrix(), frames_of(table, q)[6], atol=1e-12)


def test_closed_form_arguments_of_the_irb6600(irb6600):
    arm = ortho_parallel(irb6600.dh)
    assert (arm.a1, arm.a2, arm.b, arm.c1, arm.c2, arm.c3, arm.c4) == (
        0.32,
        -0.2,
        0.0,
        0.78,
        1.075,
        1.142,
        0.2,
    )
    np.testing.assert_allclose(arm.offsets, [0, 0, -np.pi / 2, 0, 0, 0], atol=1e-15)


@pytest.mark.parametrize(("row", "column", "value"), [(4, 1, 0.1), (3, 2, 0.05), (1, 3, 0.2), (1, 1, 0.1)])
def test_an_arm_without_spherical_wrist_is_refused(irb6600, row, column, value):
    table = irb6600.dh.copy()
    table[row, column] = value
    with pytest.raises(GeometryError, match="no closed-form inverse"):
        ortho_parallel(table)
