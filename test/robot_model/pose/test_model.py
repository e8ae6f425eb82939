"""The model that a diagnosis leaves behind."""

import json

import numpy as np
import pytest
import yaml

from doormill_ros.diagnosis.core.kind import run as run_kind
from doormill_ros.diagnosis.pose.diagnosis import diagnose_poses
from doormill_ros.diagnosis.pose.fitting.placement import Seen, place_together
from doormill_ros.diagnosis.pose.kind import Poses
from doormill_ros.measurements.sets.pose_set import read_pose_set
from doormill_ros.robot_model.errors import PoseModelError
from doormill_ros.robot_model.pose.chain import Placement, residual
from doormill_ros.robot_model.pose.model import load_pose_model, model_document


def off_after_placement(T, wanted):
    """Position error of every pose once base and target are moved to fit best."""
    frames = np.broadcast_to(np.eye(4), (len(T), 7, 4, 4)).copy()
    frames[:, -1] = T
    here = Placement(np.eye(4), np.eye(4))
    found = place_together([Seen(frames, wanted[:, :3, 3], wanted[:, :3, :3])], (1e-5, 4e-5), here)
    return np.linalg.norm(residual(frames, found, wanted[:, :3, 3], wanted[:, :3, :3])[:, :3], axis=1)


def test_the_file_predicts_the_true_robot(tmp_path, write_pose_sets, faults, invented):
    case = faults(
        geometry=[(2, "a", 4e-4), (5, "alpha", -3e-4)], sag=[(3, 1.5e-5)], periodic=[(4, 7, 3e-4, 0.5)]
    )
    folders = write_pose_sets(tmp_path, case, 300, 31)
    run_kind(Poses(), folders, [], tmp_path / "out")
    model = load_pose_model(tmp_path / "out")
    q = np.random.default_rng(7).uniform(
        [-2.0, -2.3, -2, -2.5, -2, -2.5], [2.0, -0.6, 2, 2.5, 2, 2.5], (40, 6)
    )
    wrong = invented["dh"].copy()
    wrong[1, 2] += 4e-4
    wrong[4, 3] -= 3e-4
    true = q.copy()
    true[:, 2] += [1.5e-5 * invented["torque"](one, 3) for one in q]
    true[:, 3] += 3e-4 * np.cos(7 * q[:, 3] - 0.5)
    wanted = np.array([invented["pose"](one, wrong) for one in true])
    nominal = np.array([invented["pose"](one, invented["dh"]) for one in q])
    # Up to a placement: what that could imitate is in no model.
    assert off_after_placement(model.flange(q), wanted).max() < 1e-5
    assert off_after_placement(nominal, wanted).max() > 1e-4


def test_outside_the_visited_angles_a_periodic_error_fades(tmp_path, write_pose_sets, faults):
    """Trained where joint 1 moves within one radian, the model makes up nothing elsewhere."""
    folder = write_pose_sets(tmp_path, faults(periodic=[(1, 14, 3e-4, 0.0)], names=["one"]), 600, 32)[0]
    lines = (folder / "poses.csv").read_text().splitlines()
    narrow = [line for line in lines[1:] if abs(float(line.split(",")[3])) < 0.8]
    (folder / "poses.csv").write_text("\n".join([lines[0], *narrow]) + "\n")
    found = diagnose_poses([read_pose_set(folder)])
    [score] = found.established
    assert score.cause.key == ("joint_periodic_error", "joint 1")
    columns = score.cause.columns(found.extended.problem.views[0])
    from doormill_ros.robot_model.pose.causes.joint_waves import harmonics

    angle = np.linspace(-np.pi, np.pi, 720)
    curve = harmonics(angle, score.cause.orders) @ found.extended.problem.x
    inside = np.abs(angle) < 0.7
    # A constant turn of joint 1 is a turned base: it belongs to the placement.
    error = curve[inside] - 3e-4 * np.cos(14 * angle[inside])
    assert np.std(error) < 1.5e-5
    # Elsewhere it may swing out, yet not to twice of what there is; plain least squares makes up radians.
    assert np.abs(curve).max() < 2.0 * 3e-4
    assert len(columns) == 1


def test_model_file_round_trip(tmp_path, write_pose_sets, faults):
    folders = write_pose_sets(tmp_path, faults(sag=[(2, 1e-5)], periodic=[(3, 4, 2e-4, 0.0)]), 200, 33)
    model = diagnose_poses([read_pose_set(folder) for folder in folders]).model
    path = tmp_path / "model.yaml"
    path.write_text(yaml.safe_dump(model_document(model, "test")))
    again = load_pose_model(path)
    q = np.random.default_rng(1).uniform(-2.0, 2.0, (5, 6))
    np.testing.assert_allclose(again.flange(q), model.flange(q), atol=1e-14)


@pytest.mark.parametrize(
    "text", ["", "schema: other/1", "{", "schema: doormill/extended-pose-model/1\nrobot: x"]
)
def test_a_bad_model_file_is_refused(tmp_path, text):
    path = tmp_path / "model.yaml"
    path.write_text(text)
    with pytest.raises(PoseModelError):
        load_pose_model(path)


def test_the_report_is_one_page(tmp_path, write_pose_sets, faults):
    folders = write_pose_sets(tmp_path, faults(periodic=[(3, 4, 3e-4, 0.0)], names=["a", "b"]), 200, 34)
    run_kind(Poses(), folders[:1], folders[1:], tmp_path / "out")
    page = (tmp_path / "out" / "report.html").read_text()
    assert "Explained" in page.split("</h1>")[0]
    assert page.count("<svg") > 5
    assert "http" not in page.replace("http-equiv", "")
    assert "nan" not in page
    assert json.loads((tmp_path / "out" / "diagnosis.json").read_text())["extended_model"] == "model.yaml"
