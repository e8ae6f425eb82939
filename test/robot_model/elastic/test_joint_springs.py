import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from doormill_ros.robot_model.elastic.joint_springs import JointSpringModel

POINT = np.array([0.05, -0.08, 0.25])
REFLECTOR = np.array([0.3, 0.1, -0.2])


def place(link_pose, q, link, point):
    T = link_pose(q, link)
    return T[:3, :3] @ point + T[:3, 3]


def potential(link_pose, q, wrench, link, point):
    """Work done by a small constant force; its gradient over q is the joint torque."""
    return wrench[:3] @ place(link_pose, q, link, point)


def test_torque_is_the_gradient_of_work(irb6600, link_pose, configurations):
    model = JointSpringModel(irb6600)
    wrench = np.array([120.0, -340.0, 220.0, 0, 0, 0])
    for link in (2, 4, 6):
        drawn = configurations(10, link)
        assert len(drawn) == 10
        for q in drawn:
            h = 1e-6
            numeric = [
                (
                    potential(link_pose, q + h * e, wrench, link, POINT)
                    - potential(link_pose, q - h * e, wrench, link, POINT)
                )
                / (2 * h)
                for e in np.eye(6)
            ]
            np.testing.assert_allclose(model.torque(q, wrench, POINT, link), numeric, atol=1e-6)


def test_deflection_is_where_the_bent_joints_put_the_tool(irb6600, link_pose, configurations):
    # Torque by plain gradient, joints bent by torque over stiffness, tool placed by plain kinematics.
    model = JointSpringModel(irb6600)
    wrench = np.array([2.0, -3.5, 1.2, 0, 0, 0])
    drawn = configurations(40, 21)
    assert len(drawn) == 40
    for q in drawn:
        h = 1e-6
        torque = [
            (
                potential(link_pose, q + h * e, wrench, 6, POINT)
                - potential(link_pose, q - h * e, wrench, 6, POINT)
            )
            / (2 * h)
            for e in np.eye(6)
        ]
        bent = q + np.array(torque) / irb6600.stiffness
        moved = place(link_pose, bent, 6, POINT) - place(link_pose, q, 6, POINT)
        ours = model.deflection(q[None], wrench[None], POINT)[0, :3]
        # Displacements of about 10 um over micro-radians: their curvature is below 0.1 nm.
        np.testing.assert_allclose(ours, moved, atol=2e-10)


@pytest.mark.parametrize("reflector_link", range(7))
@pytest.mark.parametrize("load_link", [2, 6])
def test_reflector_on_any_link(irb6600, link_pose, configurations, reflector_link, load_link):
    model = JointSpringModel(irb6600)
    wrench = np.array([15.0, 8.0, -22.0, 3.0, -4.0, 2.0])
    q = configurations(1, 31 + reflector_link)[0]
    bent = q + model.joint_deflection(q, wrench, POINT, load_link)
    moved = place(link_pose, bent, reflector_link, REFLECTOR) - place(link_pose, q, reflector_link, REFLECTOR)
    ours = model.displacement(q, wrench, POINT, reflector_link, REFLECTOR, load_link)
    np.testing.assert_allclose(ours, moved, atol=2e-9)
    # Only the base stands still: every joint before both load and reflector gives way.
    assert (np.linalg.norm(ours) > 1e-8) == (reflector_link > 0)


def test_load_and_reflector_change_places(irb6600, configurations):
    # Maxwell and Betti: a force at A along u moves B along v as far as a force at B along v moves A
    # along u.
    model = JointSpringModel(irb6600)
    u, v = np.array([0.36, 0.48, 0.8]), np.array([-0.6, 0.64, 0.48])
    at_a, at_b = np.append(u, [0, 0, 0]), np.append(v, [0, 0, 0])
    drawn = configurations(50, 41)
    assert len(drawn) == 50
    for q in drawn:
        there = model.displacement(q, 100 * at_a, POINT, 3, REFLECTOR, load_link=6) @ v
        back = model.displacement(q, 100 * at_b, REFLECTOR, 6, POINT, load_link=3) @ u
        assert there == pytest.approx(back, rel=1e-9, abs=1e-15)


wrenches = st.lists(st.floats(-500, 500), min_size=6, max_size=6).map(np.array)


@settings(max_examples=60, deadline=None)
@given(a=wrenches, b=wrenches, factor=st.floats(-3, 3), seed=st.integers(0, 99))
def test_deflection_is_linear_and_takes_work(irb6600, a, b, factor, seed):
    model = JointSpringModel(irb6600)
    q = np.random.default_rng(seed).uniform(irb6600.lower, irb6600.upper, (1, 6))
    by_a, by_b = (model.deflection(q, w[None], POINT)[0] for w in (a, b))
    both = model.deflection(q, (a + factor * b)[None], POINT)[0]
    np.testing.assert_allclose(both, by_a + factor * by_b, atol=1e-12)
    assert a @ by_a >= 0.0


def test_one_soft_joint_is_a_lever(irb6600):
    # Home position, joint 1 alone: a sideways force F at radius r turns it by F r / K and moves a
    # point at radius s by that angle times s (thesis eq. 2.41, 2.44).
    stiffness = [2.0e6, *[np.inf] * 5]
    model = JointSpringModel(irb6600, stiffness)
    wrench = np.array([0, 150.0, 0, 0, 0, 0])
    moved = model.displacement(np.zeros(6), wrench, np.zeros(3), 1, np.array([0.48 - 0.32, 0.0, -0.12]))
    # Frame 1 sits at x = 0.320; its x axis is radial in the home position.
    angle = 150.0 * 1.662 / 2.0e6
    np.testing.assert_allclose(moved, [angle * 0.12, angle * 0.48, 0.0], atol=1e-15)


def test_stiffness_of_ones_own_takes_the_place_of_the_robot(irb6600, configurations):
    q, wrench = configurations(5, 61), np.tile([100.0, -50.0, 30.0, 4.0, 5.0, -6.0], (5, 1))
    factors = JointSpringModel(irb6600, 4.0 * irb6600.stiffness).deflection(q, wrench, POINT)
    np.testing.assert_allclose(4.0 * factors, JointSpringModel(irb6600).deflection(q, wrench, POINT))


@pytest.mark.parametrize("stiffness", [[1e6] * 5, [1e6] * 5 + [0.0], [1e6] * 5 + [-1.0], [np.nan] * 6])
def test_impossible_stiffness_is_refused(irb6600, stiffness):
    with pytest.raises(ValueError, match="6 positive numbers"):
        JointSpringModel(irb6600, stiffness)
