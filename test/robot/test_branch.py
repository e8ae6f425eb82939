import numpy as np
import pytest

from doormill_ros.frames import transform
from doormill_ros.robot.branch import choose_branch
from doormill_ros.robot.branch_rules import BranchRules
from doormill_ros.robot.configuration import configuration_index
from doormill_ros.robot.errors import BranchError, JointLimitError, SingularityError, UnreachableError
from doormill_ros.robot.kinematics import Kinematics
from doormill_ros.robot.singularity import clearance
from support.inverse_kinematics import inverse_all

R_AT_HINGE = np.array([[0, 0, 1], [-1, 0, 0], [0, -1, 0.0]])


def poses(x, y, z):
    x, y, z = np.broadcast_arrays(x, y, z)
    return np.array([transform(R_AT_HINGE, np.array(p)) for p in zip(x, y, z, strict=True)])


EDGE = poses(1.4, 0.29, np.linspace(0.0, 2.7, 90))


def test_whole_door_edge_in_one_configuration(irb6600):
    q = choose_branch(irb6600, EDGE)
    np.testing.assert_allclose(Kinematics(irb6600).forward(q), EDGE, atol=1e-9)
    assert len(set(configuration_index(irb6600, q))) == 1
    assert np.abs(np.diff(q, axis=0)).max() < np.radians(20)
    margin = np.radians(1.0)
    assert np.all(q >= irb6600.lower + margin)
    assert np.all(q <= irb6600.upper - margin)


def test_the_arm_turns_over_between_segments_only_where_no_posture_serves_them_all(irb6600):
    rng, turned = np.random.default_rng(3), 0
    for _ in range(400):
        segments = np.arange(2)
        pair = poses(rng.uniform(0.8, 2.2, 2), rng.uniform(-1.5, 1.5, 2), rng.uniform(-0.2, 2.8, 2))
        try:
            kept = choose_branch(irb6600, pair, segment=segments)
        except UnreachableError:
            continue
        except (JointLimitError, SingularityError, BranchError):
            kept = None
        try:
            q = choose_branch(irb6600, pair, segment=segments, turn_over=True)
        except (JointLimitError, SingularityError, BranchError):
            assert kept is None
            continue
        np.testing.assert_allclose(Kinematics(irb6600).forward(q), pair, atol=1e-9)
        arms = configuration_index(irb6600, q) // 2
        if kept is not None:
            np.testing.assert_array_equal(q, kept)
            continue
        assert arms[0] != arms[1]
        assert np.all((q > irb6600.lower) & (q < irb6600.upper))
        turned += 1
    assert turned > 0


def test_short_path_at_the_bottom_hinge_takes_the_angles_of_table_4_6(irb6600):
    q = choose_branch(irb6600, EDGE[:3])
    np.testing.assert_allclose(np.degrees(q[0]), [13.58, 69.54, 34.97, 14.01, -104.10, -86.52], atol=0.01)


def flange_compliance(robot, q):
    J = Kinematics(robot).jacobian(q)[:, :3]
    return np.array([np.linalg.norm(j @ np.diag(1 / robot.stiffness) @ j.T, "fro") for j in J]) / np.sqrt(3)


@pytest.mark.parametrize("seed", range(30))
def test_no_legal_constant_branch_is_noticeably_stiffer(irb6600, seed):
    # Short paths at random reachable places; every alternative is built here by plain search.
    rng = np.random.default_rng(seed)
    rules = BranchRules()
    middle = np.array([rng.uniform(0.9, 1.9), rng.uniform(-0.8, 0.8), rng.uniform(0.2, 2.4)])
    path = poses(*(middle[:, None] + np.array([[0.0] * 5, np.linspace(0, 0.02, 5), np.linspace(0, 0.05, 5)])))
    found = inverse_all(irb6600, path)
    legal = []
    for start in found.q[found.pose == 0]:
        follow = [start]
        for pose in range(1, len(path)):
            options = found.q[found.pose == pose]
            follow.append(options[np.abs(options - follow[-1]).max(axis=1).argmin()])
        follow = np.array(follow)
        near = clearance(irb6600, follow)
        if (
            np.all(follow > irb6600.lower + rules.limit_margin)
            and np.all(follow < irb6600.upper - rules.limit_margin)
            and near.wrist.min() >= rules.wrist
            and near.elbow.min() >= rules.elbow
            and near.shoulder.min() >= rules.shoulder
        ):
            legal.append(flange_compliance(irb6600, follow).max())
    if not legal:
        with pytest.raises((SingularityError, JointLimitError, BranchError)):
            choose_branch(irb6600, path)
        return
    chosen = flange_compliance(irb6600, choose_branch(irb6600, path)).max()
    assert chosen <= min(legal) * rules.equal_compliance * (1 + 1e-9)


def test_a_wrist_singularity_on_the_path_is_named(irb6600):
    # Straight in front of the foot the forearm comes level at z = 2.02 m: axis 5 is straight there.
    with pytest.raises(SingularityError, match="axis 5 is 0") as caught:
        choose_branch(irb6600, poses(1.4, 0.0, np.linspace(0.0, 2.7, 90)))
    assert EDGE[caught.value.data["pose"], 2, 3] == pytest.approx(2.02, abs=0.05)


def test_out_of_reach_names_the_pose(irb6600):
    path = poses([1.4, 1.4, 3.2], 0.0, 0.5)
    with pytest.raises(UnreachableError, match=r"pose 3 of 3 .*\(3.200, 0.000, 0.500\) m"):
        choose_branch(irb6600, path)


def test_beyond_the_limits_names_the_joint(irb6600):
    # Under the robot's foot: joint 2 or 3 would have to go on.
    with pytest.raises(JointLimitError, match=r"joint [235]") as caught:
        choose_branch(irb6600, poses(0.9, 0.0, [-0.9, -0.95]))
    assert caught.value.data["joint"] in (2, 3, 5)


@pytest.mark.parametrize(("side", "bound"), [("lower", 35.5), ("upper", 34.5)])
@pytest.mark.parametrize("margin", [0.0, 0.2])
def test_either_limit_and_the_margin_count(irb6600, side, bound, margin):
    # At the bottom hinge joint 3 stands at 34.97 deg (table 4.6). The other elbow is out of range.
    rules = BranchRules(limit_margin=np.radians(margin))

    def with_bound(degrees):
        limits = getattr(irb6600, side).copy()
        limits[2] = np.radians(degrees)
        return type(irb6600)(**{**irb6600.__dict__, side: limits})

    with pytest.raises(JointLimitError, match="joint 3") as caught:
        choose_branch(with_bound(bound), EDGE[:1], rules=rules)
    over = abs(bound - 34.973) + margin
    assert f"joint 3 {over:.2f} deg" in caught.value.message
    inside = 34.973 + (margin + 0.01) * (1 if side == "upper" else -1)
    choose_branch(with_bound(inside), EDGE[:1], rules=rules)


def test_a_jump_on_the_path_is_refused_and_allowed_between_segments(irb6600):
    # Bottom and top hinge of one edge: the wrist turns over on the way, too far for one step.
    jump = poses(1.4, 0.29, [0.0, 0.02, 2.68, 2.7])
    rules = BranchRules(max_step=np.radians(60))
    with pytest.raises(BranchError, match="joint"):
        choose_branch(irb6600, jump, rules=rules)
    q = choose_branch(irb6600, jump, rules=rules, segment=np.array([0, 0, 1, 1]))
    np.testing.assert_allclose(Kinematics(irb6600).forward(q), jump, atol=1e-9)
    # One configuration serves both hinges, so it stays.
    assert len(set(configuration_index(irb6600, q))) == 1


def test_between_segments_the_wrist_may_flip_but_not_the_arm(irb6600):
    # Two hinges on either side of the height at which the wrist is straight, and limits on axis 4
    # that leave only one flip for each.
    narrow = type(irb6600)(**{**irb6600.__dict__, "lower": irb6600.lower * [1, 1, 1, 0.2, 1, 0.45]})
    narrow = type(irb6600)(**{**narrow.__dict__, "upper": irb6600.upper * [1, 1, 1, 0.2, 1, 0.45]})
    path = poses(1.4, 0.05, [0.0, 0.02, 2.68, 2.7])
    with pytest.raises((JointLimitError, BranchError)):
        choose_branch(narrow, path)
    q = choose_branch(narrow, path, segment=np.array([7, 7, 8, 8]))
    np.testing.assert_allclose(Kinematics(irb6600).forward(q), path, atol=1e-9)
    cfx = configuration_index(narrow, q)
    assert cfx[0] == cfx[1]
    assert cfx[2] == cfx[3]
    assert cfx[0] != cfx[2]
    assert len(set(cfx // 2)) == 1


def test_a_path_needs_poses(irb6600):
    with pytest.raises(ValueError, match=r"\(n, 4, 4\)"):
        choose_branch(irb6600, np.zeros((0, 4, 4)))
    with pytest.raises(ValueError, match="one label a pose"):
        choose_branch(irb6600, EDGE[:3], segment=np.array([1, 2]))
