"""`.ci/run` judges a clone, passes the verdict on and leaves nothing behind."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import time
from pathlib import Path

import pytest

from support.source_tree import ROOT
from support.waiting import LIMIT

#: Gates that tell where they run and with what; `slow` waits until it is stopped.
MAKEFILE = """
lint:
\t@pwd; ls -A; env | sort; echo "argument $(DISTRO)"
test:
\t@echo "3 passed"; test ! -e fail || exit 1
\t@if [ -e stray ]; then setsid sleep 600 & fi
\t@if [ -e slow ]; then echo $$$$ > "$(MARK)"; sleep 600; fi
"""
IDENTITY = {"GIT_CONFIG_GLOBAL": os.devnull, "GIT_CONFIG_SYSTEM": os.devnull} | {
    f"GIT_{who}_{what}": f"gate@{who}.example".lower()
    for who in ("AUTHOR", "COMMITTER")
    for what in ("NAME", "EMAIL")
}


@pytest.fixture
def project(tmp_path: Path):
    """A small repository with the script: project(files to commit) gives its folder."""

    def project_(*names: str) -> Path:
        folder = tmp_path / "project"
        (folder / ".ci").mkdir(parents=True)
        shutil.copy(ROOT / ".ci" / "run", folder / ".ci" / "run")
        (folder / "Makefile").write_text(MAKEFILE)
        for name in names:
            (folder / name).touch()
        for command in (["init", "-q"], ["add", "-A"], ["commit", "-qm", "All"]):
            subprocess.run(["git", *command], cwd=folder, check=True, env={**os.environ, **IDENTITY})
        return folder

    return project_


def start(folder: Path, *arguments: str, **environment: str) -> subprocess.Popen[str]:
    scratch = folder.parent / "scratch"
    scratch.mkdir()
    return subprocess.Popen(
        [folder / ".ci" / "run", *arguments],
        env={**os.environ, **environment, "TMPDIR": str(scratch)},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        # Whoever runs the tests in the background of a script has interrupts ignored, which a child inherits.
        preexec_fn=lambda: [signal.signal(n, signal.SIG_DFL) for n in (signal.SIGINT, signal.SIGTERM)],
    )


def runs(pid: int) -> bool:
    """Whether a process lives; one that ended and waits for whoever inherited it to ask why does not."""
    try:
        state = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0]
    except (FileNotFoundError, ProcessLookupError):
        return False
    return state not in "ZX"


def left_behind(folder: Path) -> list[str]:
    return os.listdir(folder.parent / "scratch")


def test_the_gates_see_a_clone_of_what_is_committed_and_nothing_else(project) -> None:
    folder = project("committed")
    (folder / "not-committed").touch()
    process = start(
        folder,
        "DISTRO=jazzy",
        PIP_INDEX_URL="https://index.example",
        https_proxy="http://proxy.example",
        PYTHONPATH=str(folder),
        VIRTUAL_ENV=str(folder / ".venv"),
        DOORMILL_WHEELS="1",
        PATH=f"{folder / 'bin'}:{os.environ['PATH']}",
    )
    output, errors = process.communicate(timeout=LIMIT)
    assert process.returncode == 0, errors
    place, *lines = output.splitlines()
    assert not Path(place).is_relative_to(folder)
    assert "committed" in lines
    assert "not-committed" not in lines
    assert "what is not committed is not looked at" in errors
    assert {"PIP_INDEX_URL=https://index.example", "https_proxy=http://proxy.example"} <= set(lines)
    assert not [line for line in lines if line.startswith(("PYTHONPATH=", "VIRTUAL_ENV=", "DOORMILL_"))]
    assert str(folder) not in output
    assert "argument jazzy" in lines
    assert lines[-1] == "3 passed"
    assert left_behind(folder) == []


def test_a_gate_that_fails_fails_the_run(project) -> None:
    folder = project("fail")
    process = start(folder)
    output, errors = process.communicate(timeout=LIMIT)
    assert process.returncode == 2
    assert "3 passed" in output
    assert "'make test' failed" in errors
    assert left_behind(folder) == []


def test_a_gate_that_stands_still_is_ended_and_fails_the_run(project, tmp_path: Path) -> None:
    folder, mark = project("slow"), tmp_path / "mark"
    process = start(folder, f"MARK={mark}", DOORMILL_CI_LIMIT="10")
    output, errors = process.communicate(timeout=LIMIT)
    assert process.returncode == 124
    assert "3 passed" in output
    assert "'make test' did not end within 10" in errors
    assert not runs(int(mark.read_text()))
    assert left_behind(folder) == []


def test_what_gates_leave_behind_is_told_and_ended(project) -> None:
    """It would hold whoever waits for the end of what the run prints."""
    folder = project("stray")
    process = start(folder)
    output, errors = process.communicate(timeout=LIMIT)
    assert process.returncode == 0, errors
    assert "3 passed" in output
    assert "doormill: left behind: sleep 600" in errors
    assert left_behind(folder) == []


#: Lets the script be slower than the gate that it started: the gate is at work before the script noted which it is.
SLOW_SCRIPT = """trap 'if [[ $BASH_COMMAND == gate=* ]]; then sleep 3; fi' DEBUG"""


@pytest.mark.parametrize("slow", [False, True])
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_an_interrupted_run_ends_its_gate_and_cleans_up(
    project, number: signal.Signals, slow: bool, tmp_path: Path
) -> None:
    folder, mark = project("slow"), tmp_path / "mark"
    (tmp_path / "slow.sh").write_text(SLOW_SCRIPT)
    environment = {"BASH_ENV": str(tmp_path / "slow.sh")} if slow else {}
    process = start(folder, f"MARK={mark}", **environment)
    while not (mark.exists() and mark.read_text().strip()):
        assert process.poll() is None
        time.sleep(0.05)
    shell = int(mark.read_text())
    process.send_signal(number)
    process.communicate(timeout=LIMIT)
    assert process.returncode == 128 + number
    assert not runs(shell)
    assert left_behind(folder) == []
