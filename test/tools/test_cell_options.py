"""What the command line of `cell` refuses of a shift before any node starts."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from doormill_ros.cell.output.shift_summary import ShiftSummary
from doormill_ros.cell.output.summary import FeatureError, RunSummary
from doormill_ros.recipes.documents import shipped_recipes
from doormill_ros.simulation.sensors.registry import SIMULATED_SENSORS
from doormill_ros.tools.cell import main
from doormill_ros.tools.cell_options import parse


@pytest.mark.parametrize(
    ("more", "complaint"),
    [
        (["--doors", "0"], "--doors is 0, allowed is a positive whole number"),
        (["--doors", "2", "--ui"], "--ui shows one door"),
        (["--robots", "2", "--doors", "2"], "--robots 2 mills one door"),
        (["--world", "w.yaml", "--effects", "e.yaml"], "--effects and --world both say what the robot hides"),
    ],
)
def test_options_that_exclude_each_other_are_refused(
    more: list[str], complaint: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as stop:
        parse(["--door", "a", *more])
    assert stop.value.code == 2
    assert complaint in capsys.readouterr().err


def test_a_sensor_of_the_registry_is_in_the_help_and_is_taken(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setitem(SIMULATED_SENSORS, "ultrasound", SIMULATED_SENSORS["touch_probe"])
    assert parse(["--door", "a", "--sensor", "ultrasound"]).sensor == ["ultrasound"]
    with pytest.raises(SystemExit):
        parse(["--door", "a", "--sensor", "sonar"])
    assert "touch_probe, ultrasound, each once" in capsys.readouterr().err
    with pytest.raises(SystemExit):
        parse(["--help"])
    help_page = " ".join(capsys.readouterr().out.split())
    assert "names: camera, axis_vision, photoelectric, touch_probe or ultrasound; several" in help_page


def test_help_answers_without_numpy() -> None:
    tell = (
        "import sys; from doormill_ros.tools import cell, cell_options; cell_options._parser().format_help(); "
        "print('numpy' in sys.modules)"
    )
    told = subprocess.run([sys.executable, "-c", tell], check=True, capture_output=True, text=True)
    assert told.stdout == "False\n"


def test_two_robots_have_the_page_too() -> None:
    options = parse(["--door", "a", "--robots", "2", "--ui", "0", "--control"])
    assert (options.robots, options.ui, options.control) == (2, 0, True)


def test_a_shift_has_as_many_doors_as_named_unless_told() -> None:
    assert parse(["--door", "a"]).doors is None
    assert parse(["--door", "a", "--door", "b"]).doors == 2
    assert parse(["--door", "a", "--world", "w.yaml"]).doors == 1
    assert parse(["--door", "a", "--door", "b", "--doors", "5"]).doors == 5


def test_a_world_file_of_no_use_is_told_in_one_line_before_anything_is_made(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    world, out = tmp_path / "world.yaml", tmp_path / "out"
    world.write_text("schema: doormill/world/1\nrobots: {}\n", encoding="utf-8")
    assert main(["--door", "thesis_190_0deg", "--world", str(world), "--out", str(out)]) == 2
    said = capsys.readouterr().err
    assert said.startswith(f"cell: {world}: robots is unknown, allowed are robot, tool, links")
    assert said.count("\n") == 1
    assert not out.exists()


@pytest.mark.parametrize("place", ["file", "file/below"])
def test_a_file_in_the_way_of_a_run_is_told_in_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], place: str
) -> None:
    (tmp_path / "file").write_text("mine", encoding="utf-8")
    out = tmp_path / place
    assert main(["--door", "thesis_190_0deg", "--out", str(out)]) == 2
    said = capsys.readouterr().err
    assert said.startswith(f"cell: folder {out} cannot be made anew: {tmp_path / 'file'}")
    assert said.count("\n") == 1
    assert (tmp_path / "file").read_text(encoding="utf-8") == "mine"


def test_a_file_in_the_way_of_a_shift_is_told_in_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "file").write_text("mine", encoding="utf-8")
    assert main(["--door", "thesis_190_0deg", "--doors", "2", "--out", str(tmp_path / "file")]) == 2
    said = capsys.readouterr().err
    assert "cannot be made anew" in said
    assert said.count("\n") == 1


def test_the_table_of_a_shift_has_a_line_a_door() -> None:
    shift = ShiftSummary()
    shift.add(0, "door_000", RunSummary("a", True, "", run_id="r0", feature_error=FeatureError(0.0, 2.1e-4)))
    shift.add(1, "door_001", RunSummary("long_name", False, "no picture", run_id="r1"))
    assert shift.table().splitlines() == [
        "door  recipe     run  success  largest deviation",
        "0     a          r0   yes      0.210 mm",
        "1     long_name  r1   no       -",
    ]
    assert not shift.success


def test_doors_that_nobody_names_are_those_that_ship_in_turn(capsys: pytest.CaptureFixture[str]) -> None:
    assert parse(["--doors", "3"]).door == sorted(shipped_recipes())
    assert parse(["--doors", "3", "--world", "w.yaml"]).doors == 3
    with pytest.raises(SystemExit) as stop:
        parse(["--world", "w.yaml"])
    assert stop.value.code == 2
    assert "required: --door (with --doors N: the shipped recipes in turn)" in capsys.readouterr().err
