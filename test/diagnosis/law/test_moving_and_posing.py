"""Hidden laws in moving joints and in poses, of arms that share no code with the dictionaries, to files and models."""

import json
from collections import Counter

import numpy as np
import pytest
import yaml

from doormill_ros.diagnosis.motion import laws as motion_laws
from doormill_ros.diagnosis.motion.diagnosis import diagnose_motions
from doormill_ros.diagnosis.pose import laws as pose_laws
from doormill_ros.diagnosis.pose.diagnosis import diagnose_poses
from doormill_ros.measurements.sets.motion_set import read_motion_set
from doormill_ros.measurements.sets.pose_set import read_pose_set
from doormill_ros.robot_model.motion.model import load_motion_model
from doormill_ros.robot_model.pose.model import load_pose_model
from doormill_ros.tools.diagnose import main
from support.motion_laws.world import draw as draw_motion
from support.motion_world import Recording, record
from support.pose_laws.world import draw as draw_poses


def told(tmp_path):
    """diagnosis.json, report and model.yaml of the series in `set`, with the one in `unseen` predicted."""
    out = tmp_path / "out"
    arguments = ["--data", str(tmp_path / "set"), "--check", str(tmp_path / "unseen"), "--out", str(out)]
    assert main(arguments) == 0
    document = json.loads((out / "diagnosis.json").read_text(encoding="utf-8"))
    model = yaml.safe_load((out / "model.yaml").read_text(encoding="utf-8"))
    return document, (out / "report.html").read_text(encoding="utf-8"), model, out


def test_a_law_of_a_moving_joint_is_placed_told_and_predicts_another_recording(tmp_path):
    world = draw_motion(1)
    world.write(tmp_path / "set")
    world.write(tmp_path / "unseen", 1)
    document, page, model, out = told(tmp_path)
    truth = world.truth
    assert document["verdict"] == "unexplained"
    assert document["causes"] == []
    (law,) = document["unnamed"]
    assert (law["where"], law["driver"]) == (truth["where"], truth["driver"])
    assert "%" in law["law"]
    assert "A law without a name" in page
    assert law["test"] in page
    # `extended` has the named causes only: none.
    assert document["extended"]["holdout_rmse"] == document["baseline"]["holdout_rmse"]
    noise = document["noise_floor"]
    (check,) = document["checks"]
    assert check["extended"]["rmse"] > 2.5 * noise
    assert check["characterised"]["rmse"] < 1.1 * noise
    low, high = document["characterised"]["ci95"]
    assert low < document["characterised"]["holdout_rmse"] < high < law["holdout_rmse_without"]
    assert [entry["where"] for one in model["joints"] for entry in one.get("laws", ())] == [truth["where"]]
    # The file says of the other recording what the diagnosis said.
    loaded, other = load_motion_model(out), read_motion_set(tmp_path / "unseen")
    left = [loaded.of(one.joint).residual(one, company=other.motions) for one in other.motions]
    assert np.sqrt(np.mean(np.square(left))) == pytest.approx(check["characterised"]["rmse"], rel=1e-6)
    # Without the joint that drives it, its mean stands: no better than chance, yet finite.
    alone = loaded.of(world.law.joint + 1).residual(other.motions[world.law.joint])
    assert np.all(np.isfinite(alone))
    assert np.sqrt(np.mean(alone**2)) > 2.0 * noise


def laws_of(model):
    """Terms of laws in a model.yaml of moving joints."""
    return [entry for one in model["joints"] for entry in one.get("laws", ())]


def test_a_straight_law_predicts_torques_larger_than_those_it_comes_from(tmp_path):
    world = draw_motion(153)
    world.write(tmp_path / "set")
    world.write(tmp_path / "unseen", 1)
    document, _, model, _ = told(tmp_path)
    (entry,) = laws_of(model)
    assert (entry["shape"], entry["seen"]["ends"]) == ("slope", False)
    other = int(world.truth["driver"].split()[-1])
    (torque,) = (one.torque for one in read_motion_set(tmp_path / "unseen").motions if one.joint == other)
    assert max(entry["seen"]["low"] - torque.min(), torque.max() - entry["seen"]["high"]) > 500.0  # N m
    assert document["checks"][0]["characterised"]["rmse"] < 1.1 * document["noise_floor"]


def test_terms_that_make_up_a_curve_end_where_their_driver_was_seen(tmp_path):
    world = draw_motion(174)
    world.write(tmp_path / "set")
    diagnosis = motion_laws.with_laws(diagnose_motions([read_motion_set(tmp_path / "set")]))
    (law,) = (law for law in diagnosis.laws[world.law.joint].laws if law.driver == "own angle")
    together = Counter(term.acts_on for term in law.terms)
    assert sorted(together.values()) == [1, 2]
    assert all(term.seen.ends == (together[term.acts_on] > 1) for term in law.terms)


def test_a_law_of_poses_is_placed_told_and_predicts_another_series(tmp_path):
    world = draw_poses(2)
    world.write(tmp_path / "set")
    world.write(tmp_path / "unseen", part=1)
    document, page, model, out = told(tmp_path)
    truth = world.truth
    assert document["verdict"] == "unexplained"
    (law,) = document["unnamed"]
    assert (law["where"], law["driver"]) == (truth["where"], truth["driver"])
    assert law["test"] in page
    noise = document["noise_floor"]
    (check,) = document["checks"]
    assert check["extended"]["rmse"] > 5.0 * noise
    assert check["characterised"]["rmse"] < 1.2 * noise
    (entry,) = model["laws"]
    assert entry["known_on_path"]
    # Where nobody knows how the joints came, the law acts with its mean.
    loaded, q = load_pose_model(out), np.full((1, 6), 0.3)
    came, other = (loaded.flange(q, np.full((1, 6), side))[0] for side in (1.0, -1.0))
    middle = loaded.flange(q)[0]
    assert np.linalg.norm(came[:3, :3] - other[:3, :3]) > 1e-3
    assert 0.0 < np.linalg.norm(came[:3, :3] - middle[:3, :3]) < np.linalg.norm(came[:3, :3] - other[:3, :3])


def test_the_course_of_time_is_a_law_of_its_joint_and_no_path_knows_it(tmp_path):
    world = draw_poses(9)
    diagnosis = pose_laws.with_laws(diagnose_poses([read_pose_set(world.write(tmp_path / "set"))]))
    (law,) = diagnosis.laws.laws
    assert (law.where, law.driver) == (world.truth["where"], "time")
    assert diagnosis.verdict == "unexplained"
    ((term, weights),) = pose_laws.model_with_laws(diagnosis).laws
    assert not term.document(weights)["known_on_path"]


def test_where_nothing_remains_nothing_is_searched(tmp_path, monkeypatch):
    monkeypatch.setattr(motion_laws, "searched", None)
    hidden = Recording(seconds=6.0).with_gear(2, stiffness=0.7)
    diagnosis = diagnose_motions([read_motion_set(record(tmp_path / "set", hidden, 4))])
    assert diagnosis.verdict == "explained"
    assert motion_laws.with_laws(diagnosis) is diagnosis
