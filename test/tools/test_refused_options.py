"""An option that would be ignored is refused in one line."""

from __future__ import annotations

from pathlib import Path

import pytest

from doormill_ros.diagnosis.core import kind
from doormill_ros.tools import calibrate, cell, diagnose, health, report

DOOR = "thesis_190_0deg"
ROOT = Path(__file__).parents[2]


def test_diagnose_checks_nothing_with_the_thesis(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "out"
    with pytest.raises(SystemExit) as stop:
        diagnose.main(["--thesis", "--check", "DIR", "--out", str(out)])
    assert stop.value.code == 2
    assert capsys.readouterr().err == (
        "diagnose: --check was given with --thesis, allowed is --check with --data, --pictures, --inspections, --runs; "
        "leave one out\n"
    )
    assert not out.exists()


@pytest.mark.parametrize("count", [1, 2, 4])
def test_a_lens_has_three_coefficients(count: int, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as stop:
        calibrate.main(["lens", *["0.1"] * count])
    assert stop.value.code == 2
    assert capsys.readouterr().err == (
        f"calibration: {count} coefficients were given, allowed are three (k1 k2 k3) or none "
        "for those of the camera file\n"
    )


def test_results_that_cannot_be_written_are_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "file").touch()
    out = tmp_path / "file" / "out"
    # What it does last of all, without the minute before.
    monkeypatch.setattr(kind, "run", lambda *_: out.mkdir())
    data = ROOT / "docs" / "diagnosis_example"
    assert diagnose.main(["--quiet", "--data", str(data), "--out", str(out)]) == 2
    assert capsys.readouterr().err == f"diagnose: {out} cannot be used, Not a directory; name another --out\n"
    assert report.main([str(ROOT / "bags" / "thesis_190_0deg"), "--out", str(out)]) == 2
    told = capsys.readouterr().err.splitlines()[-1]
    assert told == f"report: {out} cannot be written, Not a directory; name another with --out"


def test_a_namespace_is_one_that_ros_takes(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as stop:
        health.main(["--namespace", "a b"])
    assert stop.value.code == 2
    assert "found 'a b', allowed are slashes with names" in capsys.readouterr().err


def test_a_door_is_turned_by_a_number(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ["--door", "thesis_190_0deg", "--offset", "0", "0", "nan", "--out", str(tmp_path / "run")]
    assert cell.main(arguments) == 2
    told = capsys.readouterr().err.splitlines()[-1]
    assert told.startswith("cell: parameter offset_rotation of /camera_simulator is nan, allowed is a float")


@pytest.mark.parametrize("doors", [[], ["--doors", "2"]], ids=["door", "shift"])
@pytest.mark.parametrize(
    ("more", "complaint"),
    [
        (["--door", DOOR, "--offset", "1", "nan", "0"], "parameter offset_z of /camera_simulator is nan"),
        (["--door", DOOR, "--seed", "-1"], "is -1, allowed is an int from 0 to 2147483647"),
        (["--door", DOOR, "--seed", f"{2**80}"], f"parameter seed of /camera_simulator is {2**80}"),
        (["--door", DOOR, "--robot-model", "/no/model.yaml"], "/no/model.yaml"),
        (["--door", DOOR, "--namespace", "/a" * 200], "should not exceed"),
    ],
    ids=["offset", "seed", "long seed", "model", "namespace"],
)
def test_a_run_that_is_refused_touches_nothing(
    more: list[str], complaint: str, doors: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    earlier, new = tmp_path / "earlier", tmp_path / "new"
    for file in ("bag/bag_0.mcap", "door_000/bag/bag_0.mcap"):
        (earlier / file).parent.mkdir(parents=True)
        (earlier / file).touch()
    for out in (earlier, new):
        assert cell.main([*more, *doors, "--out", str(out)]) == 2
        (told,) = capsys.readouterr().err.splitlines()
        assert told.startswith("cell: ")
        assert complaint in told
    assert sorted(str(file.relative_to(earlier)) for file in earlier.rglob("*.mcap")) == [
        "bag/bag_0.mcap",
        "door_000/bag/bag_0.mcap",
    ]
    assert not new.exists()


def test_a_page_on_a_port_that_is_none_makes_nothing(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert cell.main(["--door", DOOR, "--ui", "99999", "--control", "--out", str(tmp_path / "run")]) == 2
    out, err = capsys.readouterr()
    assert "parameter port of /operator_page is 99999, allowed is an int from 0 to 65535" in err
    assert not out  # no token for a page that never was
    assert not (tmp_path / "run").exists()


def test_a_domain_that_is_none_is_told_before_anything_is_touched(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ROS_DOMAIN_ID", "abc")
    assert cell.main(["--door", DOOR, "--out", str(tmp_path / "run")]) == 2
    assert "ROS_DOMAIN_ID is not an integral number" in capsys.readouterr().err
    assert not (tmp_path / "run").exists()


@pytest.mark.parametrize("option", ["--robot-model", "--effects"])
def test_a_file_that_its_node_could_not_use_is_refused_before_anything_starts(
    option: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file, out = tmp_path / "file.yaml", tmp_path / "out"
    file.write_bytes(bytes(range(256)))
    assert cell.main(["--door", "thesis_190_0deg", option, str(file), "--out", str(out)]) == 2
    (told,) = capsys.readouterr().err.splitlines()
    assert told.startswith("cell: ")
    assert str(file) in told
    assert not out.exists()
