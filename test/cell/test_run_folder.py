"""What a new run or shift removes of an earlier one, and what it refuses to remove."""

from __future__ import annotations

from pathlib import Path

import pytest

from doormill_ros.cell.errors import BadParameterError
from doormill_ros.cell.output.gauged import note_gauged
from doormill_ros.cell.output.run_folder import RunFolder, ShiftFolder

GAUGED = "schema: doormill/inspection/1\nrun_id: r0\nbag: beside\nnoise: 1.0e-05\ndatum: camera\n"
#: As a gauge in a workshop may have it; the words of the last one are the simulated one's.
MEASURED = GAUGED.replace("1.0e-05", "5.0e-06"), GAUGED.replace("r0", "r1")
POINTS = "feature,surface\n"


def write(folder: Path, **texts: str) -> None:
    """Files by their names, with _ for the dot."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in texts.items():
        (folder / ".".join(name.rsplit("_", 1))).write_text(text, encoding="utf-8")


def milled(root: Path) -> None:
    """What a run leaves."""
    write(root / "bag", metadata_yaml="", bag_0_mcap="")
    (root / "targets").mkdir()
    (root / "targets" / "20261130T052908989736Z.txt").touch()
    write(
        root,
        parameters_yaml="/**/bag_recorder: {}",
        summary_json='{"schema": "doormill/run/1"}',
        report_html="",
    )


def gauged(root: Path, folder: Path, description: str = GAUGED) -> None:
    """What the simulated gauge leaves."""
    note_gauged(root / "controller", GAUGED, POINTS)
    write(folder, inspection_yaml=description, points_csv=POINTS)


def milled_alone(root: Path) -> RunFolder:
    """What a run by itself leaves, whose page has questioned doors."""
    milled(root)
    write(root / "controller" / "HOME", Hei2_old="")
    gauged(root, root / "inspections" / "doors" / "r0", GAUGED.replace("beside", "elsewhere"))
    write(root / "models", models_json="{}")
    return RunFolder(root)


def shift_of(root: Path, doors: int) -> ShiftFolder:
    """What a shift leaves, and `diagnose` beside it."""
    paths = ShiftFolder(root)
    for number in range(doors):
        run = paths.run(number)
        milled(run.root)
        gauged(root, run.inspection)
    write(paths.controller, Hei2_old="")
    write(root, shift_json='{"schema": "doormill/shift/1"}')
    write(
        root / "diagnosis", diagnosis_json='{"schema": "doormill/diagnosis/1"}', report_html="", model_yaml=""
    )
    return paths


def content(root: Path) -> dict[str, str]:
    """Every file with its text."""
    return {
        str(path.relative_to(root)): path.read_text(encoding="utf-8")
        for path in root.rglob("*")
        if path.is_file()
    }


def test_a_new_run_leaves_nothing_of_the_one_before_but_its_models(tmp_path: Path) -> None:
    run = milled_alone(tmp_path)
    write(tmp_path, notes_txt="mine")
    run.prepare()
    assert sorted(content(tmp_path)) == ["models/models.json", "notes.txt"]
    assert run.controller.is_dir()
    run.prepare()  # what was prepared and never begun is in nobody's way


@pytest.mark.parametrize("place", ["bag/notes.txt", "targets/plan.txt", "inspection/photo.png"])
@pytest.mark.parametrize("ran", [True, False])
def test_a_file_of_somebody_else_is_not_removed_by_a_run(tmp_path: Path, place: str, ran: bool) -> None:
    if ran:
        milled_alone(tmp_path)
    (tmp_path / place).parent.mkdir(exist_ok=True)
    (tmp_path / place).write_text("mine", encoding="utf-8")
    before = content(tmp_path)
    with pytest.raises(
        BadParameterError, match=f"{place}, which no run of the cell has left there; name another"
    ):
        RunFolder(tmp_path).prepare()
    assert content(tmp_path) == before


@pytest.mark.parametrize(
    "place", ["bag/bag_0.mcap", "controller/HOME/Own.mod", "summary.json", "report.html"]
)
def test_without_a_run_nothing_is_taken_for_its_own(tmp_path: Path, place: str) -> None:
    (tmp_path / place).parent.mkdir(parents=True, exist_ok=True)
    (tmp_path / place).write_text("mine", encoding="utf-8")
    with pytest.raises(BadParameterError, match="which no run of the cell has left there"):
        RunFolder(tmp_path).prepare()
    assert content(tmp_path) == {place: "mine"}


@pytest.mark.parametrize("place", ["inspection", "inspections/doors/r1", "inspections/waiting/r1"])
@pytest.mark.parametrize("measured", MEASURED)
def test_an_inspection_that_somebody_measured_is_not_removed(
    tmp_path: Path, place: str, measured: str
) -> None:
    run = milled_alone(tmp_path)
    write(tmp_path / place, inspection_yaml=measured, points_csv=POINTS)
    before = content(tmp_path)
    with pytest.raises(BadParameterError, match="holds an inspection that somebody measured"):
        run.prepare()
    assert content(tmp_path) == before


@pytest.mark.parametrize("bad", ["no table", "not UTF-8"])
def test_an_inspection_that_cannot_be_read_is_taken_for_somebodys(tmp_path: Path, bad: str) -> None:
    run = milled_alone(tmp_path)
    place = tmp_path / "inspections" / "doors" / "r2"
    write(place, inspection_yaml=GAUGED, **({} if bad == "no table" else {"points_csv": POINTS}))
    if bad == "not UTF-8":
        (place / "inspection.yaml").write_bytes(GAUGED.encode("utf-8") + b"# \xe9\n")
    with pytest.raises(BadParameterError, match="holds an inspection that somebody measured"):
        run.prepare()
    assert (place / "inspection.yaml").is_file()


def test_a_new_shift_leaves_nothing_of_the_one_before(tmp_path: Path) -> None:
    paths = shift_of(tmp_path, 3)
    for kept in ("door_plans", "notes"):
        write(tmp_path / kept, own_txt="mine")
    paths.prepare(3)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["controller", "door_plans", "notes"]
    assert content(tmp_path) == {"door_plans/own.txt": "mine", "notes/own.txt": "mine"}


def test_a_shift_of_fewer_doors_does_not_remove_inspected_ones(tmp_path: Path) -> None:
    paths = shift_of(tmp_path, 3)
    before = content(tmp_path)
    with pytest.raises(
        BadParameterError, match="that a shift of 1 would remove and not mill anew, door_001, door_002;"
    ):
        paths.prepare(1)
    assert content(tmp_path) == before


@pytest.mark.parametrize(
    "place",
    ["door_000/notes.txt", "door_001/bag/notes.txt", "diagnosis/notes.txt", "controller", "parameters.yaml"],
)
def test_a_file_of_somebody_else_is_not_removed_by_a_shift(tmp_path: Path, place: str) -> None:
    paths = ShiftFolder(tmp_path) if place in ("controller", "parameters.yaml") else shift_of(tmp_path, 2)
    (tmp_path / place).write_text("mine", encoding="utf-8")
    before = content(tmp_path)
    with pytest.raises(BadParameterError, match=f"{place}, which no run of the cell has left there"):
        paths.prepare(2)
    assert content(tmp_path) == before


@pytest.mark.parametrize("texts", [*({"inspection_yaml": text} for text in MEASURED), {"points_csv": "5\n"}])
def test_what_somebody_measured_on_a_door_of_a_shift_stays(tmp_path: Path, texts: dict[str, str]) -> None:
    paths = shift_of(tmp_path, 2)
    write(paths.run(1).inspection, **texts)
    with pytest.raises(
        BadParameterError, match=r"door_001/inspection/inspection\.yaml, and a new run would remove it"
    ):
        paths.prepare(2)
    assert paths.run(0).bag.is_dir()


def test_inspections_of_a_shift_without_notes_of_its_gauge_stay(tmp_path: Path) -> None:
    paths = shift_of(tmp_path, 2)
    (tmp_path / "controller" / "gauged.txt").unlink()
    before = content(tmp_path)
    with pytest.raises(BadParameterError, match="the simulated gauge has not noted it as its own"):
        paths.prepare(2)
    assert content(tmp_path) == before


def test_a_run_and_a_shift_do_not_take_each_others_place(tmp_path: Path) -> None:
    shift_of(tmp_path / "shift", 1)
    milled_alone(tmp_path / "run")
    with pytest.raises(BadParameterError, match="holds a shift of doors"):
        RunFolder(tmp_path / "shift").prepare()
    with pytest.raises(BadParameterError, match="holds a run by itself"):
        ShiftFolder(tmp_path / "run").prepare(1)
