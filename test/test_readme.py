"""Every command of the README runs, and those for who lives with a cell."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import time
from pathlib import Path

import pytest

from support.shell import output_of, run_in_shell
from support.source_tree import ROOT
from support.waiting import LIMIT

README = (ROOT / "README.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"```bash\n(.*?)```", README, flags=re.DOTALL)
MAKE = [block.strip() for block in BLOCKS if block.startswith("make ")]
LIVING = (ROOT / "docs" / "living.md").read_text(encoding="utf-8")
BLOCKS += re.findall(r"```bash\n(.*?)```", LIVING, flags=re.DOTALL)
SHELL = [block for block in BLOCKS if not block.startswith("make ")]


def test_the_readme_has_the_commands_it_promises() -> None:
    assert "make run" in MAKE
    assert "make test" in MAKE
    assert len(SHELL) >= 2


@pytest.mark.parametrize("command", MAKE)
def test_make_targets_exist(command: str) -> None:
    """They set everything up and run it, which is what this test is part of: make only has to know them."""
    done = subprocess.run(
        [*command.split(), "--dry-run"], cwd=ROOT, capture_output=True, text=True, timeout=LIMIT
    )
    assert done.returncode == 0, done.stderr
    assert "scripts/bootstrap.sh" in done.stdout


@pytest.mark.parametrize("block", [b for b in SHELL if " & " not in b])
def test_shell_commands_run(block: str, tmp_path: Path) -> None:
    output_of(block, tmp_path, LIMIT)


@pytest.mark.parametrize("block", [b for b in SHELL if " & " in b])
def test_nodes_started_in_the_background_come_up_and_stop(block: str, tmp_path: Path) -> None:
    names = re.findall(r"(\w+) &", block)
    assert len(names) == 8
    log = tmp_path / "log.txt"
    process = run_in_shell(f"exec > {log} 2>&1\n{block}\nwait", tmp_path)
    try:
        deadline = time.monotonic() + LIMIT
        # cell_simulator is three nodes.
        while not log.exists() or log.read_text().count("]: active") < len(names) + 2:
            assert process.poll() is None, log.read_text()
            assert time.monotonic() < deadline, log.read_text()
            time.sleep(0.1)
    finally:
        os.killpg(process.pid, signal.SIGINT)
        process.communicate(timeout=LIMIT)
    assert "Traceback" not in log.read_text()


@pytest.mark.parametrize("path", re.findall(r"\]\((?!http)([^)#]+)\)", README))
def test_links_and_pictures_are_there(path: str) -> None:
    assert (ROOT / path).exists()


def test_tools_and_nodes_named_in_the_readme_are_installed() -> None:
    prefix = next(
        p
        for p in os.environ["AMENT_PREFIX_PATH"].split(os.pathsep)
        if (Path(p) / "lib" / "doormill_ros").is_dir()
    )
    before_dependencies = README.split("## Why each dependency")[0]
    cells = re.findall(r"^\| (`\w+`(?:, `\w+`)*) \|", before_dependencies, flags=re.MULTILINE)
    names = [name for cell in cells for name in re.findall(r"\w+", cell)]
    assert len(names) == 26
    for name in names:
        assert (Path(prefix) / "lib" / "doormill_ros" / name).is_file(), name
