"""Beside a law without a name no cause keeps a name that only stood for a part of it; one that acts keeps its own."""

import numpy as np
import pytest

from doormill_ros.diagnosis.motion import laws as motion_laws
from doormill_ros.diagnosis.motion.account import named_causes
from doormill_ros.diagnosis.motion.diagnosis import diagnose_motions
from doormill_ros.diagnosis.motion.needless import NEEDLESS as NO_BETTER
from doormill_ros.diagnosis.motion.needless import OTHER_LAW
from doormill_ros.diagnosis.pose import laws as pose_laws
from doormill_ros.diagnosis.pose.diagnosis import diagnose_poses
from doormill_ros.diagnosis.pose.laws import NEEDLESS, SHARED
from doormill_ros.measurements.sets.motion_set import read_motion_set
from doormill_ros.measurements.sets.pose_set import read_pose_set
from support.motion_laws.world import draw as draw_motion
from support.motion_world import Recording, hide, record
from support.pose_laws.laws import Law
from support.pose_laws.world import World
from support.pose_laws.world import draw as draw_poses
from support.pose_sets import gravity_torque


def refused(diagnosis):
    return {cause.key: why for cause, why in diagnosis.examination.refused}


@pytest.mark.parametrize(
    ("seed", "stood_for_it", "why", "stays"),
    [
        # Play where a spring gives way less under more: both follow the torque.
        (47, "joint_backlash", OTHER_LAW, {("joint_stiffness", "joint 3")}),
        # A spring where friction sits in one place of the turn.
        (54, "joint_stiffness", NO_BETTER, set()),
        # A spring where the angle of another joint pulls; what is said of a third joint stays.
        (140, "joint_stiffness", NO_BETTER, {("time_skew", "joint 2")}),
        # Waves of the reading where a spring varies as often.
        (122, "joint_periodic_error", NO_BETTER, set()),
    ],
)
def test_what_stood_for_a_law_of_a_moving_joint_loses_its_name(tmp_path, seed, stood_for_it, why, stays):
    world = draw_motion(seed)
    place = world.truth["where"]
    before = diagnose_motions([read_motion_set(world.write(tmp_path / "set"))])
    assert (stood_for_it, place) in {cause.key for cause in before.examination.named}
    after = motion_laws.with_laws(before)
    assert {(one.cause, one.where) for one in named_causes(after)} == stays
    assert refused(after)[stood_for_it, place] == why
    laws = [law for found in after.laws if found for law in found.laws]
    assert (place, world.truth["driver"]) in {(law.where, law.driver) for law in laws}
    # Said once, of the model that stands in the end.
    decisions = [margin.decision for margin in after.margins]
    assert len(decisions) == len(set(decisions))


@pytest.mark.parametrize(
    ("seed", "cause", "law", "driver"),
    [
        (31, "joint_friction", "crosstalk", "angle of joint 3"),
        (32, "joint_stiffness", "warming", "time"),
        (42, "joint_friction", "warming", "time"),
    ],
)
def test_a_cause_that_acts_keeps_its_name_beside_a_law_of_its_joint(tmp_path, seed, cause, law, driver):
    rng, hidden = np.random.default_rng([seed, 5]), Recording()
    for effect, size in ((cause, 9.0), (law, 4.0)):
        hidden, _, _ = hide(rng, hidden, effect, 2, size)
    diagnosis = diagnose_motions([read_motion_set(record(tmp_path / "set", hidden, seed))])
    after = motion_laws.with_laws(diagnosis)
    assert [named.key for named in after.examination.named] == [(cause, "joint 2")]
    assert after.verdict == "partly_explained"
    ((found,),) = [one.laws for one in after.laws if one]
    assert (found.where, found.driver) == ("joint 2", driver)


def test_a_drift_that_stood_for_sag_by_time_loses_its_name_and_the_link_keeps_its_own(tmp_path):
    world = draw_poses(39)
    before = diagnose_poses([read_pose_set(world.write(tmp_path / "set"))])
    assert "thermal_drift" in {cause.name for cause in before.examination.named}
    after = pose_laws.with_laws(before)
    assert [cause.key for cause in after.examination.named] == [("link_geometry", "link 2")]
    assert NEEDLESS in refused(after).values()
    assert after.laws.holdout_rmse < 1.1 * after.noise_floor


@pytest.mark.parametrize(
    ("seed", "times", "down"),
    [(125, 8.3, (0.0, 0.0, 1.0)), (3, 18.0, (0.45, -0.29, -np.sqrt(1.0 - 0.45**2 - 0.29**2)))],
    ids=["ceiling", "leaning"],
)
def test_what_gives_way_one_way_turns_no_gravity_and_lends_no_other_joint_a_name(tmp_path, seed, times, down):
    def one_way(session):
        return np.maximum([gravity_torque(q, 3, down) for q in session.q], 0.0)

    world = World(seed, Law("one-sided sag", 3, "torque sign", one_way), times, np.zeros(6))
    before = diagnose_poses([read_pose_set(world.write(tmp_path / "set"))])
    after = pose_laws.with_laws(before)
    assert {cause.key for cause in after.examination.named} <= {("joint_sag", "joint 3")}
    standing = before.question.standing
    # As near as noise leaves it: what follows from a torque that is off looks like errors of other joints.
    assert (
        np.arccos(np.clip(standing.stance.down @ down, -1.0, 1.0)) < 4.0 * standing.tilt[1] < np.radians(5.0)
    )
    assert [(law.where, law.driver) for law in after.laws.laws] == [("joint 3", "torque sign")]
    assert after.laws.holdout_rmse < 1.05 * after.noise_floor
    np.testing.assert_array_equal(pose_laws.model_with_laws(after).stance.down, standing.stance.down)


def test_a_periodic_error_is_not_named_where_laws_elsewhere_follow_the_same_angle(tmp_path):
    """Joint 2 turns one way and joint 3, parallel to it, the other: that is the length of a link, as is hidden."""
    world = draw_poses(173)
    assert world.truth["may_be_named"] == [("link_geometry", "link 2")]
    before = diagnose_poses([read_pose_set(world.write(tmp_path / "set", rows=120))])
    after = pose_laws.with_laws(before)
    told = [cause.key for cause in before.examination.named]
    assert ("joint_periodic_error", "joint 2") in told
    assert {cause.key for cause in after.examination.named} <= {("link_geometry", "link 2")}
    assert refused(after)["joint_periodic_error", "joint 2"] == SHARED
    assert ("joint 4", "angle of joint 2") in {(law.where, law.driver) for law in after.laws.laws}
