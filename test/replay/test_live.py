"""Live replay: the recorded inputs go over DDS to the nodes, in a process of its own."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
import yaml

from source_tree import ROOT

BAGS = ROOT / "bags"
LIMIT = 180  # s


def live(bag: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    environment = os.environ | {"PYTHONPATH": os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")])}
    command = [sys.executable, "-m", "doormill_ros.tools.replay", "--live", *arguments, str(bag)]
    return subprocess.run(
        command, env=environment, capture_output=True, text=True, timeout=LIMIT, check=False
    )


@pytest.mark.parametrize("rate", ["1", "max"])
def test_the_nodes_answer_as_recorded(rate: str) -> None:
    done = live(BAGS / "thesis_190_0deg", "--rate", rate)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "equal: 1 of /door/localization, 1 of /path/targets, 1 of /abb/target_file" in done.stdout


@pytest.mark.parametrize("scenario", ["outside_rotation", "unreachable", "unknown_door"])
def test_the_nodes_refuse_as_recorded(scenario: str) -> None:
    done = live(BAGS / scenario, "--rate", "max")
    assert done.returncode == 0, done.stdout + done.stderr
    assert "equal" in done.stdout


def test_a_difference_is_named(tmp_path: Path) -> None:
    """Another expectation stands for another code: the nodes run as installed."""
    bag = Path(shutil.copytree(BAGS / "outside_rotation", tmp_path / "bag"))
    update = [sys.executable, "-m", "doormill_ros.tools.replay", "--update", str(bag)]
    subprocess.run(update, check=True, capture_output=True, timeout=LIMIT, cwd=ROOT)
    document = yaml.safe_load((bag / "expected.yaml").read_text())
    (answers,) = document["runs"].values()
    answers[0]["values"]["error_code"] = 201
    (bag / "expected.yaml").write_text(yaml.safe_dump(document))
    done = live(bag, "--rate", "max")
    assert done.returncode == 1, done.stdout + done.stderr
    assert "/door/localization" in done.stdout
    assert "error_code: expected 201, found 204" in done.stdout
