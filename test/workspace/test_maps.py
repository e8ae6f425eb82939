import tracemalloc

import numpy as np
import pytest

from doormill_ros.robot.chain import chain_frames, jacobian_columns
from doormill_ros.robot.kinematics import Kinematics
from doormill_ros.workspace.conditioning import characteristic_length, inverse_condition_number
from doormill_ros.workspace.grid import thesis_grid
from doormill_ros.workspace.maps import WRENCH_SCRIPT, WRENCH_TEXT, compute_maps, save_maps
from support.pinocchio_model import PinocchioKinematics

POINT = np.array([0.02, 0.05, 0.25])


def one_configuration(robot, kinematics, q, wrench, length):
    """The thesis' formulas with plain matrices and pinocchio, one configuration."""
    J, H = kinematics.jacobian(q, POINT), kinematics.hessian(q, POINT)
    K = np.diag(robot.stiffness)
    K_c = np.einsum("ijk,i->jk", H, wrench)
    with_K_c = J @ np.linalg.solve(K - K_c, J.T @ wrench)
    without = J @ np.linalg.solve(K, J.T @ wrench)
    a, b = np.linalg.norm(with_K_c[:3]), np.linalg.norm(without[:3])
    J_n = np.diag([1 / length] * 3 + [1] * 3) @ J
    C = J[:3] @ np.linalg.solve(K, J[:3].T)
    return (
        abs(a - b) / max(a, b),
        np.abs(with_K_c - without)[3:].max(),
        1 / (np.linalg.norm(J_n, "fro") * np.linalg.norm(np.linalg.inv(J_n), "fro")),
        1 / C[2, 2],
        1 / C[1, 1],
        1 / C[0, 0],
    )


@pytest.mark.parametrize("tool_along_x", [False, True])
def test_maps_agree_with_plain_formulas(irb6600, tool_along_x):
    grid = thesis_grid(irb6600, step=0.11, tool_along_x=tool_along_x)
    wrench = np.array(WRENCH_TEXT)
    maps = compute_maps(irb6600, grid, wrench, POINT)
    kinematics = PinocchioKinematics(irb6600)
    layers = (maps.position_influence, maps.rotation_influence, maps.conditioning, *maps.stiffness.values())
    compared = 0
    for row in range(0, grid.shape[0], 5):
        for column in range(0, grid.shape[1], 3):
            q2, q3 = grid.q2[column], grid.q3[row]
            q = np.array([0, q2, q3, *[np.pi / 4] * 3])
            if tool_along_x:
                q = np.array([0, q2, q3, 0, np.angle(np.exp(-1j * (q2 + q3))), -np.pi / 2])
                if abs(q[4]) > np.radians(120):  # axis 5 of the IRB 6600 turns no farther
                    assert all(np.isnan(layer[row, column]) for layer in layers)
                    continue
            expected = one_configuration(irb6600, kinematics, q, wrench, maps.length)
            found = [layer[row, column] for layer in layers]
            # nu_p is a small difference of two lengths: 1e-9 of it is 1e-13 of the lengths.
            np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-12)
            compared += 1
    # Axis 5 gets to most of them.
    assert compared > (grid.shape[0] // 5) * (grid.shape[1] // 3) / 2


def test_tool_along_x_points_the_tool_along_x(irb6600):
    grid = thesis_grid(irb6600, step=0.3, tool_along_x=True)
    T = Kinematics(irb6600).forward(grid.joints(0, grid.shape[0]).T)
    np.testing.assert_allclose(T[:, :3, :3] - [[0, 0, 1], [-1, 0, 0], [0, -1, 0]], 0, atol=1e-12)


def test_sine_and_cosine_of_the_grid_are_those_of_its_joints(irb6600):
    for along_x in (False, True):
        grid = thesis_grid(irb6600, step=0.2, tool_along_x=along_x)
        sine, cosine = grid.sin_cos(2, 5)
        np.testing.assert_allclose(sine, np.sin(grid.joints(2, 5)), atol=1e-15)
        np.testing.assert_allclose(cosine, np.cos(grid.joints(2, 5)), atol=1e-15)


def test_memory_of_the_full_grid_stays_far_below_two_gibibytes(irb6600):
    grid = thesis_grid(irb6600)
    tracemalloc.start()
    compute_maps(irb6600, grid)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 0.1 * 2**31


def test_thesis_grid_covers_the_study_range(irb6600):
    # Sections 3.4 and 3.5: joint 2 from -65 to 85 deg, joint 3 from -180 to 70 deg, 0.007 rad.
    grid = thesis_grid(irb6600)
    assert grid.shape == (624, 374)
    np.testing.assert_allclose(np.degrees([grid.q2[0], grid.q3[0]]), [-65, -180])
    assert 0 <= 85 - np.degrees(grid.q2[-1]) < np.degrees(0.007)
    assert 0 <= 70 - np.degrees(grid.q3[-1]) < np.degrees(0.007)
    np.testing.assert_allclose(np.diff(grid.q2), 0.007)
    with pytest.raises(ValueError, match="grid step"):
        thesis_grid(irb6600, step=0.0)


def random_jacobians(robot, n, seed):
    q = np.random.default_rng(seed).uniform(robot.lower, robot.upper, (n, 6))
    frames = chain_frames(robot.dh, np.ascontiguousarray(q.T))
    velocity = jacobian_columns(frames, frames.point(6, POINT))
    return frames, velocity, Kinematics(robot).jacobian(q, POINT).copy()


def test_inverse_condition_number_of_random_postures(irb6600):
    frames, velocity, J = random_jacobians(irb6600, 3000, 1)
    J[:, :3] /= 0.9
    expected = [1 / np.linalg.cond(matrix, "fro") for matrix in J]
    np.testing.assert_allclose(inverse_condition_number(frames, velocity, 0.9), expected, rtol=1e-8)


def test_inverse_condition_number_ends_at_zero_in_singularities(irb6600):
    q = np.array([[0.3, 0.2, 0.1, 0.5, 0.0, 0.7], [0.3, 0.2, 0.1, 0.5, 1e-9, 0.7]])
    frames = chain_frames(irb6600.dh, np.ascontiguousarray(q.T))
    found = inverse_condition_number(frames, jacobian_columns(frames, frames.point(6, np.zeros(3))), 1.0)
    assert found[0] < 1e-12
    assert 1e-12 < found[1] < 1e-8


def test_characteristic_length_of_the_irb6600(irb6600):
    # Eq. 3.37 and 3.38 with the lengths of table 2.1 and the 2.55 m of the type name.
    assert characteristic_length(irb6600) == pytest.approx(
        2.55 / (0.320 + 1.075 + np.hypot(1.142, 0.2) + 0.2)
    )


def test_conditioning_does_not_depend_on_joint_1(irb6600):
    q = np.array([[0.0, 0.4, -0.6, 0.8, 0.8, 0.8], [1.9, 0.4, -0.6, 0.8, 0.8, 0.8]])
    frames = chain_frames(irb6600.dh, np.ascontiguousarray(q.T))
    found = inverse_condition_number(frames, jacobian_columns(frames, frames.point(6, np.zeros(3))), 0.9)
    assert found[0] == pytest.approx(found[1], rel=1e-10)


def test_influence_of_the_two_printed_wrenches(irb6600):
    # Section 3.4 prints -2500 N and 250 N m, the script of A.14 -2000 N and 200 N m: the script's load
    # is 0.8 times the text's, so nu_p falls by 0.8 and nu_r by 0.8 squared, up to higher orders.
    grid = thesis_grid(irb6600, step=0.07)
    text, script = (compute_maps(irb6600, grid, wrench) for wrench in (WRENCH_TEXT, WRENCH_SCRIPT))
    ratio_p = script.position_influence.max() / text.position_influence.max()
    ratio_r = script.rotation_influence.max() / text.rotation_influence.max()
    assert ratio_p == pytest.approx(0.8, rel=0.01)
    assert ratio_r == pytest.approx(0.64, rel=0.01)


def test_progress_ends_at_one(irb6600):
    shares = []
    compute_maps(irb6600, thesis_grid(irb6600, step=0.1), progress=shares.append)
    assert shares == sorted(shares)
    assert shares[-1] == 1.0


def test_saved_arrays_have_axes_in_degrees(irb6600, tmp_path):
    maps = compute_maps(irb6600, thesis_grid(irb6600, step=0.2))
    save_maps(maps, tmp_path / "maps.npz")
    with np.load(tmp_path / "maps.npz") as data:
        assert data["joint2_deg"][0] == pytest.approx(-65)
        assert data["joint3_deg"][0] == pytest.approx(-180)
        assert data["nu_p"].shape == (len(data["joint3_deg"]), len(data["joint2_deg"]))
        np.testing.assert_allclose(np.radians(data["nu_r_deg"]), maps.rotation_influence)
        np.testing.assert_array_equal(data["stiffness_along_edge_N_per_m"], maps.stiffness["along_edge"])
