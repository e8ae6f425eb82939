"""The command `replay --many`: a line a bag, by processes and by the workers of a scheduler."""

from __future__ import annotations

import os
import random
import shutil
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from doormill_ros.tools.replay import main
from support.dask_workers import dask_workers
from support.run_bags import DrawnRun, write_run_bag
from support.source_tree import ROOT

#: The smallest of all: what is replayed of it takes milliseconds.
SMALL = ROOT / "bags" / "unknown_door"
COUNT = 8


@pytest.fixture
def bags(tmp_path: Path) -> tuple[Path, str, str]:
    """A folder of bags, and which of them, by the seed, is no bag and which tells of another end."""
    folder = tmp_path / "bags"
    for number in range(COUNT):
        shutil.copytree(SMALL, folder / f"{number:02d}")
    poisoned, differing = (f"{number:02d}" for number in random.Random(3).sample(range(COUNT), 2))
    next((folder / poisoned).glob("*.mcap")).write_bytes(b"no bag at all")
    shutil.rmtree(folder / differing)
    write_run_bag(folder / differing, [DrawnRun("run_0", offsets=(), correction=None, success=False)])
    return folder, poisoned, differing


def read(lines: list[str]) -> dict[str, dict[str, str]]:
    """The table by bag, each once."""
    head, *rows = [line.split("\t") for line in lines]
    found = {Path(row[1]).name: dict(zip(head, row, strict=True)) for row in rows}
    assert len(found) == len(rows)
    return found


def check_table(table: dict[str, dict[str, str]], poisoned: str, differing: str) -> None:
    assert len(table) == COUNT
    assert {name for name, row in table.items() if row["verdict"] == "unreadable"} == {poisoned}
    assert table[poisoned]["first"].endswith("(604)")
    assert {name for name, row in table.items() if row["verdict"] == "differs"} == {differing}
    assert table[differing]["first"].startswith("run run_0: /run/result of a run without picture: ")
    assert {row["verdict"] for name, row in table.items() if name not in (poisoned, differing)} == {"equal"}


def test_every_bag_has_its_line_and_one_that_differs_decides(
    bags: tuple[Path, str, str], capsys: pytest.CaptureFixture[str]
) -> None:
    folder, poisoned, differing = bags
    assert main(["--many", str(folder), "--workers", "2"]) == 1
    out, err = capsys.readouterr()
    check_table(read(out.splitlines()), poisoned, differing)
    assert f"{COUNT} bags: {COUNT - 2} equal, 0 not compared, 1 differs, 1 unreadable" in err


def test_a_bag_cut_in_half_is_not_equal(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    bag = Path(shutil.copytree(ROOT / "bags" / "thesis_190_0deg", tmp_path / "half"))
    (file,) = bag.glob("*.mcap")
    os.truncate(file, file.stat().st_size // 2)
    write_run_bag(tmp_path / "open", [DrawnRun("run_0", offsets=(), correction=None, success=None)])
    assert main(["--many", str(tmp_path), "--workers", "1"]) == 2
    table = read(capsys.readouterr().out.splitlines())
    assert {row["verdict"] for row in table.values()} == {"unreadable"}
    assert table["half"]["first"].endswith("(609)")
    assert "run run_0 has no run/result" in table["open"]["first"]


def test_what_was_not_compared_is_not_called_equal(capsys: pytest.CaptureFixture[str]) -> None:
    bags = [str(ROOT / "bags" / name) for name in ("no_picture", "spindle_fault", "unknown_door")]
    assert main(["--many", *bags, "--workers", "1"]) == 0
    out, err = capsys.readouterr()
    table = read(out.splitlines())
    assert {name: row["verdict"] for name, row in table.items()} == {
        "no_picture": "not compared",
        "spindle_fault": "equal",
        "unknown_door": "equal",
    }
    assert table["no_picture"]["first"].startswith("not compared: /run/result: ")
    assert table["spindle_fault"]["first"].startswith("not compared: /run/result: ")
    assert table["unknown_door"]["first"] == ""
    assert "3 bags: 2 equal, 1 not compared, 0 differs, 0 unreadable" in err


@pytest.fixture
def workers(tmp_path: Path) -> Iterator[tuple[str, list[subprocess.Popen[bytes]]]]:
    """A scheduler and two workers."""
    with dask_workers(2, tmp_path) as found:
        yield found


def test_a_worker_that_is_killed_costs_no_line(
    bags: tuple[Path, str, str], workers: tuple[str, list[subprocess.Popen[bytes]]]
) -> None:
    """Killed once the first line is there, whatever it does then; the other one does the rest."""
    (folder, poisoned, differing), (address, processes) = bags, workers
    command = [
        sys.executable,
        "-m",
        "doormill_ros.tools.replay",
        "--many",
        str(folder),
        "--scheduler",
        address,
    ]
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(path for path in sys.path if path)}
    with subprocess.Popen(
        command, env=environment, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
    ) as asking:
        lines = [asking.stdout.readline() for _ in range(2)]  # type: ignore[union-attr]  # a pipe was asked for
        processes[random.Random(1).randrange(2)].send_signal(signal.SIGKILL)
        lines += asking.stdout.readlines()  # type: ignore[union-attr]
    assert asking.returncode == 1
    check_table(read([line.rstrip("\n") for line in lines]), poisoned, differing)


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["--workers", "2"], "belong to --many"),
        (["--scheduler", "tcp://127.0.0.1:1"], "belong to --many"),
        (["--many", "--live"], "leave out --live"),
        (["--many", "--workers", "-1"], "positive number"),
        (["--many", "--workers", "0"], "positive number"),
        (["--workers", "0"], "belong to --many"),
        (["--many", "--workers", "2", "--scheduler", "tcp://127.0.0.1:1"], "leave it out with --scheduler"),
    ],
)
def test_options_that_do_not_go_together(
    arguments: list[str], says: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit):
        main([str(SMALL), *arguments])
    assert says in capsys.readouterr().err


def test_a_scheduler_that_is_not_there_is_told(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("doormill_ros.parallel.workplace.CONNECTING", 0.5)
    assert main(["--many", str(SMALL), "--scheduler", "tcp://127.0.0.1:1"]) == 2
    assert "replay: no Dask scheduler answers at tcp://127.0.0.1:1" in capsys.readouterr().err
