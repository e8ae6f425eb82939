"""Several series at once: each is told by its name, and counts by its own noise."""

import json

import numpy as np
import pytest

from doormill_ros.diagnosis.core.kind import run as run_kind
from doormill_ros.diagnosis.pose.diagnosis import PoseQuestion
from doormill_ros.diagnosis.pose.kind import Poses
from doormill_ros.measurements.errors import SetMixError
from doormill_ros.measurements.sets.pose_set import read_pose_set
from doormill_ros.tools.diagnose import main


def test_two_series_of_one_name_are_refused(tmp_path, write_arm_sets, arm, capsys):
    """A step in one of them would be laid on both."""
    folders = write_arm_sets(tmp_path, arm(names=("mon/poses", "tue/poses")), 40, 1)
    arguments = [part for folder in folders for part in ("--data", str(folder))]
    assert main([*arguments, "--out", str(tmp_path / "out")]) == 2
    told = capsys.readouterr().err
    assert "tue/poses/set.yaml: line 1, column 1: the folder is called poses" in told
    assert "mon/poses" in told
    assert not (tmp_path / "out").exists()
    with pytest.raises(SetMixError, match="rename"):
        PoseQuestion([read_pose_set(folder) for folder in folders])


#: Of the fine tracker and of the coarse one [m].
FINE, COARSE = 1.5e-5, 3e-4
GEOMETRY = [(2, "a", 9e-5), (3, "alpha", 1.2e-4), (4, "d", 8e-5), (5, "theta", 1.5e-4)]


@pytest.fixture(scope="module")
def by_two_trackers(tmp_path_factory, write_arm_sets, arm):
    """What the fine tracker alone tells, both together, and both the other way round; one row in error."""
    folder = tmp_path_factory.mktemp("noises")
    fine = arm(names=("fine",), noise=FINE, geometry=GEOMETRY, gross=[("fine", 7)])
    coarse = arm(names=("coarse",), noise=COARSE, geometry=GEOMETRY)
    one, two = write_arm_sets(folder, fine, 250, 41) + write_arm_sets(folder, coarse, 250, 42)
    found = []
    for name, sets in (("one", [one]), ("both", [one, two]), ("turned", [two, one])):
        run_kind(Poses(), sets, [], folder / name)
        found.append(json.loads((folder / name / "diagnosis.json").read_text(encoding="utf-8")))
    return found


def test_a_coarse_series_takes_nothing_from_a_fine_one(by_two_trackers):
    alone, both, turned = by_two_trackers
    expected = {("link_geometry", f"link {k}") for k in (2, 3, 4, 5)} | {("gross_error", "set fine")}
    for document in (both, turned):
        causes = {(cause["cause"], cause["where"]): cause["parameters"] for cause in document["causes"]}
        assert set(causes) == expected
        assert document["verdict"] == "explained"
        assert document["outliers_by_set"] == {"fine": [7]}
        for link, name, size in GEOMETRY:
            entry = causes["link_geometry", f"link {link}"][name]
            assert abs(entry["value"] - size) < 4.0 * entry["std"], (link, name)
            assert entry["std"] < 0.25 * size, (link, name)
    left = {one["set"]: one["extended"]["holdout_rmse"] for one in both["sets"]}
    assert left["fine"] == pytest.approx(alone["extended"]["holdout_rmse"], rel=0.05)
    assert left["fine"] < 1.1 * np.sqrt(3.0) * FINE
    assert left["coarse"] < 1.1 * np.sqrt(3.0) * COARSE
    # What both leave, and what each was expected to.
    assert both["noise_floor"] == pytest.approx(np.sqrt(1.5 * (FINE**2 + COARSE**2)))
    assert both["extended"]["holdout_rmse"] == pytest.approx(both["noise_floor"], rel=0.1)
    for one in both["certainty"]["blocks_left_out"]:
        assert 0.92 < one["within_95"] < 0.98


def told_of(table):
    """Its rows, the first one their names."""
    return [line.split(",") for line in table.read_text().splitlines()]


def test_a_series_of_one_posture_is_refused(tmp_path, write_arm_sets, arm, capsys):
    (folder,) = write_arm_sets(tmp_path, arm(names=("one",)), 40, 1)
    table = folder / "poses.csv"
    head, first, *rest = told_of(table)
    same = [[str(2 + k), *first[1:]] for k in range(len(rest))]
    table.write_text("\n".join(",".join(row) for row in [head, first, *same]) + "\n")
    assert main(["--data", str(folder), "--out", str(tmp_path / "out")]) == 2
    assert "the table holds 40 rows of 1 postures" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_a_checked_series_that_nothing_places_is_refused_by_its_name_before_anything_is_fitted(
    tmp_path, write_arm_sets, arm, capsys, monkeypatch
):
    one, two = write_arm_sets(tmp_path, arm(names=("one", "two")), 40, 1)
    head, *rows = told_of(two / "poses.csv")
    rows = [
        [value if name != "placement" else "0" for name, value in zip(head, row, strict=True)] for row in rows
    ]
    (two / "poses.csv").write_text("\n".join(",".join(row) for row in [head, *rows]) + "\n")
    monkeypatch.setattr(Poses, "diagnose", lambda *_: pytest.fail("fitted"))
    assert main(["--data", str(one), "--check", str(two), "--out", str(tmp_path / "out")]) == 2
    told = capsys.readouterr().err
    assert f"{two / 'poses.csv'}: line 1, column placement: 0 different postures are marked" in told
