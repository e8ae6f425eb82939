"""`cell --doors 3 --world FILE` with real nodes: bags, inspections and summary of a shift in which things change."""

from __future__ import annotations

import itertools
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from doormill_ros.diagnosis.parts.doors.recorded_cut import recorded_cut
from doormill_ros.diagnosis.parts.kind import inspected_door
from doormill_ros.measurements.inspections.inspection import Inspection, inspections_in
from doormill_ros.recording.replay.run_reader import read_runs
from doormill_ros.tools.cell import main
from doormill_ros.tools.diagnose import main as diagnose

DOOR = "thesis_190_0deg"
CLAMP, GAP = 2e-4, 1e-4
WORLD = f"""
schema: doormill/world/1
seed: 4
clamp: {{shift: [0, 0, {CLAMP}], from_door: 1}}
change: [{{from_door: 2, clamp: {{shift: [0, 0, 0]}}, robot: {{gap: [{GAP}, 0, 0, 0, 0, 0]}}}}]
"""


@pytest.fixture(scope="module")
def shift(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """Three doors: as assumed, with a clamp that slips, with a gap in joint 1."""
    folder = tmp_path_factory.mktemp("shift")
    (folder / "world.yaml").write_text(WORLD, encoding="utf-8")
    out = folder / "out"
    arguments = ["--door", DOOR, "--doors", "3", "--world", str(folder / "world.yaml"), "--out", str(out)]
    code = main(arguments)
    return {"out": out, "code": code, "doors": inspections_in(out)}


def walls(inspection: Inspection, axis: int, sign: int) -> float:
    """Mean deviation of the walls whose normals are within 30 degrees of a door axis [m]."""
    rows = inspection.wall & (sign * inspection.normal[:, axis] > np.cos(np.pi / 6.0))
    assert np.sum(rows) > 5
    return float(inspection.deviation[rows].mean())


def test_every_door_leaves_a_bag_a_summary_and_an_inspection_and_the_shift_a_table(
    shift: dict[str, Any],
) -> None:
    document = json.loads((shift["out"] / "shift.json").read_text(encoding="utf-8"))
    rows = document["doors"]
    assert document["schema"] == "doormill/shift/1"
    assert [(row["number"], row["folder"], row["door_id"]) for row in rows] == [
        (k, f"door_00{k}", DOOR) for k in range(3)
    ]
    runs = [read_runs(shift["out"] / row["folder"] / "bag") for row in rows]
    # Nothing of a door reaches the bag of the next.
    assert [[run.run_id for run in found] for found in runs] == [[row["run_id"]] for row in rows]
    summaries = [
        json.loads((shift["out"] / row["folder"] / "summary.json").read_text(encoding="utf-8"))
        for row in rows
    ]
    assert [s["run_id"] for s in summaries] == [row["run_id"] for row in rows]
    assert [s["feature_error"]["corrected_max"] for s in summaries] == [r["largest_deviation"] for r in rows]
    assert [s["success"] for s in summaries] == [row["success"] for row in rows]
    assert shift["code"] == (0 if all(row["success"] for row in rows) else 1)


def test_the_controller_is_the_same_for_all_doors(shift: dict[str, Any]) -> None:
    homes = sorted(path.relative_to(shift["out"]).as_posix() for path in shift["out"].rglob("HOME"))
    assert homes == ["controller/HOME"]
    assert (shift["out"] / "controller" / "HOME" / "Hei2.req").read_text().split()[0] == "3"


def test_the_inspections_are_read_matched_and_a_takt_apart(shift: dict[str, Any]) -> None:
    doors = shift["doors"]
    assert [door.name for door in doors] == ["door_000", "door_001", "door_002"]
    assert [(b.measured_at - a.measured_at).total_seconds() for a, b in itertools.pairwise(doors)] == [
        180.0,
        180.0,
    ]
    used = [len(inspected_door(door, recorded_cut(door)).door.points) for door in doors]
    assert len(used) == 3
    assert min(used) > 100


def test_the_slipping_clamp_shows_on_the_walls_of_its_door(shift: dict[str, Any]) -> None:
    before, slipped, _ = shift["doors"]
    # The door was moved up after its picture: the pocket sits lower in it.
    assert walls(slipped, 2, 1) - walls(before, 2, 1) == pytest.approx(-CLAMP, abs=3e-5)
    assert walls(slipped, 2, -1) - walls(before, 2, -1) == pytest.approx(CLAMP, abs=3e-5)
    for sign in (1, -1):
        assert walls(slipped, 1, sign) - walls(before, 1, sign) == pytest.approx(0.0, abs=3e-5)


def test_the_gap_shows_on_the_walls_that_it_lets_the_tool_off(shift: dict[str, Any]) -> None:
    before, _, worn = shift["doors"]
    change = worn.deviation - before.deviation
    # 1e-4 rad at 1.8 m; where the joint lay against the other flank nothing changes.
    assert 1e-4 < np.abs(change[worn.wall]).max() < 4e-4
    assert np.quantile(np.abs(change[worn.wall]), 0.1) < 5e-5


def test_diagnose_takes_the_folder_of_the_shift(shift: dict[str, Any], tmp_path: Path) -> None:
    assert diagnose(["--inspections", str(shift["out"]), "--out", str(tmp_path), "--quiet"]) == 0
    document = json.loads((tmp_path / "diagnosis.json").read_text(encoding="utf-8"))
    assert [one["run_id"] for one in document["inspections"]] == [door.run_id for door in shift["doors"]]
    assert document["points"]["measured"] == sum(map(len, shift["doors"]))
