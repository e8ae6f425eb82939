"""Arms of six and seven joints whose target is a point: right names, nothing said of rotations, shared placements."""

import json

import numpy as np
import pytest

from doormill_ros.diagnosis.core.kind import run as run_kind
from doormill_ros.diagnosis.pose.diagnosis import diagnose_poses
from doormill_ros.diagnosis.pose.fitting.fit import fit_causes, place_nominally
from doormill_ros.diagnosis.pose.fitting.placement import Seen, place_together
from doormill_ros.diagnosis.pose.kind import Poses
from doormill_ros.measurements.sets.pose_set import read_pose_set
from doormill_ros.robot_model.pose.causes.joint_sag import JointSag
from doormill_ros.robot_model.pose.causes.link_geometry import LinkGeometry
from doormill_ros.robot_model.pose.chain import frames, residual
from doormill_ros.robot_model.pose.model import PoseModel, load_pose_model
from support.arms import SIX

GEOMETRY = [(2, "a", 4e-4), (3, "alpha", 5e-4), (4, "d", -3e-4)]
SAG = [(2, 2e-5), (4, 3e-5)]
PERIODIC = [(1, 2, 3e-4, 0.3), (3, 9, 2e-4, 0.0)]
SHARED = {"names": ("one", "two"), "same": {"two": "one"}}


def everywhere(seed, dh):
    """Errors of half a millimetre and half a milliradian in every length and angle."""
    rng = np.random.default_rng(seed)
    names = ("theta", "d", "a", "alpha")
    return [(k + 1, name, float(rng.normal(0.0, 5e-4))) for k in range(len(dh)) for name in names]


@pytest.fixture
def diagnose(tmp_path, write_arm_sets, arm):
    def run(rows=400, seed=3, check=(), **more):
        folders = write_arm_sets(tmp_path / "data", arm(**more), rows, seed)
        hold = [folder for folder in folders if folder.name in check]
        run_kind(Poses(), [f for f in folders if f not in hold], hold, tmp_path / "out")
        return json.loads((tmp_path / "out" / "diagnosis.json").read_text())

    return run


def keys_of(value):
    """Every key of a document, however deep."""
    if isinstance(value, dict):
        return set(value) | {key for one in value.values() for key in keys_of(one)}
    return {key for one in value for key in keys_of(one)} if isinstance(value, list) else set()


def test_seven_joints_with_positions_alone(diagnose, tmp_path):
    document = diagnose(geometry=GEOMETRY, sag=SAG, periodic=PERIODIC, check=["two"], **SHARED)
    found = {(c["cause"], c["where"]): c["parameters"] for c in document["causes"]}
    assert set(found) == (
        {("link_geometry", f"link {k}") for k in (2, 3, 4)}
        | {("joint_sag", f"joint {k}") for k in (2, 4)}
        | {("joint_periodic_error", f"joint {k}") for k in (1, 3)}
    )
    assert document["verdict"] == "explained"
    truths = [("link_geometry", f"link {k}", name, size) for k, name, size in GEOMETRY]
    truths += [("joint_sag", f"joint {k}", "compliance", size) for k, size in SAG]
    truths += [("joint_periodic_error", f"joint {k}", f"order_{o}", size) for k, o, size, _ in PERIODIC]
    for cause, where, name, size in truths:
        entry = found[cause, where][name]
        assert abs(entry["value"] - size) < 4.0 * entry["std"], (cause, where)
        assert entry["std"] < 0.1 * abs(size), (cause, where)
    # Predicted by the placement of the first, not a row of it used.
    [check] = document["checks"]
    assert (check["rows"], check["placement_rows"]) == (400, 0)
    assert check["extended"]["rmse"] < 1.1 * document["noise_floor"]
    assert len(check["outside_coverage"]) == 7
    model = load_pose_model(tmp_path / "out" / "model.yaml")
    assert model.flange(np.zeros((1, 7))).shape == (1, 4, 4)


def test_nothing_is_said_of_rotations_that_nobody_measured(diagnose, tmp_path):
    document = diagnose(geometry=GEOMETRY, check=["two"], names=("one", "two"))
    assert not [key for key in keys_of(document) if "rotation" in key]
    assert "NaN" not in json.dumps(document)
    [entry] = document["not_determined"]
    assert entry["what"] == "orientation of the target on the flange"
    assert ("link 7", ["theta", "d", "a", "alpha"]) in [
        (e["where"], e["parameters"]) for e in document["not_distinguishable_from_placement"]
    ]
    assert any("Positions alone" in line for line in document["remarks"])
    page = (tmp_path / "out" / "report.html").read_text()
    assert "Rotation before" not in page
    assert "orientation of the target on the flange" in page


def test_sets_of_one_placement_count_as_one(diagnose):
    """Thirty rows alone place a set badly; with the placement of another they are as good as the others."""
    document = diagnose(geometry=GEOMETRY, **SHARED)
    assert len(document["sets"]) == 2
    for entry in document["sets"]:
        assert entry["extended"]["series_out_rmse"] < 1.1 * document["noise_floor"]


def test_a_checked_set_may_have_the_placement_of_another_checked_one(diagnose):
    shared = {"names": ("one", "new", "last"), "same": {"last": "new"}}
    document = diagnose(geometry=GEOMETRY, sag=SAG, check=["new", "last"], **shared)
    assert [check["set"] for check in document["checks"]] == ["new", "last"]
    for check in document["checks"]:
        assert check["extended"]["rmse"] < 1.15 * document["noise_floor"]


def test_points_place_a_set_without_a_guess(tmp_path, write_arm_sets, arm):
    [folder] = write_arm_sets(tmp_path, arm(gross=[("only", 3)], noise=1e-6), 60, 8)
    data = read_pose_set(folder)
    T = frames(data.view.transforms)
    placement = place_together([Seen(T, data.position, None)], (1e-5, 1.0))
    error = np.linalg.norm(residual(T, placement, data.position, None)[:, :3], axis=1)
    assert np.delete(error, 3).max() < 1e-5
    assert error[3] > 4e-3


@pytest.mark.parametrize(("rows", "strange"), [(60, 0.0), (150, 1e-4), (1000, 0.0), (1000, 1e-4)])
@pytest.mark.parametrize("dh", [None, SIX], ids=["seven", "six"])
def test_unseen_rows_are_predicted_better_than_by_plain_calibration(
    tmp_path,
    write_arm_sets,
    arm,
    rows,
    strange,
    dh,
):
    """Half a millimetre of geometry everywhere does not hide what else is wrong, nor do few rows spoil it."""
    more = {} if dh is None else {"dh": dh, "masses": (60.0, 50.0, 30.0, 15.0, 8.0, 3.0)}
    sag = [(2, 2e-6), (3, 3e-6)] if dh else [(2, 8e-6), (3, 1.3e-5), (4, 2e-5)]
    one = arm(
        geometry=everywhere(2, dh or range(7)),
        sag=sag,
        periodic=[(1, 2, 1e-4, 0.4), (3, 5, 1e-4, 1.0)],
        strange=strange,
        **SHARED,
        **more,
    )
    data, other = (read_pose_set(folder) for folder in write_arm_sets(tmp_path, one, rows, 4))
    causes = [LinkGeometry(f"link {k}", data.dh) for k in range(1, data.joints)]
    causes += [JointSag(f"joint {k}") for k in range(2, data.joints)]
    plain = fit_causes([data], causes, place_nominally([data])).problem
    model = PoseModel("", data.dh, data.links, plain.layout.causes, plain.x)
    found = diagnose_poses([data])

    def off(frames_of, placement):
        error = residual(frames_of(other.view), placement, other.position, None)[:, :3]
        return np.sqrt(np.mean(np.sum(error**2, axis=1)))

    extended = off(found.model.frames, found.extended.problem.placements[0])
    assert extended < off(model.frames, plain.placements[0])
    if rows == 1000 and not strange:
        assert extended < 1.15 * np.sqrt(3.0) * 1.5e-5
        assert found.verdict == "explained"
