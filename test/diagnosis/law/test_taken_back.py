"""A cause that a law stands for is in nothing that a diagnosis leaves: model, figures, intervals, reasons."""

import json

import numpy as np
import pytest

from doormill_ros.diagnosis.core.kind import run as run_kind
from doormill_ros.diagnosis.pose.check import check_set
from doormill_ros.diagnosis.pose.diagnosis import diagnose_poses
from doormill_ros.diagnosis.pose.fitting.model import rmse
from doormill_ros.diagnosis.pose.kind import Poses
from doormill_ros.diagnosis.pose.laws import NEEDLESS, with_laws
from doormill_ros.diagnosis.pose.telling.certainty import certainty_section
from doormill_ros.measurements.sets.pose_set import read_pose_set
from doormill_ros.robot_model.pose.chain import residual
from doormill_ros.robot_model.pose.model import load_pose_model
from support.pose_laws.laws import Law
from support.pose_laws.world import World

LONGER = np.array([0.0, 4e-4, 0.0, 0.0, 0.0, 0.0])


@pytest.fixture(scope="module")
def series(tmp_path_factory):
    """Joint 3 turns with the angle of joint 4, for which several links can stand; link 2 is longer than stated."""
    folder = tmp_path_factory.mktemp("taken_back")
    law = Law("coupling", 3, "angle of joint 4", lambda session: np.cos(session.q[:, 3]))
    world = World(62, law, 5.0, LONGER)
    return world.write(folder / "set", 300), world.write(folder / "unseen", 300, part=1)


@pytest.fixture(scope="module")
def found(series):
    return with_laws(diagnose_poses([read_pose_set(series[0])]))


def taken_back(found):
    return [cause for cause, why in found.examination.refused if why == NEEDLESS]


def test_the_model_holds_what_is_named_alone(found, series, tmp_path):
    assert [cause.key for cause in found.examination.named] == [("link_geometry", "link 2")]
    assert any(cause.of_robot for cause in taken_back(found))
    run_kind(Poses(), [series[0]], [series[1]], tmp_path)
    model = load_pose_model(tmp_path)
    assert [cause.key for cause in model.causes] == [("link_geometry", "link 2")]
    document = json.loads((tmp_path / "diagnosis.json").read_text(encoding="utf-8"))
    # One model, one set of numbers: what is told of the link is what the file says, beside the law.
    (cause,) = document["causes"]
    parameters = cause["parameters"]
    names = [c.name for c in model.causes[0].coefficients]
    assert [parameters[name]["value"] for name in names] == pytest.approx(list(model.x), rel=1e-9, abs=1e-15)
    assert abs(parameters["a"]["value"] - LONGER[1]) < 4.0 * parameters["a"]["std"]
    assert parameters["a"]["std"] < 0.02 * LONGER[1]
    (check,) = document["checks"]
    assert check["characterised"]["rmse"] < 1.1 * document["noise_floor"]
    # Why a cause is not named is told with its gain.
    told = {(entry["cause"], entry["where"]): entry["why"] for entry in document["rejected"]}
    assert {told[cause.key] for cause in taken_back(found)} == {NEEDLESS}
    assert "real" not in told.values()


def test_fitted_rows_are_off_by_what_the_model_leaves(found):
    data, kept = found.sets[0], [~bad for bad in found.gross]
    placement = found.extended.problem.placements[0]
    left = residual(found.model.frames(data.view), placement, data.position, data.rotation)
    assert found.train_rmse[1] == pytest.approx(rmse([left], kept), rel=1e-9)
    # Few numbers: rows left out are off by hardly more than fitted ones.
    assert found.train_rmse[1] == pytest.approx(found.holdout_rmse[1], rel=0.1)


def test_coefficients_are_those_of_a_fit_without_what_was_taken_back(found):
    gone = found.extended.ids(taken_back(found))
    assert np.all(found.std[gone] == 0.0)
    assert np.all(found.extended.problem.x[gone] == 0.0)
    ((cause, part),) = [pair for pair in found.extended.parts if pair[0].where == "link 2"]
    length = [c.name for c in cause.coefficients].index("a")
    value, std = found.extended.problem.x[part][length], found.std[part][length]
    assert abs(value - LONGER[1]) < 4.0 * std


def test_intervals_hold_what_they_promise(found):
    (entry,) = certainty_section(found)["blocks_left_out"]
    # What is left is no noise, yet as large as is said.
    assert entry["rmse"] == pytest.approx(entry["expected_rmse"], rel=0.2)
    assert 0.88 < entry["within_95"] < 0.99


def test_a_set_of_the_same_placement_is_predicted_by_that_of_the_laws(found, series):
    lines = (series[0] / "set.yaml").read_text(encoding="utf-8")
    again = series[0].parent / "again"
    again.mkdir()
    (again / "set.yaml").write_text(lines.replace("fitted", "same as set"), encoding="utf-8")
    table = (series[0] / "poses.csv").read_text(encoding="utf-8")
    (again / "poses.csv").write_text(table, encoding="utf-8")
    check = check_set(found, read_pose_set(again))
    assert check["placement_rows"] == 0
    assert check["extended"]["rmse"] == pytest.approx(found.train_rmse[1], rel=1e-9)
    assert check["characterised"]["rmse"] < 1.05 * found.noise_floor
