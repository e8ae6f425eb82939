"""What ROS 2 lets everybody say on a command line: names, topics, the level of the log; and what it cannot read."""

from __future__ import annotations

import signal
import subprocess
from dataclasses import replace
from pathlib import Path

import pytest

from doormill_ros.cell.errors import NodeDeadError
from doormill_ros.nodes.base import topics
from doormill_ros.nodes.base.managed_node import ManagedNode
from doormill_ros.nodes.process.help_page import words_apart
from doormill_ros.nodes.process.run import run_nodes
from support.cell_processes import NODES, CellProcesses, executable
from support.package_nodes import reporting_nodes
from support.waiting import LIMIT

DOOR = "thesis_190_0deg"
HELPED = [kind for kind in reporting_nodes() if issubclass(kind, ManagedNode)]


def test_a_node_under_another_name_with_other_topics_does_its_work(tmp_path: Path) -> None:
    others = [name for name in NODES if name not in ("door_localizer", "bag_recorder")]
    with CellProcesses(tmp_path / "cell", nodes=others) as cell:
        overlays = cell.subscribe(replace(topics.DOOR_OVERLAY, name="seen/overlay"))
        renamed = ("-r", "__node:=eye", "-r", "door/overlay:=seen/overlay", "--log-level", "debug")
        cell.start("door_localizer", *renamed, "-p", "overlay_steps:=1", "-p", "eyes:overlay_step:=1")
        cell.wait_until_active("eye")
        result, _ = cell.mill(DOOR)
        assert result.success, result.message
        cell.wait(lambda: overlays)
        log = cell.log("door_localizer")
        assert "[DEBUG]" in log
        assert "no parameter overlay_steps of /eye" in log
        assert log.count("overlay_step is meant") == 1
        assert log.count("there is no node eyes in this process") == 1
        # What the bridge watches is what a node does in the cell, however it is called.
        cell.stop("door_localizer", signal.SIGKILL)
        cell.wait(lambda: cell.mill(DOOR)[0].error_code == NodeDeadError.code)
        result, _ = cell.mill(DOOR)
        assert "/door_localizer is dead" in result.message


def test_an_executable_ends_with_one_sentence_on_what_ros_cannot_read(tmp_path: Path) -> None:
    broken = tmp_path / "broken.yaml"
    broken.write_text("door_localizer: [1\n")
    for arguments in (["--log-level", "loud"], ["--params-file", str(broken)]):
        command = [executable("door_localizer"), "--ros-args", *arguments]
        ended = subprocess.run(command, capture_output=True, text=True, timeout=LIMIT, check=False)
        assert ended.returncode == 2, ended.stderr
        assert arguments[1] in ended.stderr
        assert "Traceback" not in ended.stderr


def test_help_tells_of_the_node_and_starts_nothing(tmp_path: Path) -> None:
    for words in (["--help"], ["--ros-args", "-p", "bag:=here", "--", "-h"]):
        ended = subprocess.run(
            [executable("bag_recorder"), *words],
            capture_output=True, text=True, timeout=LIMIT, check=False, cwd=tmp_path,
        )  # fmt: skip
        assert (ended.returncode, ended.stderr) == (0, "")
        assert "Node /bag_recorder: every topic of the cell into an MCAP bag." in ended.stdout
        assert list(tmp_path.iterdir()) == []


def test_a_word_that_is_nobodys_ends_an_executable(tmp_path: Path) -> None:
    for name, words in (("bag_recorder", ["--hlep"]), ("cell_simulator", ["--robot", "2", "--ros-args"])):
        ended = subprocess.run(
            [executable(name), *words],
            capture_output=True, text=True, timeout=LIMIT, check=False, cwd=tmp_path,
        )  # fmt: skip
        assert ended.returncode == 2, ended.stderr
        assert words[0] in ended.stderr
        assert "Traceback" not in ended.stderr
        assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("kind", HELPED, ids=lambda kind: kind.__name__)
def test_help_tells_every_parameter(kind: type[ManagedNode], capsys: pytest.CaptureFixture[str]) -> None:
    assert run_nodes(kind, kind, arguments=["lib/node", "--help"]) == 0
    out = capsys.readouterr().out
    said = " ".join(out.split())
    assert out.startswith("usage: node [--ros-args [-p NAME:=VALUE]")
    assert " ".join((kind.__doc__ or "").split()) in said
    assert out.count("  autostart:=true\n") == 1
    for parameter in kind.PARAMETERS:
        default = str(parameter.default) if parameter.default != "" else "''"
        assert f"  {parameter.name}:={default.replace('True', 'true').replace('False', 'false')}\n" in out
        told = f"{parameter.description}; allowed is {parameter.allowed}"
        assert " ".join(told.split()) in said


@pytest.mark.parametrize(
    ("line", "own", "of_ros"),
    [
        ("a -h", "a -h", ""),
        ("--ros-args -p a:=b", "", "--ros-args -p a:=b"),
        ("a --ros-args -r b:=c -- d --ros-args e", "a d", "--ros-args -r b:=c -- --ros-args e"),
        ("--ros-args -r b:=c --ros-args -r d:=e", "", "--ros-args -r b:=c --ros-args -r d:=e"),
    ],
)
def test_words_are_the_executables_or_those_of_ros(line: str, own: str, of_ros: str) -> None:
    assert words_apart(line.split()) == (own.split(), of_ros.split())
