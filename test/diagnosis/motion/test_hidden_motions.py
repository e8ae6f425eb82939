"""Effects hidden in simulated gear trains are named, and nothing else is."""

import numpy as np
import pytest

from doormill_ros.diagnosis.motion.account import law_sections, named_causes
from doormill_ros.diagnosis.motion.diagnosis import diagnose_motions
from doormill_ros.diagnosis.motion.laws import with_laws
from doormill_ros.measurements.sets.motion_set import read_motion_set
from support.motion_world import Recording, hide, record


def diagnosed(tmp_path, seed, *effects, **changes):
    """Verdict, named causes by name and place, and what was hidden with its values."""
    rng = np.random.default_rng([seed, 5])
    hidden, truth = Recording(**changes), {}
    for effect, joint, size in effects:
        hidden, key, value = hide(rng, hidden, effect, joint, size)
        truth[key] = value
    diagnosis = diagnose_motions([read_motion_set(record(tmp_path / "set", hidden, seed))])
    return diagnosis, {(one.cause, one.where): one for one in named_causes(diagnosis)}, truth


@pytest.mark.parametrize(
    ("seed", "effect", "joint", "parameter"),
    [
        (1, "late clock", 1, "skew"),
        (2, "time_skew", 2, "skew"),
        (3, "joint_stiffness", 3, "stiffness"),
        (4, "joint_friction", 3, "torque"),
        (5, "joint_damping", 1, "damping"),
        (6, "encoder_scale", 2, "factor"),
        (7, "joint_periodic_error", 1, None),
    ],
)
def test_one_effect_is_named_where_it_is_and_sized(tmp_path, seed, effect, joint, parameter):
    diagnosis, named, truth = diagnosed(tmp_path, seed, (effect, joint, 6.0))
    assert list(named) == list(truth)
    assert diagnosis.verdict == "explained"
    (key,) = truth
    if parameter is not None:
        entry = named[key].parameters[parameter]
        assert entry["value"] == pytest.approx(truth[key], abs=max(5.0 * entry["std"], 0.1 * abs(truth[key])))


@pytest.mark.parametrize("late", [2.9e-3, 40e-3])
def test_late_encoders_explain_a_recording_that_begins_in_motion(tmp_path, late):
    hidden = Recording()
    for joint in (1, 2, 3):
        hidden = hidden.with_gear(joint, late=late)
    table = record(tmp_path / "set", hidden, seed=1) / "samples.csv"
    lines = table.read_text().splitlines()
    table.write_text("\n".join([lines[0], *lines[500:]]) + "\n")
    data = read_motion_set(table.parent)
    assert all(abs(motion.motor[5] - motion.motor[0]) > 2e-3 for motion in data.motions)
    diagnosis = diagnose_motions([data])
    (entry,) = named_causes(diagnosis)
    assert (diagnosis.verdict, entry.cause, entry.where) == ("explained", "time_skew", "link encoders")
    assert entry.parameters["skew"]["value"] == pytest.approx(late, abs=1e-5)
    assert diagnosis.holdout_rmse[1] < 1.02 * diagnosis.noise_floor
    for finding, motion in zip(diagnosis.joints, data.motions, strict=True):
        left = diagnosis.model.of(motion.joint).residual(motion)
        assert np.std(left) < 1.05 * finding.problem.floor


@pytest.mark.parametrize(("joints", "where"), [((1, 2, 3), "link encoders"), ((2,), "joint 2")])
@pytest.mark.parametrize("early", [1e-3, 25e-3])
def test_encoders_that_are_read_early_by_more_than_damping_can_be_have_a_negative_skew(
    tmp_path, joints, where, early
):
    hidden = Recording()
    for joint in joints:
        hidden = hidden.with_gear(joint, late=-early)
    diagnosis = diagnose_motions([read_motion_set(record(tmp_path / "set", hidden, seed=4))])
    (entry,) = named_causes(diagnosis)
    assert (diagnosis.verdict, entry.cause, entry.where) == ("explained", "time_skew", where)
    assert entry.parameters["skew"]["value"] == pytest.approx(-early, abs=2e-5)
    confusable = [] if len(joints) > 1 else ["joint_damping"]
    assert [double.cause.name for double in entry.doubles] == confusable


def test_play_is_named_and_sized_though_the_link_flies_through_it(tmp_path):
    diagnosis, named, truth = diagnosed(tmp_path, 8, ("joint_backlash", 1, 6.0))
    assert list(named) == [("joint_backlash", "joint 1")]
    assert diagnosis.verdict in ("explained", "partly_explained")
    gap = named["joint_backlash", "joint 1"].parameters["gap"]["value"]
    assert gap == pytest.approx(truth["joint_backlash", "joint 1"], rel=0.3)


def test_nothing_hidden_is_consistent(tmp_path):
    diagnosis, named, _ = diagnosed(tmp_path, 11)
    assert (diagnosis.verdict, named) == ("consistent", {})


def test_an_effect_far_below_the_noise_gets_no_name(tmp_path):
    diagnosis, named, _ = diagnosed(tmp_path, 12, ("joint_friction", 2, 0.1))
    assert (diagnosis.verdict, named) == ("consistent", {})


def test_noise_that_is_not_stated_is_estimated(tmp_path):
    diagnosis, _, _ = diagnosed(tmp_path, 13, stated=False)
    assert diagnosis.noise_floor == pytest.approx(1.0e-5, rel=0.1)


def test_three_effects_with_samples_missing(tmp_path):
    _, named, truth = diagnosed(
        tmp_path,
        14,
        ("late clock", 1, 12.0),
        ("joint_stiffness", 2, 5.0),
        ("joint_periodic_error", 3, 5.0),
        dropped=0.03,
    )
    assert set(named) == set(truth)


def test_a_law_that_no_cause_has_gets_no_name(tmp_path):
    diagnosis, named, _ = diagnosed(tmp_path, 15, ("warming", 2, 6.0))
    assert named == {}
    assert diagnosis.verdict == "unexplained"


def test_a_hardening_spring_is_told_as_a_law_and_no_cause_imitates_it(tmp_path):
    diagnosis, named, _ = diagnosed(tmp_path, 16, ("hardening", 3, 8.0))
    assert named == {}
    told = law_sections(with_laws(diagnosis))
    (law,) = told["unnamed"]
    assert (law["where"], law["driver"]) == ("joint 3", "own torque")
    assert told["characterised"]["holdout_rmse"] < 1.1 * diagnosis.noise_floor
