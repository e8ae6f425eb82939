import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from doormill_ros.robot.kinematics import Kinematics
from support.pinocchio_model import PinocchioKinematics

POINT = np.array([0.11, -0.07, 0.25])


def configurations(robot, n, seed):
    return np.random.default_rng(seed).uniform(robot.lower, robot.upper, (n, 6))


def central(function, q, step):
    """Derivative along each joint by central differences, last axis."""
    return np.stack(
        [(function(q + step * e) - function(q - step * e)) / (2 * step) for e in np.eye(6)], axis=-1
    )


def test_home_flange_is_where_the_thesis_prints_it(irb6600):
    # Output of appendix A.2.
    expected = [[0, 0, 1, 1.662], [0, 1, 0, 0], [-1, 0, 0, 2.055], [0, 0, 0, 1]]
    np.testing.assert_allclose(Kinematics(irb6600).forward(np.zeros(6)), expected, atol=1e-12)


def test_a5_with_the_length_of_the_text_would_miss_the_home_flange(table_2_1, frames_of):
    # Section 2.1.1 writes Tz(0.200) into A5 where table 2.1 and A.2 have none: off by 0.2 m.
    text = table_2_1.copy()
    text[4, 1] = 0.200
    home = frames_of(text, np.zeros(6))[6][:3, 3]
    assert np.linalg.norm(home - [1.662, 0, 2.055]) == pytest.approx(0.2)


def test_agrees_with_plain_denavit_hartenberg(irb6600, table_2_1, frames_of):
    q = configurations(irb6600, 2000, 1)
    ours = Kinematics(irb6600).link_frames(q)
    plain = np.array([frames_of(table_2_1, row) for row in q])
    np.testing.assert_allclose(ours, plain, atol=1e-12)


def test_agrees_with_pinocchio(robot):
    ours, pinocchio = Kinematics(robot), PinocchioKinematics(robot)
    drawn = configurations(robot, 300, 2)
    assert len(drawn) == 300
    for q in drawn:
        np.testing.assert_allclose(ours.forward(q), pinocchio.forward(q), atol=1e-12)
        np.testing.assert_allclose(ours.jacobian(q, POINT), pinocchio.jacobian(q, POINT), atol=1e-12)
        np.testing.assert_allclose(ours.hessian(q, POINT), pinocchio.hessian(q, POINT), atol=1e-12)


def test_jacobian_agrees_with_finite_differences_of_plain_kinematics(irb6600, table_2_1, frames_of):
    kinematics = Kinematics(irb6600)
    drawn = configurations(irb6600, 50, 3)
    assert len(drawn) == 50
    for q in drawn:
        T = frames_of(table_2_1, q)[6]

        def moved(angles, T=T):
            # Position of the point and rotation vector against the pose at q, base axes.
            new = frames_of(table_2_1, angles)[6]
            turn = Rotation.from_matrix(new[:3, :3] @ T[:3, :3].T).as_rotvec()
            return np.concatenate([new[:3, :3] @ POINT + new[:3, 3], turn])

        np.testing.assert_allclose(kinematics.jacobian(q, POINT), central(moved, q, 1e-6), atol=2e-9)


def test_hessian_agrees_with_finite_differences(robot):
    kinematics = Kinematics(robot)
    drawn = configurations(robot, 50, 4)
    assert len(drawn) == 50
    for q in drawn:
        numeric = central(lambda angles: kinematics.jacobian(angles, POINT), q, 1e-5)
        np.testing.assert_allclose(kinematics.hessian(q, POINT), numeric, atol=1e-9)


@pytest.mark.parametrize("link", range(7))
def test_jacobian_of_a_point_on_any_link(irb6600, table_2_1, frames_of, link):
    kinematics = Kinematics(irb6600)
    q = configurations(irb6600, 1, 5 + link)[0]

    def position(angles):
        T = frames_of(table_2_1, angles)[link]
        return T[:3, :3] @ POINT + T[:3, 3]

    J = kinematics.link_jacobian(q, link, POINT)
    np.testing.assert_allclose(J[:3], central(position, q, 1e-6), atol=1e-9)
    np.testing.assert_array_equal(J[:, link:], 0.0)


def test_shapes_in_front_are_kept(irb6600):
    kinematics = Kinematics(irb6600)
    q = configurations(irb6600, 6, 6).reshape(2, 3, 6)
    for function, tail in (
        (kinematics.forward, (4, 4)),
        (kinematics.link_frames, (7, 4, 4)),
        (kinematics.jacobian, (6, 6)),
        (kinematics.hessian, (6, 6, 6)),
    ):
        batch = function(q)
        assert batch.shape == (2, 3, *tail)
        np.testing.assert_array_equal(batch[1, 2], function(q[1, 2]))


def test_wrong_shapes_are_refused(irb6600):
    with pytest.raises(ValueError, match=r"\(5,\)"):
        Kinematics(irb6600).forward(np.zeros(5))
    with pytest.raises(ValueError, match=r"\(5, 4\)"):
        Kinematics(np.zeros((5, 4)))
    with pytest.raises(ValueError, match="link 7"):
        Kinematics(irb6600).link_jacobian(np.zeros(6), 7)


def test_what_is_kept_of_postures_is_never_told_of_others(irb6600, table_2_1):
    """The same array with other angles in it, another point or link, another arm: each time as if asked first."""
    longer = table_2_1.copy()
    longer[1, 2] += 0.1
    ours, other = Kinematics(irb6600), Kinematics(longer)
    q = configurations(irb6600, 6, 5)
    alone = [(ours.forward(row[None])[0], ours.jacobian(row[None], POINT)[0]) for row in q]
    assert np.abs(other.forward(q) - ours.forward(q)).max() > 0.05
    assert np.abs(other.jacobian(q, POINT) - ours.jacobian(q, POINT)).max() > 0.05
    assert np.abs(ours.jacobian(q, 2.0 * POINT) - ours.jacobian(q, POINT)).max() > 0.05
    assert not ours.link_jacobian(q, 3, POINT)[..., 3:].any()
    for _ in range(len(q)):
        q[:] = np.roll(q, 1, axis=0)
        alone = [alone[-1], *alone[:-1]]
        for found, told in zip(
            zip(ours.forward(q), ours.jacobian(q, POINT), strict=True), alone, strict=True
        ):
            np.testing.assert_array_equal(found[0], told[0])
            np.testing.assert_array_equal(found[1], told[1])


def test_a_jacobian_that_others_may_be_given_is_locked(irb6600):
    J = Kinematics(irb6600).jacobian(configurations(irb6600, 3, 6), POINT)
    with pytest.raises(ValueError, match="read-only"):
        J[0] = 0.0
