import numpy as np
import pytest

from doormill_ros.robot.errors import SingularityError
from doormill_ros.robot.kinematics import Kinematics
from doormill_ros.robot_model.elastic.batch import solve_springs
from doormill_ros.robot_model.elastic.joint_springs import JointSpringModel
from support.cartesian_stiffness import CartesianStiffness

POINT = np.array([0.05, -0.08, 0.25])
WRENCH = np.array([300.0, -400.0, -2500.0, 250.0, 250.0, -90.0])


@pytest.fixture
def stiff(irb6600):
    return CartesianStiffness(JointSpringModel(irb6600))


def test_complementary_stiffness_by_finite_differences(irb6600, stiff, configurations):
    # d(J^T W)/dq with W held in the base frame.
    kinematics = Kinematics(irb6600)
    drawn = configurations(60, 51)
    assert len(drawn) == 60
    for q in drawn:
        h = 1e-5
        numeric = np.stack(
            [
                (kinematics.jacobian(q + h * e, POINT).T - kinematics.jacobian(q - h * e, POINT).T)
                @ WRENCH
                / (2 * h)
                for e in np.eye(6)
            ],
            axis=-1,
        )
        np.testing.assert_allclose(stiff.complementary(q, WRENCH, POINT), numeric, atol=5e-6)


def test_complementary_stiffness_contracts_the_hessian(irb6600, stiff, configurations):
    q = configurations(500, 52)
    H = Kinematics(irb6600).hessian(q, POINT)
    expected = np.einsum("nijk,i->njk", H, WRENCH)
    np.testing.assert_allclose(stiff.complementary(q, WRENCH, POINT), expected, atol=1e-10)


def test_complementary_stiffness_improves_on_the_true_equilibrium(irb6600, stiff, configurations):
    # K dq = J(q + dq)^T W solved to the end. The linear joint deflections with K_c are one order
    # better than without. (The tool's displacement gains less: J dq leaves out the curvature of
    # the tool's way, which is of the same order as K_c.)
    model = JointSpringModel(irb6600)
    K = np.diag(irb6600.stiffness)
    drawn = configurations(60, 53)
    assert len(drawn) == 60
    for q in drawn:
        dq = np.zeros(6)
        for _ in range(80):
            dq = model.kinematics.jacobian(q + dq, POINT).T @ WRENCH / irb6600.stiffness
        torque = model.torque(q, WRENCH, POINT)
        with_K_c = np.linalg.solve(K - stiff.complementary(q, WRENCH, POINT), torque)
        without = torque / irb6600.stiffness
        assert np.linalg.norm(with_K_c - dq) < 0.1 * np.linalg.norm(without - dq)


def test_the_remaining_error_falls_with_the_square_of_the_load(irb6600, stiff, configurations):
    model = JointSpringModel(irb6600)
    q = configurations(1, 54)[0]
    force = np.array([600.0, -800.0, -2500.0, 0, 0, 0])

    def joint_error(share):
        dq = np.zeros(6)
        for _ in range(80):
            dq = model.kinematics.jacobian(q + dq, POINT).T @ (share * force) / irb6600.stiffness
        K = np.diag(irb6600.stiffness) - stiff.complementary(q, share * force, POINT)
        linear = np.linalg.solve(K, model.torque(q, share * force, POINT))
        return np.linalg.norm(linear - dq)

    # Second order in dq times the load itself: halving the load leaves an eighth.
    assert joint_error(1.0) / joint_error(0.5) == pytest.approx(8.0, rel=0.05)


def test_stiffness_times_deflection_is_the_wrench(stiff, configurations):
    drawn = configurations(100, 55)
    assert len(drawn) == 100
    for q in drawn:
        for wrench, deflection in (
            (WRENCH, stiff.deflection(q, WRENCH, POINT)),
            (None, stiff.compliance(q, POINT) @ WRENCH),
        ):
            K_x = stiff.stiffness_matrix(q, wrench, POINT)
            np.testing.assert_allclose(K_x @ deflection, WRENCH, rtol=1e-6, atol=1e-3)


def test_without_load_the_stiffness_is_symmetric_and_positive(stiff, configurations):
    K_x = stiff.stiffness_matrix(configurations(200, 56), None, POINT)
    np.testing.assert_allclose(K_x, np.swapaxes(K_x, -1, -2), rtol=1e-6, atol=1e-3)
    assert np.linalg.eigvalsh((K_x + np.swapaxes(K_x, -1, -2)) / 2).min() > 0


def test_compliance_agrees_with_the_joint_spring_model(irb6600, stiff, configurations):
    q = configurations(300, 57)
    wrench = np.tile(WRENCH, (300, 1))
    expected = JointSpringModel(irb6600).deflection(q, wrench, POINT)
    np.testing.assert_allclose(stiff.compliance(q, POINT) @ WRENCH, expected, atol=1e-12)


def test_a_wrench_a_configuration(stiff, configurations):
    q = configurations(4, 58)
    wrenches = np.random.default_rng(1).normal(0, 300, (4, 6))
    together = stiff.deflection(q, wrenches, POINT)
    one_by_one = [stiff.deflection(a, w, POINT) for a, w in zip(q, wrenches, strict=True)]
    np.testing.assert_allclose(together, one_by_one, atol=1e-15)


def test_in_a_singularity_there_is_no_stiffness_matrix_but_a_compliance(stiff):
    home = np.zeros(6)
    with pytest.raises(SingularityError, match="compliance"):
        stiff.stiffness_matrix(home)
    assert np.all(np.isfinite(stiff.compliance(home)))


@pytest.mark.parametrize("load", [1.0, 3e3, 1e5])
def test_springs_under_any_load(irb6600, stiff, configurations, load):
    # The largest load turns K_theta - K_c indefinite: elimination hands over to pivoting.
    q = configurations(200, 59)
    K_c = stiff.complementary(q, WRENCH * load / 2500, POINT)
    torque = np.random.default_rng(2).normal(0, 500, (6, 200))
    ours = solve_springs(irb6600.stiffness, K_c.transpose(1, 2, 0), torque)
    expected = np.linalg.solve(np.diag(irb6600.stiffness) - K_c, torque.T[..., None])[..., 0].T
    np.testing.assert_allclose(ours, expected, rtol=1e-9, atol=1e-15)


def test_springs_on_the_verge_of_buckling_are_solved_with_pivoting(irb6600):
    # K_c as large as the stiffness of joint 1: the first pivot all but vanishes, the matrix does not.
    K_c = np.zeros((6, 6, 1))
    K_c[0, 0] = irb6600.stiffness[0] * (1 - 1e-15)
    K_c[0, 1] = K_c[1, 0] = 1e5
    torque = np.array([[100.0], [200.0], [300.0], [50.0], [20.0], [10.0]])
    expected = np.linalg.solve(np.diag(irb6600.stiffness) - K_c[..., 0], torque[:, 0])
    np.testing.assert_allclose(solve_springs(irb6600.stiffness, K_c, torque)[:, 0], expected, rtol=1e-12)
