"""No test, nor what it starts, reads or writes what is the user's: recipes, catalogue, files of the site."""

from __future__ import annotations

import os
import pwd
import runpy
import subprocess
import sys
from pathlib import Path

import pytest

from doormill_ros.resources import site_folder
from support.source_tree import ROOT
from support.waiting import LIMIT

HOME = Path(pwd.getpwuid(os.getuid()).pw_dir).resolve()
#: What a process takes for its own without being told.
ASKED = (
    "from doormill_ros.recipes.store import engine\n"
    "from doormill_ros.catalogue import database\n"
    "from doormill_ros.resources import site_folder\n"
    "print(engine.default_url(database.ENVIRONMENT, database.FILE))\n"
    "print(engine.default_url(engine.ENVIRONMENT, engine.FILE))\n"
    "print(site_folder())\n"
)
WHILE_COLLECTED = site_folder()


def defaults() -> list[Path]:
    """Where a process that is started now has catalogue, recipes and site."""
    command = [sys.executable, "-c", ASKED]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=LIMIT, check=True)
    return [Path(line.removeprefix("sqlite:///")).resolve() for line in done.stdout.splitlines()]


@pytest.fixture(scope="session")
def of_the_session() -> list[Path]:
    return defaults()


@pytest.fixture(scope="module")
def of_the_module() -> list[Path]:
    return defaults()


def test_a_test_has_a_site_of_its_own(tmp_path: Path) -> None:
    found = defaults()
    assert [path.name for path in found] == ["catalogue.sqlite", "recipes.sqlite", "doormill_ros"]
    assert all(path.is_relative_to(tmp_path.resolve()) for path in found)


def test_nodes_that_serve_a_whole_file_have_one_too(
    of_the_module: list[Path], tmp_path_factory: pytest.TempPathFactory
) -> None:
    base = tmp_path_factory.getbasetemp().resolve()
    assert all(path.is_relative_to(base) for path in of_the_module)


def test_nothing_else_is_in_the_users_home(of_the_session: list[Path]) -> None:
    for path in [*of_the_session, WHILE_COLLECTED.resolve()]:
        assert not path.is_relative_to(HOME)


def test_what_the_caller_named_does_not_count(tmp_path: Path) -> None:
    """A shell that has a site of its own runs the tests."""
    names = ("DOORMILL_SITE", "DOORMILL_DATABASE", "DOORMILL_CATALOGUE", "XDG_DATA_HOME")
    environment = {**os.environ, **{name: str(tmp_path / "of_the_caller" / name) for name in names}}
    (tmp_path / "conftest.py").write_text((ROOT / "test" / "conftest.py").read_text(encoding="utf-8"))
    (tmp_path / "test_it.py").write_text(
        "import os\n\nimport pytest\n\n"
        f"NAMES = {names}\n\n"
        "def named():\n    return [name for name in NAMES if 'of_the_caller' in os.environ.get(name, '')]\n\n"
        "COLLECTED = named()\n\n"
        "@pytest.fixture(scope='session')\ndef held():\n    return named()\n\n"
        "def test_named(held):\n    assert COLLECTED == held == named() == []\n"
    )
    done = subprocess.run(
        [sys.executable, "-m", "pytest", "-p", "no:cacheprovider", "-q", "-o", "timeout=100", "test_it.py"],
        cwd=tmp_path,
        env=environment | {"PYTHONPATH": f"{ROOT / 'test'}"},
        capture_output=True,
        text=True,
        timeout=LIMIT,
    )
    assert done.returncode == 0, done.stdout


def test_a_recorded_bench_has_one_too(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("DOORMILL_SITE", "DOORMILL_CATALOGUE", "XDG_DATA_HOME"):
        monkeypatch.setenv(name, str(tmp_path / "users"))
    bench = tmp_path / "bench.py"
    bench.write_text(ASKED, encoding="utf-8")
    record = runpy.run_path(str(ROOT / "bench" / "record.py"))
    with (tmp_path / "printed").open("w+", encoding="utf-8") as output:
        assert record["play"](str(bench), [], output) == (0, False)
        output.seek(0)
        printed = output.read()
    assert len(printed.splitlines()) == 3
    assert str(tmp_path / "users") not in printed
    assert not any(
        Path(line.removeprefix("sqlite:///")).is_relative_to(HOME) for line in printed.splitlines()
    )
