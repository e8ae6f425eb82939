"""Sets that state no masses: sag is named by what unknown moments of the links do, and no wave stands for it."""

import json

import numpy as np
import pytest
import yaml

from doormill_ros.diagnosis.core.kind import run as run_kind
from doormill_ros.diagnosis.pose.kind import Poses
from doormill_ros.robot_model.pose.causes.registry import build_cause
from doormill_ros.robot_model.pose.model import load_pose_model
from doormill_ros.robot_model.pose.view import SetView


@pytest.fixture
def diagnose(tmp_path, write_pose_sets, faults):
    def run(rows=220, **case):
        folders = write_pose_sets(tmp_path / "data", faults(**case), rows, 8)
        for folder in folders:
            document = yaml.safe_load((folder / "set.yaml").read_text())
            del document["model"]["links"]
            (folder / "set.yaml").write_text(yaml.safe_dump(document))
        run_kind(Poses(), folders, [], tmp_path / "out")
        document = json.loads((tmp_path / "out" / "diagnosis.json").read_text())
        return document, {(one["cause"], one["where"]) for one in document["causes"]}

    return run


def test_sag_is_named_where_it_is_and_the_model_predicts_the_true_robot(diagnose, tmp_path, invented):
    document, names = diagnose(sag=[(2, 1.1e-5), (3, 1.5e-5)], geometry=[(3, "a", 4e-4)])
    assert document["verdict"] == "explained"
    assert names == {("joint_sag", "joint 2"), ("joint_sag", "joint 3"), ("link_geometry", "link 3")}
    assert document["extended"]["holdout_rmse"] < 1.1 * document["noise_floor"]
    [sag] = [one for one in document["causes"] if one["where"] == "joint 3"]
    assert sag["parameters"]
    assert all(abs(one["value"]) > 2.0 * one["std"] for one in sag["parameters"].values())
    assert any("No masses are known" in line for line in document["remarks"])
    model = load_pose_model(tmp_path / "out")
    q = np.random.default_rng(7).uniform([-2, -2.3, -2, -2.5, -2, -2.5], [2, -0.6, 2, 2.5, 2, 2.5], (40, 6))
    wrong = invented["dh"].copy()
    wrong[2, 2] += 4e-4
    true = q.copy()
    for joint, compliance in ((2, 1.1e-5), (3, 1.5e-5)):
        true[:, joint - 1] += [compliance * invented["torque"](one, joint) for one in q]
    wanted = np.array([invented["pose"](one, wrong) for one in true])
    nominal = np.array([invented["pose"](one, invented["dh"]) for one in q])

    def scatter(T):
        off = np.einsum("nji,nj->ni", T[:, :3, :3], wanted[:, :3, 3] - T[:, :3, 3])
        return np.linalg.norm(off - off.mean(axis=0), axis=1).max()

    # Up to a shift of the target: what that could imitate is in no model.
    assert scatter(model.flange(q)) < 3e-5
    assert scatter(nominal) > 1e-3


def test_a_joint_that_errs_by_its_own_angle_has_no_sag(diagnose):
    document, names = diagnose(periodic=[(2, 1, 2e-4, 0.4)])
    assert (document["verdict"], names) == ("explained", {("joint_periodic_error", "joint 2")})


def test_a_sound_robot_stays_sound(diagnose):
    document, names = diagnose()
    assert (document["verdict"], names) == ("consistent", set())


def test_levers_hold_every_torque_of_gravity(invented):
    """Whatever the links weigh: the torque, from differences of the energy, is a sum of the levers."""
    q = np.random.default_rng(3).uniform(-2.5, 2.5, (60, 6))
    view = SetView("", invented["dh"], (), q, np.arange(60))
    for joint in range(2, 7):
        torque = np.array([invented["torque"](one, joint) for one in q])
        levers = view.levers(joint)
        moments, *_ = np.linalg.lstsq(levers, torque, rcond=1e-9)
        assert levers.shape == (60, 3 * (7 - joint))
        np.testing.assert_allclose(levers @ moments, torque, atol=1e-6)
    assert np.abs(view.levers(1)).max() < 1e-12  # its axis is upright


def test_a_file_states_the_frames_of_unknown_moments(invented):
    again = build_cause("joint_sag", "joint 2", {"frames": 5}, invented["dh"])
    assert again.settings == {"frames": 5}
    assert [one.name for one in again.coefficients[:3]] == ["frame_2_x", "frame_2_y", "frame_2_z"]
    assert build_cause("joint_sag", "joint 2", {}, invented["dh"]).settings == {}
