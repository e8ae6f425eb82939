"""`replay --many --scheduler`: workers that stand in another folder, see other files or have another configuration."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from doormill_ros.errors import DoormillError
from doormill_ros.recipes.store.database import RecipeDatabase
from doormill_ros.recording.replay.bag_verdict import judge_bag
from doormill_ros.recording.replay.offline import OfflineOptions
from doormill_ros.resources import share_directory
from doormill_ros.tools.replay import main
from support.dask_workers import dask_workers
from support.source_tree import ROOT
from support.waiting import LIMIT, until

SMALL = ROOT / "bags" / "unknown_door"


@pytest.fixture
def worker(tmp_path: Path) -> Iterator[str]:
    """The address of a scheduler with one worker, which stands in a folder of its own."""
    (tmp_path / "there").mkdir()
    with dask_workers(1, tmp_path / "there") as (address, _):
        yield address


def test_a_relative_database_is_the_one_of_who_asks(
    tmp_path: Path, worker: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "here").mkdir()
    monkeypatch.chdir(tmp_path / "here")
    for name in ("mine.sqlite", "sqlite:///mine.sqlite"):
        with RecipeDatabase("mine.sqlite") as database:
            database.add_shipped()
        assert main(["--many", str(SMALL), "--scheduler", worker, "--database", name]) == 0
        assert "equal" in capsys.readouterr().out
    assert not list((tmp_path / "there").rglob("*.sqlite"))


def test_a_scheduler_that_dies_costs_one_sentence(tmp_path: Path) -> None:
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(path for path in sys.path if path)}

    def start(*arguments: str, **more: object) -> subprocess.Popen[str]:
        command = [sys.executable, "-m", *arguments]
        quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
        return subprocess.Popen(command, env=environment, cwd=tmp_path, text=True, **(quiet | more))  # type: ignore

    place = tmp_path / "scheduler.json"
    chosen = ("--host", "127.0.0.1", "--port", "0", "--no-dashboard", "--scheduler-file", str(place))
    scheduler = start("distributed.cli.dask_scheduler", *chosen)
    processes = [scheduler]
    try:
        until(place.is_file)
        address = json.loads(place.read_text())["address"]
        processes.append(start("distributed.cli.dask_worker", address, "--no-nanny", "--nthreads", "1"))
        pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
        asked = ("doormill_ros.tools.replay", "--many", str(ROOT / "bags"), "--scheduler", address)
        asking = start(*asked, **pipes)
        processes.append(asking)
        assert asking.stdout is not None
        assert asking.stdout.readline().startswith("verdict")
        asking.stdout.readline()
        scheduler.kill()
        _, said = asking.communicate(timeout=LIMIT)
    finally:
        for process in processes:
            process.kill()
            process.wait()
    assert asking.returncode == 2
    assert "Traceback" not in said
    assert "replay: the scheduler went away" in said


def test_another_configuration_than_that_of_who_asks_is_said(
    tmp_path: Path, worker: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    cell = (share_directory() / "config" / "cell.yaml").read_text()
    own = tmp_path / "site" / "config" / "cell.yaml"
    own.parent.mkdir(parents=True)
    own.write_text(cell)
    monkeypatch.setenv("DOORMILL_SITE", str(tmp_path / "site"))
    assert main(["--many", str(SMALL), "--scheduler", worker]) == 0  # the same content in another place
    (own.parent / "nodes.yaml").write_text("{}")  # where the nodes of a machine listen is its own business
    assert main(["--many", str(SMALL), "--scheduler", worker]) == 0
    capsys.readouterr()
    own.write_text(f"{cell}\n# another\n")
    assert main(["--many", str(SMALL), "--scheduler", worker]) == 2
    assert "has another configuration" in capsys.readouterr().out


def test_what_lies_on_no_worker_is_said_and_not_made(tmp_path: Path) -> None:
    with pytest.raises(DoormillError, match="there is no database"):
        judge_bag(str(SMALL), OfflineOptions(database=str(tmp_path / "gone.sqlite")))
    assert list(tmp_path.iterdir()) == []
    with pytest.raises(DoormillError, match=r"gone\.yaml"):
        judge_bag(str(SMALL), OfflineOptions(robot_model=str(tmp_path / "gone.yaml")))
