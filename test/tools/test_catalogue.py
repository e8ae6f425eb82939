"""The command `catalogue`: what it says and how it ends."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import duckdb
import pytest

from doormill_ros.cell.errors import OutOfToleranceError
from doormill_ros.tools.catalogue import main
from support.run_bags import BEGUN_NS, DAY_NS, DrawnRun, write_inspection_note, write_run_bag

Run = Callable[..., tuple[int, list[str], str]]


@pytest.fixture
def catalogue(capsys: pytest.CaptureFixture[str]) -> Run:
    def run(*arguments: object) -> tuple[int, list[str], str]:
        status = main([str(argument) for argument in arguments])
        out, err = capsys.readouterr()
        return status, out.splitlines(), err

    return run


@pytest.fixture
def bags(tmp_path: Path) -> Path:
    folder = tmp_path / "bags"
    for day in range(3):
        ended = {"success": day != 1, "error_code": 407 if day == 1 else 0, "deviation": 1e-4 * day}
        run = DrawnRun(f"run_{day}", f"door_{day}", BEGUN_NS + day * DAY_NS, **ended)  # type: ignore[arg-type]
        write_run_bag(folder / str(day) / "bag", [run])
    write_inspection_note(folder / "2" / "inspection", "run_2")
    return folder


def test_runs_are_rebuilt_listed_and_exported(catalogue: Run, bags: Path, tmp_path: Path) -> None:
    status, out, err = catalogue("rebuild", bags)
    assert (status, err) == (0, "")
    assert out[0].startswith("3 runs are in the catalogue")
    _, (head, *lines), _ = catalogue("list")
    cells = [dict(zip(head.split("\t"), line.split("\t"), strict=True)) for line in lines]
    assert [cell["run"] for cell in cells] == ["run_0", "run_1", "run_2"]
    assert [cell["outcome"] for cell in cells] == ["milled", "refused (407)", "milled"]
    assert [cell["deviation_mm"] for cell in cells] == ["0.000", "0.100", "0.200"]
    assert cells[2]["inspection"] == str(bags / "2" / "inspection")
    assert cells[0]["begun"] == "2026-11-18T11:06:40Z"
    assert [line.split("\t")[0] for line in catalogue("list", "--failed")[1]] == ["run", "run_1"]
    since = catalogue(
        "list", "--since", "2026-11-19", "--until", "2026-11-20T10:40:00+00:00", "--door", "door_1"
    )
    assert [line.split("\t")[0] for line in since[1]] == ["run", "run_1"]
    file = tmp_path / "runs.parquet"
    assert catalogue("export", "--parquet", file)[1] == [f"wrote 3 runs to {file}"]
    assert duckdb.sql(f"SELECT sum(deviation) FROM '{file}'").fetchall() == [(pytest.approx(3e-4),)]


def test_a_door_out_of_tolerance_was_milled(catalogue: Run, tmp_path: Path) -> None:
    ended = {"success": False, "error_code": OutOfToleranceError.code, "deviation": 7e-4}
    run = DrawnRun("run_0", "door_0", BEGUN_NS, **ended)  # type: ignore[arg-type]
    write_run_bag(tmp_path / "bags" / "0" / "bag", [run])
    catalogue("rebuild", tmp_path / "bags")
    _, (head, line), _ = catalogue("list")
    assert dict(zip(head.split("\t"), line.split("\t"), strict=True))["outcome"] == "milled, out of tolerance"


def test_what_is_refused_is_named_and_the_rest_is_there(catalogue: Run, bags: Path) -> None:
    next((bags / "1" / "bag").glob("*.mcap")).write_bytes(b"no bag")
    status, out, err = catalogue("rebuild", bags)
    assert status == 1
    assert out[0].startswith("2 runs are in the catalogue")
    assert str(bags / "1" / "bag") in err
    assert len(catalogue("list")[1]) == 3


def test_retention_says_what_it_would_do_and_does_it(catalogue: Run, bags: Path) -> None:
    catalogue("rebuild", bags)
    catalogue("keep", "run_1", "--reason", "customer asks")
    said = catalogue("retain", "--gigabytes", 0, "--dry-run")[1]
    assert [line.split("\t")[0] for line in said[:3]] == ["would go", "stays", "stays"]
    assert said[1].endswith("kept: customer asks")
    assert said[2].endswith("inspection needs it")
    assert said[3].startswith("1 bags with ")
    assert (bags / "0" / "bag").is_dir()
    done = catalogue("retain", "--gigabytes", 0)[1]
    assert [line.split("\t")[0] for line in done[:3]] == ["went", "stays", "stays"]
    assert not (bags / "0" / "bag").exists()
    catalogue("keep", "run_1", "--release")
    assert catalogue("retain", "--gigabytes", 0)[1][0].startswith(f"went\t{bags / '1' / 'bag'}")
    assert len(catalogue("list")[1]) == 4


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["retain"], "found no limit, allowed are numbers from 0 on"),
        (["retain", "--days", "-1"], "found -1 days, allowed are numbers from 0 on"),
        (["retain", "--days", "1", "--gigabytes", "-2"], "found 1 days and -2 gigabytes, allowed"),
        (["keep", "nothing"], "found no run 'nothing'"),
        (["export", "--parquet", "/nowhere/runs.parquet"], "cannot be written"),
        (["--database", "mysql://x", "list"], "allowed are sqlite:/// and postgresql://"),
        (["--database", "/proc", "list"], "catalogue"),
    ],
)
def test_what_cannot_be_done_is_said_in_one_line(catalogue: Run, arguments: list[str], says: str) -> None:
    status, out, err = catalogue(*arguments)
    assert (status, out) == (2, [])
    assert says in err
    assert err.count("\n") == 1


@pytest.mark.parametrize("command", [["list"], ["retain", "--days", "1"], ["keep", "run_1"]])
def test_a_catalogue_that_is_not_there_is_not_made(
    catalogue: Run, tmp_path: Path, command: list[str]
) -> None:
    missing = tmp_path / "new" / "runs.sqlite"
    status, out, err = catalogue("--database", str(missing), *command)
    assert (status, out) == (2, [])
    assert f"there is no database {missing}" in err
    assert not missing.parent.exists()


def test_a_time_nobody_means_is_refused(catalogue: Run, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        catalogue("list", "--since", "yesterday")
    assert "2026-11-22T08:00" in capsys.readouterr().err
