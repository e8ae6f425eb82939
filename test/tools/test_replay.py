"""The command `replay`: what it says and how it ends."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import yaml

from bags.timeline import load_timeline
from doormill_ros.abb.target_file import line as target_line
from doormill_ros.correction import compensate
from doormill_ros.localization.search import neighbourhood
from doormill_ros.recording.accepted import accept_bag, accepted_bags
from doormill_ros.recording.bag_reader import read_bag
from doormill_ros.recording.replay import offline
from doormill_ros.robot.description import load_robot
from doormill_ros.robot_model.extended_document import model_document
from doormill_ros.tools.replay import main
from support.run_bags import BEGUN_NS, DAY_NS, DrawnRun, write_run_bag
from support.source_tree import ROOT

BAGS = ROOT / "bags"
_, SCENARIOS = load_timeline(BAGS / "timeline.yaml")
BAG = BAGS / "thesis_190_0deg"


@pytest.fixture
def bag(tmp_path: Path) -> Path:
    return Path(shutil.copytree(BAG, tmp_path / "bag"))


def replay(capsys: pytest.CaptureFixture[str], *arguments: str | Path) -> tuple[int, list[str]]:
    status = main([str(a) for a in arguments])
    return status, capsys.readouterr().out.splitlines()


def test_there_is_a_bag_for_each_door_refusal_and_fault() -> None:
    ends = [(s.door, s.success, s.error_codes[0]) for s in SCENARIOS]
    assert len(ends) >= 12
    assert {d for d, success, _ in ends if success} == {
        "thesis_190_0deg", "thesis_190_2deg", "thesis_1350_0deg", "thesis_1350_2deg", "standard_door"
    }  # fmt: skip
    assert {code for _, success, code in ends if not success} == {140, 204, 300, 400, 801}
    assert sum(p.stat().st_size for p in BAGS.rglob("*") if p.is_file()) < 10e6


def test_an_equal_bag_ends_with_0(capsys: pytest.CaptureFixture[str]) -> None:
    status, lines = replay(capsys, BAG)
    assert status == 0
    assert len(lines) == 1
    assert (
        "equal: 1 of /door/localization, 1 of /path/targets, 1 of /abb/target_file, 1 of /run/result"
        in lines[0]
    )


@pytest.mark.parametrize(
    ("scenario", "compared"), [("no_picture", "nothing compared"), ("spindle_fault", "equal: 1 of")]
)
def test_what_is_not_compared_is_told_and_not_counted(
    scenario: str, compared: str, capsys: pytest.CaptureFixture[str]
) -> None:
    status, lines = replay(capsys, BAGS / scenario)
    assert status == 0
    assert compared in lines[0]
    assert "/run/result" not in lines[0]
    assert "not compared: /run/result" in lines[1]
    assert "--live" in lines[1]


def cut_in_half(bag: Path) -> None:
    (file,) = bag.glob("*.mcap")
    os.truncate(file, file.stat().st_size // 2)


@pytest.mark.parametrize("options", [(), ("--accept",), ("--update",), ("--live", "--rate", "max")])
def test_half_a_bag_is_neither_compared_nor_kept(
    bag: Path,
    options: tuple[str, ...],
    capsys: pytest.CaptureFixture[str],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv("DOORMILL_SITE", str(tmp_path / "site"))
    cut_in_half(bag)
    held = sum(1 for _ in read_bag(bag))
    assert held > 0
    listed = yaml.safe_load((bag / "metadata.yaml").read_text())["rosbag2_bagfile_information"][
        "message_count"
    ]
    assert main([*options, str(bag)]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert f"holds {held} of the {listed} messages" in err
    assert "is not used; copy it again" in err
    assert not (bag / "expected.yaml").exists()
    assert not (tmp_path / "site").exists()


@pytest.mark.parametrize("option", ["", "--accept"])
def test_a_run_without_an_end_is_not_compared(
    option: str, capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("DOORMILL_SITE", str(tmp_path / "site"))
    runs = [
        DrawnRun("run_0", offsets=(), correction=None),
        DrawnRun("run_1", offsets=(), correction=None, begun_ns=BEGUN_NS + DAY_NS, success=None),
    ]
    bag = write_run_bag(tmp_path / "bag", runs)
    status, lines = replay(capsys, bag, *filter(None, [option]))
    assert status == 2
    assert lines[0].endswith("1 run, equal: 1 of /run/result")
    assert "not compared: run run_1 has no run/result" in lines[1]
    assert len(lines) == 2
    assert not (tmp_path / "site").exists()


def test_a_run_without_an_end_becomes_no_expectation(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    bag = write_run_bag(tmp_path / "bag", [DrawnRun("run_0", offsets=(), correction=None, success=None)])
    assert main(["--update", str(bag)]) == 2
    assert "run run_0 has no run/result" in capsys.readouterr().err
    assert not (bag / "expected.yaml").exists()


def test_what_was_not_compared_stays_in_the_expectation(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    bag = Path(shutil.copytree(BAGS / "no_picture", tmp_path / "bag"))
    assert replay(capsys, bag, "--update")[0] == 0
    (answers,) = yaml.safe_load((bag / "expected.yaml").read_text())["runs"].values()
    assert [(a["topic"], a["values"]["error_code"]) for a in answers] == [("/run/result", 801)]


def shorter_reach(patch: pytest.MonkeyPatch) -> None:
    patch.setattr(neighbourhood, "_PLAIN_REACH", 1.2)


def shorter_correction(patch: pytest.MonkeyPatch) -> None:
    patch.setattr(compensate, "MAX_ITERATIONS", 1)


def fewer_decimals(patch: pytest.MonkeyPatch) -> None:
    patch.setattr(target_line, "DECIMALS", ((3, 6),))


CHANGES = [
    (shorter_reach, "/door/localization", "the localizer"),
    (shorter_correction, "/path/targets", "path and correction"),
    (fewer_decimals, "/abb/target_file", "the RAPID writer"),
]


@pytest.mark.parametrize(("change", "topic", "maker"), CHANGES)
def test_one_changed_constant_is_found_and_named(
    change: Callable[[pytest.MonkeyPatch], None],
    topic: str,
    maker: str,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    change(monkeypatch)
    status, lines = replay(capsys, BAG)
    assert status == 1
    assert f": {topic} of 20" in lines[0], lines
    assert maker in lines[0]
    assert "expected" in lines[0]
    assert "found" in lines[0]


def test_update_writes_today_s_answers_and_says_what_changed(
    bag: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    with monkeypatch.context() as patch:
        fewer_decimals(patch)
        status, lines = replay(capsys, bag, "--update")
        assert status == 0
        assert "line 1: expected" in lines[0]
        assert "fields changed" in lines[-1]
        document = yaml.safe_load((bag / "expected.yaml").read_text())
        assert [len(answers) for answers in document["runs"].values()] == [4]
        assert replay(capsys, bag)[0] == 0
    status, lines = replay(capsys, bag)
    assert status == 1
    assert "/abb/target_file" in lines[0]
    assert replay(capsys, bag, "--update")[0] == 0
    status, lines = replay(capsys, bag, "--update")
    assert "0 fields changed" in lines[0]


def test_all_tells_every_difference(
    bag: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    fewer_decimals(monkeypatch)
    _, first = replay(capsys, bag)
    _, every = replay(capsys, bag, "--all")
    assert len(first) == 2
    assert "more fields differ" in first[1]
    assert len(every) > 10
    assert every[0] == first[0]


def test_several_bags_end_with_the_worst(
    bag: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main([str(bag), str(tmp_path / "nowhere")]) == 2
    captured = capsys.readouterr()
    assert "equal" in captured.out
    assert "nowhere" in captured.err


@pytest.mark.parametrize(
    "content", ["", "schema: other", "runs: 3", "schema: doormill/expected/1\nruns: [1]"]
)
def test_an_expectation_of_another_form_is_refused(
    bag: Path, content: str, capsys: pytest.CaptureFixture[str]
) -> None:
    (bag / "expected.yaml").write_text(content)
    assert main([str(bag)]) == 2
    assert "replay --update" in capsys.readouterr().err


def test_a_refusal_with_another_reason_is_a_difference(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    layout, camera = offline._cell()
    shifted = camera.with_intrinsics(camera.k, camera.distortion, camera.size)
    object.__setattr__(shifted, "position", camera.position + np.array([0.0, 0.0005, 0.0]))
    monkeypatch.setattr(offline, "_cell", lambda: (layout, shifted))
    status, lines = replay(capsys, BAGS / "outside_y")
    assert status == 1
    assert "reason: expected" in lines[0]
    assert "+13.00 mm" in lines[0]


def test_a_model_of_another_diagnosis_is_a_difference(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    robot = load_robot("irb6600_175_255")
    model = tmp_path / "model.yaml"
    model.write_text(yaml.safe_dump(model_document(robot.name, robot.stiffness, [], "test")))
    status, lines = replay(capsys, BAG, "--robot-model", str(model))
    assert status == 1
    assert "/path/targets" in lines[0]
    assert "robot_model" in lines[0]


@pytest.mark.parametrize("model", ["irb6700_235_265", "/no/model.yaml"], ids=["another robot", "absent"])
@pytest.mark.parametrize("more", [[], ["--live"], ["--many"]], ids=["offline", "live", "many"])
def test_what_is_no_model_is_refused_and_no_difference(
    model: str, more: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    assert main([str(BAG), *more, "--robot-model", model]) == 2
    out, err = capsys.readouterr()
    (told,) = err.splitlines()
    assert not out
    assert told.startswith("replay: ")
    assert model in told


def test_an_accepted_bag_is_the_site_s_and_replayed_from_then_on(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("DOORMILL_SITE", str(tmp_path / "site"))
    assert main([]) == 2
    assert "replay --accept BAG" in capsys.readouterr().err
    status, lines = replay(capsys, "--accept", BAG)
    (kept,) = (tmp_path / "site" / "accepted").iterdir()
    assert (status, lines[-1]) == (0, f"{BAG}: accepted as {kept}")
    assert {p.name: p.read_bytes() for p in kept.iterdir()} == {p.name: p.read_bytes() for p in BAG.iterdir()}
    status, lines = replay(capsys)
    assert (status, len(lines)) == (0, 1)
    assert lines[0].startswith(f"{kept}: 1 run, equal")
    with monkeypatch.context() as patch:
        fewer_decimals(patch)
        assert replay(capsys)[0] == 1
    assert main(["--accept", str(BAG)]) == 2
    assert "is accepted already" in capsys.readouterr().err


def test_what_differs_is_not_accepted(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("DOORMILL_SITE", str(tmp_path / "site"))
    fewer_decimals(monkeypatch)
    assert replay(capsys, "--accept", BAG)[0] == 1
    assert not (tmp_path / "site").exists()


def test_what_was_not_compared_is_not_accepted(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("DOORMILL_SITE", str(tmp_path / "site"))
    assert main(["--accept", str(BAGS / "no_picture")]) == 2
    assert "is not accepted: nothing of it can be compared" in capsys.readouterr().err
    assert not (tmp_path / "site").exists()


def test_a_run_id_leads_no_copy_out_of_the_accepted(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """It comes from a bag that somebody else may have made."""
    monkeypatch.setenv("DOORMILL_SITE", str(tmp_path / "site"))
    for run_id in ("/".join(("..", "..", "evil")), "/evil", "", ".hidden"):
        assert accept_bag(BAG, run_id).parent == tmp_path / "site" / "accepted"
    assert len(accepted_bags()) == 4


@pytest.mark.parametrize(
    "options", [["--accept"], ["--accept", "--update", "b"], ["--accept", "--many", "b"]]
)
def test_what_accept_does_not_go_with_is_said(options: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(options)
    assert "--accept" in capsys.readouterr().err.splitlines()[-1]


def test_rates_are_positive(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main([str(BAG), "--live", "--rate", "0"])
    assert "allowed are numbers above 0 and 'max'" in capsys.readouterr().err


def test_a_rate_without_live_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as stop:
        main([str(BAG), "--rate", "2"])
    assert stop.value.code == 2
    assert "--rate belongs to --live: add it" in capsys.readouterr().err


def test_a_database_that_is_not_there_is_not_made(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    missing = tmp_path / "new" / "recipes.sqlite"
    assert main(["--database", str(missing), str(BAGS / "unknown_door")]) == 2
    out, err = capsys.readouterr()
    assert (out, err) == ("", f"replay: there is no database {missing}; correct its name\n")
    assert not missing.parent.exists()
