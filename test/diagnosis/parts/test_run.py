"""`diagnose --inspections`: measured walls and the bags of their runs in, the robot's hidden fault out."""

import json
import shutil

import numpy as np
import pytest

from doormill_ros.cell.places.layout import load_layout
from doormill_ros.diagnosis.parts.doors.recorded_cut import recorded_cut
from doormill_ros.frames import apply, inverse
from doormill_ros.measurements.inspections.inspection import COLUMNS, read_inspection
from doormill_ros.recording.replay.run_reader import read_runs
from doormill_ros.robot.description import load_robot
from doormill_ros.robot_model.extended_model import load_compliance_model
from doormill_ros.simulation.controller.records.executed_path import ExecutedPath
from doormill_ros.simulation.judge.milled_part import inspect
from doormill_ros.simulation.truth.robot import TruthRobot
from doormill_ros.tools.diagnose import main
from support.real_bags import as_real
from support.source_tree import ROOT

DOORS = ("thesis_190_0deg", "thesis_1350_0deg")
BACKLASH = {"cause": "joint_backlash", "where": "joint 1", "parameters": {"gap": 1e-4, "crossing": 0.0}}
NOISE = 1.5e-5  #: stated, of contours sampled every quarter millimetre


def run_id(bag):
    (run,) = read_runs(bag)
    return run.run_id


def describe(folder, identifier, changes=None):
    content = {
        "schema": "doormill/inspection/1",
        "run_id": identifier,
        "bag": "bag",
        "measured_at": "2026-11-22T08:00:00Z",
        "noise": NOISE,
        "datum": "camera",
    } | (changes or {})
    lines = [f"{key}: {value}" for key, value in content.items()]
    (folder / "inspection.yaml").write_text("\n".join(lines) + "\n")


def measured(folder, name, effects, rng):
    """The inspection of a door that a robot with hidden effects milled by the commands recorded in a bag."""
    folder.mkdir()
    shutil.copytree(ROOT / "bags" / name, folder / "bag")
    describe(folder, run_id(folder / "bag"))
    (folder / "points.csv").write_text(",".join(COLUMNS) + "\nhinge_1,wall,0,0,0,0,0,1,0\n")
    cut = recorded_cut(read_inspection(folder))
    layout = load_layout()
    robot = load_robot(layout.robot)
    truth, tip = TruthRobot(robot.dh, effects, robot.stiffness), layout.T_flange_tool[:3, 3]
    step = np.diff(cut.q, axis=0)
    last = np.zeros_like(cut.q)
    for i in range(1, len(last)):
        last[i] = np.where(np.abs(step[i - 1]) > 1e-9, np.sign(step[i - 1]), last[i - 1])
    loaded = np.any(cut.wrench != 0.0, axis=1)
    moved = truth.deflected(cut.q, cut.wrench, tip, last) @ inverse(truth.forward(cut.q))
    actual = np.where(loaded[:, None, None], moved @ cut.tool, cut.tool)
    path = ExecutedPath(
        time=cut.time,
        T_base_tool=actual,
        T_base_tool_commanded=cut.tool,
        q=cut.q,
        motion=np.zeros(len(cut.time), dtype=int),
        cutting=cut.cutting,
        feature=np.array(cut.feature),
        wrench=cut.wrench,
    )
    part = inspect(cut.recipe, cut.T_base_door, path)
    rows = []
    for feature in cut.recipe.features:
        result = part.feature(feature.id)
        at = np.arange(0, len(result.points) - 1, 12)
        way = np.roll(result.points[:-1], -1, axis=0) - np.roll(result.points[:-1], 1, axis=0)
        first, second = result.points[:-1], result.points[1:]
        turning = np.sign(np.sum(first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]))
        out = turning * np.column_stack([way[:, 1], -way[:, 0]])
        out /= np.linalg.norm(out, axis=1, keepdims=True)
        T_door_feature = cut.recipe.T_door_feature(feature)
        # Measured half way down, as a probe would.
        point = apply(
            T_door_feature, np.column_stack([result.points[at], np.full(len(at), result.depths[2])])
        )
        normal = np.column_stack([out[at], np.zeros(len(at))]) @ T_door_feature[:3, :3].T
        off = result.by_depth[2][at] + rng.normal(0.0, 1e-5, len(at))
        for p, n, d in zip(point, normal, off, strict=True):
            rows.append(f"{feature.id},wall," + ",".join(f"{v:.9f}" for v in (*p, *n, d)))
    rows.append(f"{cut.recipe.features[0].id},floor,0,0,0,1,0,0,0")
    (folder / "points.csv").write_text(",".join(COLUMNS) + "\n" + "\n".join(rows) + "\n")


def run(capsys, *arguments):
    code = main([str(a) for a in (*arguments, "--quiet")])
    return code, *capsys.readouterr()


@pytest.fixture(scope="module")
def worn(tmp_path_factory):
    """Two doors milled by a robot with a gap in joint 1."""
    folder, rng = tmp_path_factory.mktemp("worn"), np.random.default_rng(1)
    for name in DOORS:
        measured(folder / name, name, [BACKLASH], rng)
    return folder


def test_the_gap_is_found_in_the_walls_of_two_doors(worn, tmp_path, capsys):
    code, out, err = run(capsys, "--inspections", worn, "--out", tmp_path)
    assert (code, err) == (0, "")
    assert "joint_backlash at joint 1" in out
    document = json.loads((tmp_path / "diagnosis.json").read_text())
    assert document["schema"] == "doormill/diagnosis/1"
    assert document["verdict"] in ("explained", "partly_explained")
    assert [(c["cause"], c["where"]) for c in document["causes"]] == [("joint_backlash", "joint 1")]
    assert document["causes"][0]["parameters"]["gap"]["value"] == pytest.approx(1e-4, rel=0.15)
    assert document["gain"]["holdout_rmse_ratio"] < 0.6
    assert [one["measured_at"] for one in document["inspections"]] == ["2026-11-22T08:00:00+00:00"] * 2
    assert document["points"]["on_floors"] == 2
    assert 100 < document["points"]["used"] < document["points"]["measured"]
    assert load_compliance_model(tmp_path / "model.yaml") is not None
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert "backlash in joint 1 (" in page.split("</h1>")[0]
    assert "<h2>Candidates</h2>" in page


def test_bags_of_a_real_controller_tell_the_path_by_their_targets(worn, tmp_path, capsys):
    real, unlike = tmp_path / "real", tmp_path / "unlike"
    for name in DOORS:
        (real / name).mkdir(parents=True)
        for file in ("inspection.yaml", "points.csv"):
            shutil.copy(worn / name / file, real / name)
        as_real(worn / name / "bag", real / name / "bag")
    found = {}
    for folder in (worn, real):
        code, _, err = run(capsys, "--inspections", folder, "--out", unlike)
        assert (code, err) == (0, "")
        found[folder] = json.loads((unlike / "diagnosis.json").read_text())
    told, planned = found[worn], found[real]
    assert planned["verdict"] == told["verdict"]
    assert [(c["cause"], c["where"]) for c in planned["causes"]] == [("joint_backlash", "joint 1")]
    gaps = [document["causes"][0]["parameters"]["gap"]["value"] for document in (told, planned)]
    assert gaps[1] == pytest.approx(gaps[0], rel=0.03)
    assert planned["points"]["used"] == pytest.approx(told["points"]["used"], rel=0.1)


def test_a_door_is_predicted_by_what_another_taught(worn, tmp_path, capsys):
    one, other = (worn / name for name in reversed(DOORS))
    code, _, err = run(capsys, "--inspections", one, "--check", other, "--out", tmp_path)
    assert (code, err) == (0, "")
    document = json.loads((tmp_path / "diagnosis.json").read_text())
    assert [(c["cause"], c["where"]) for c in document["causes"]] == [("joint_backlash", "joint 1")]
    assert [found["run_id"] for found in document["inspections"]] == [run_id(one / "bag")]
    [check] = document["checks"]
    assert (check["set"], check["rows"] > 100) == (DOORS[0], True)
    assert check["extended"]["rmse"] < 0.6 * check["baseline"]["rmse"]
    assert "Sets that were only predicted" in (tmp_path / "report.html").read_text(encoding="utf-8")


def displaced(folder, datum, shift, turn):
    """Measure the door of a folder against a datum from which it stands displaced and turned (small angles)."""
    describe(folder, run_id(folder / "bag"), {"datum": datum})
    head, *rows = (folder / "points.csv").read_text().splitlines()
    moved = []
    for row in rows:
        feature, surface, *numbers = row.split(",")
        point, normal, off = np.array(numbers[:3], float), np.array(numbers[3:6], float), float(numbers[6])
        off += normal @ (shift + np.cross(turn, point))
        moved.append(",".join([feature, surface, *numbers[:6], f"{off:.9f}"]))
    (folder / "points.csv").write_text("\n".join([head, *moved]) + "\n")


@pytest.mark.parametrize(
    ("datum", "joint", "size"), [("part", 1, 1e-4), ("part", 2, 2e-4), ("feature hinge_1", 2, 2e-4)]
)
def test_the_gap_is_found_whatever_the_doors_are_measured_against(tmp_path, capsys, datum, joint, size):
    # The force across the hinges turns joint 1 one way: a gap in it is a placement and a turn with the last motion.
    where = f"joint {joint}"
    gap = {"cause": "joint_backlash", "where": where, "parameters": {"gap": size, "crossing": 0.0}}
    rng = np.random.default_rng(3)
    (tmp_path / "doors").mkdir()
    for name in DOORS:
        measured(tmp_path / "doors" / name, name, [gap], rng)
        displaced(tmp_path / "doors" / name, datum, rng.normal(0, 4e-4, 3), rng.normal(0, 3e-4, 3))
    code, out, err = run(capsys, "--inspections", tmp_path / "doors", "--out", tmp_path / "out")
    assert (code, err) == (0, "")
    assert f"joint_backlash at {where}" in out
    document = json.loads((tmp_path / "out" / "diagnosis.json").read_text())
    assert [(c["cause"], c["where"]) for c in document["causes"]] == [("joint_backlash", where)]
    assert document["causes"][0]["parameters"]["gap"]["value"] == pytest.approx(size, rel=0.15)
    free = document["baseline"]["holdout_rmse"]
    assert free < 1e-4, "what a placement makes counts in no figure"
    # Against the camera the same deviations count as far as the place is known.
    for name in DOORS:
        describe(tmp_path / "doors" / name, run_id(tmp_path / "doors" / name / "bag"))
    assert run(capsys, "--inspections", tmp_path / "doors", "--out", tmp_path / "camera")[0] == 0
    document = json.loads((tmp_path / "camera" / "diagnosis.json").read_text())
    assert document["verdict"] in ("unexplained", "partly_explained")
    assert document["baseline"]["holdout_rmse"] > free


def test_a_displaced_door_of_a_robot_as_assumed_blames_nothing(tmp_path, capsys):
    measured(tmp_path / "door", DOORS[1], [], np.random.default_rng(4))
    displaced(tmp_path / "door", "part", np.array([0.0, 3e-4, -5e-4]), np.array([4e-4, 0.0, 0.0]))
    code, *_ = run(capsys, "--inspections", tmp_path / "door", "--out", tmp_path / "out")
    assert code == 0
    assert json.loads((tmp_path / "out" / "diagnosis.json").read_text())["causes"] == []


def test_a_robot_as_assumed_is_blamed_for_nothing(tmp_path, capsys):
    measured(tmp_path / "door", DOORS[0], [], np.random.default_rng(2))
    code, _, _ = run(capsys, "--inspections", tmp_path / "door", "--out", tmp_path / "out")
    assert code == 0
    assert json.loads((tmp_path / "out" / "diagnosis.json").read_text())["causes"] == []


@pytest.mark.parametrize(
    ("changes", "complaint"),
    [
        ({"schema": "doormill/inspection/9"}, "inspection.yaml: line 1, column 9: schema is"),
        ({"run_id": "another"}, "inspection.yaml: line 2, column 9: run_id is 'another', the bag holds"),
        ({"bag": "nowhere"}, "inspection.yaml: line 3, column 6: bag is 'nowhere'"),
        ({"measured_at": "yesterday"}, "inspection.yaml: line 4, column 14: measured_at is 'yesterday'"),
        ({"noise": "0.0"}, "inspection.yaml: line 5, column 8: noise is 0.0"),
        ({"noise": "1e-300"}, "column 8: noise is 1e-300, allowed are 1e-08 to 0.001 m"),
        ({"noise": "1e+10"}, "column 8: noise is 1e+10, allowed are 1e-08 to 0.001 m"),
        ({"datum": "luck"}, "inspection.yaml: line 6, column 8: datum is 'luck', allowed are camera"),
        (
            {"datum": "feature hinge_9"},
            "inspection.yaml: line 6, column 8: datum is against 'hinge_9', the recipe has hinge_1, hinge_2",
        ),
        ({"gauge": "mine"}, "inspection.yaml: line 7, column 8: gauge is unknown"),
    ],
)
def test_a_description_that_is_wrong_is_told_with_line_and_column(worn, tmp_path, capsys, changes, complaint):
    shutil.copytree(worn / DOORS[0], tmp_path / "door")
    describe(tmp_path / "door", run_id(worn / DOORS[0] / "bag"), changes)
    code, out, err = run(capsys, "--inspections", tmp_path / "door", "--out", tmp_path / "out")
    assert (code, out) == (2, "")
    assert complaint in err
    assert err.count("\n") == 1
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("old", "new", "complaint"),
    [
        ("nx,ny,nz", "nx,ny,nn", "points.csv: line 1, column nz: the column is missing"),
        ("hinge_1,wall", "hinge_9,wall", "column feature: is 'hinge_9', the recipe has hinge_1, hinge_2"),
        ("hinge_1,wall", "hinge_1,roof", "column surface: is 'roof', allowed are wall and floor"),
        (",floor,0,0,0,1,", ",floor,0,0,0,2,", "column nx: the normal has length 2.0000, allowed is 1"),
        (",floor,0,", ",floor,zero,", "column x: 'zero' is no number"),
        (",floor,0,", ",floor,1e300,", "column x: is 1e+300, allowed is up to 10 m"),
        (",1,0,0,0\n", ",1,0,0,1e300\n", "column deviation: is 1e+300, allowed is up to 0.1 m"),
        (",1,0,0,0\n", ",1,0,0,-0.2\n", "column deviation: is -0.2, allowed is up to 0.1 m"),
    ],
)
def test_a_point_that_is_wrong_is_told_with_line_and_column(worn, tmp_path, capsys, old, new, complaint):
    shutil.copytree(worn / DOORS[0], tmp_path / "door")
    text = (tmp_path / "door" / "points.csv").read_text()
    assert old in text
    (tmp_path / "door" / "points.csv").write_text(text.replace(old, new, 1))
    code, out, err = run(capsys, "--inspections", tmp_path / "door", "--out", tmp_path / "out")
    assert (code, out) == (2, "")
    assert "points.csv: line " in err
    assert complaint in err
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("unit", [1e3, 1e6], ids=["mm", "um"])
def test_deviations_in_another_unit_are_told(worn, tmp_path, capsys, unit):
    shutil.copytree(worn / DOORS[0], tmp_path / "door")
    file = tmp_path / "door" / "points.csv"
    head, *rows = file.read_text().splitlines()
    cells = [row.rsplit(",", 1) for row in rows]
    rows = [f"{before},{unit * float(deviation):.9f}" for before, deviation in cells]
    file.write_text("\n".join([head, *rows]) + "\n")
    code, out, err = run(capsys, "--inspections", tmp_path / "door", "--out", tmp_path / "out")
    assert (code, out) == (2, "")
    assert "column deviation: is " in err
    assert "look whether the file is in metres" in err
    assert err.count("\n") == 1


def test_an_empty_folder_is_told(tmp_path, capsys):
    code, _, err = run(capsys, "--inspections", tmp_path, "--out", tmp_path / "out")
    assert code == 2
    assert "inspection.yaml: line 1, column 1: cannot be opened" in err


def test_the_page_describes_the_files_as_they_are_read(worn, tmp_path, capsys):
    page = (ROOT / "docs" / "inspection.md").read_text(encoding="utf-8")
    description = page.split("```yaml\n")[1].split("```")[0]
    shutil.copytree(worn / DOORS[0], tmp_path / "door")
    identifier = run_id(tmp_path / "door" / "bag")
    description = description.replace("20261122T002931290381Z", identifier).replace("../bag", "bag")
    (tmp_path / "door" / "inspection.yaml").write_text(description)
    inspection = read_inspection(tmp_path / "door")
    assert (inspection.run_id, inspection.noise, inspection.datum) == (identifier, 1e-5, "camera")
    assert len(inspection) > 100
    columns = ", ".join(COLUMNS).replace("feature, surface, ", "").replace(", deviation", "")
    assert columns == "x, y, z, nx, ny, nz"
    for cell in ("feature", "surface", "x, y, z", "nx, ny, nz", "deviation"):
        assert f"\n| {cell} |" in page, cell


def test_a_model_in_use_is_asked_about_with_inspections_only(tmp_path, capsys):
    with pytest.raises(SystemExit) as ended:
        run(capsys, "--data", tmp_path, "--in-use", "springs", "--out", tmp_path / "out")
    assert ended.value.code == 2
    assert "--in-use was given without --inspections" in capsys.readouterr().err


def test_a_spring_that_stiffens_with_its_load_is_told_from_a_soft_one(tmp_path, capsys):
    hidden = {"stiffness": 1.2e6, "hardening": 1.5e-3}
    effect, rng = (
        {"cause": "joint_hardening", "where": "joint 1", "parameters": hidden},
        np.random.default_rng(1),
    )
    for name in (*DOORS, "standard_door"):
        measured(tmp_path / name, name, [effect], rng)
    code, _, err = run(capsys, "--inspections", tmp_path, "--out", tmp_path / "out")
    assert (code, err) == (0, "")
    document = json.loads((tmp_path / "out" / "diagnosis.json").read_text())
    [cause] = document["causes"]
    assert (document["verdict"], cause["cause"], cause["where"]) == (
        "explained",
        "joint_hardening",
        "joint 1",
    )
    # What counts is how far it gives way under the torques that the doors had.
    told = {name: one["value"] for name, one in cause["parameters"].items()}
    for torque in (25.0, 200.0, 400.0):
        give, known = (torque / (k["stiffness"] * (1.0 + k["hardening"] * torque)) for k in (told, hidden))
        assert give == pytest.approx(known, rel=0.1)
    model = load_compliance_model(tmp_path / "out" / "model.yaml")
    assert [sized.cause.name for sized in model.causes] == ["joint_hardening"]
