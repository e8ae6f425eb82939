"""A recorder that is killed leaves a bag that can be read and replayed."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections import Counter
from pathlib import Path

import pytest

from bags.repack import repack_bag
from bags.timeline import load_timeline, violations
from doormill_ros.recording.bag_reader import is_broken_off, read_bag
from doormill_ros.recording.replay.replay import replay_bag
from support.source_tree import ROOT
from support.waiting import LIMIT

DOOR = "thesis_190_0deg"
#: The whole cell in one process mills a door, says so and waits to be killed.
CELL = """
import sys, time
from pathlib import Path
from doormill_ros.cell.output.run_folder import RunFolder
from doormill_ros.nodes.one_process.cell import Cell, CellOptions
folder = RunFolder(Path(sys.argv[1]))
folder.prepare()
with Cell(folder, CellOptions({"abb_bridge": {"limit.picture": 60.0, "limit.targets": 60.0}})) as cell:
    print("milled" if cell.mill(sys.argv[2]).success else "refused", flush=True)
    time.sleep(600)
"""


@pytest.fixture(scope="module")
def killed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Bag of a run whose process was killed with -9 while everything was open."""
    folder = tmp_path_factory.mktemp("killed")
    environment = os.environ | {"XDG_DATA_HOME": str(folder / "data"), "PYTHONPATH": _python_path()}
    process = subprocess.Popen(
        [sys.executable, "-c", CELL, str(folder / "run"), DOOR],
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
    )
    try:
        assert process.stdout.readline() == "milled\n"
        deadline = time.monotonic() + LIMIT
        # The last state of the handshake is published beside the result, by another thread.
        while not _ended(folder / "run" / "bag"):
            assert time.monotonic() < deadline, "the end of the run never reached the disk"
            time.sleep(0.2)
    finally:
        process.send_signal(signal.SIGKILL)
        process.wait(LIMIT)
    assert process.returncode == -signal.SIGKILL
    return folder / "run" / "bag"


def _ended(bag: Path) -> bool:
    messages = list(read_bag(bag, ["/run/result", "/abb/status"]))
    return any(m.topic == "/run/result" for m in messages) and any(
        m.topic == "/abb/status" and m.message.state == "done" for m in messages
    )


def _python_path() -> str:
    return os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")])


def test_the_bag_has_no_end_and_is_readable(killed: Path) -> None:
    assert is_broken_off(killed)
    topics = [message.topic for message in read_bag(killed)]
    assert topics.count("/camera/image_raw") >= 1
    assert topics.count("/abb/target_file") == 1
    assert topics.count("/diagnostics") > 5


def test_the_bag_is_replayable(killed: Path) -> None:
    outcome = replay_bag(killed)
    assert [str(d) for d in outcome.found] == []
    assert set(outcome.counts) == {"/door/localization", "/path/targets", "/abb/target_file", "/run/result"}


def test_a_repaired_bag_is_a_whole_one(killed: Path, tmp_path: Path) -> None:
    repack_bag(killed, tmp_path / "whole")
    assert not is_broken_off(tmp_path / "whole")
    _, scenarios = load_timeline(ROOT / "bags" / "timeline.yaml")
    scenario = next(s for s in scenarios if s.name == DOOR)
    wrong = violations(scenario, tmp_path / "whole")
    # A busy machine may take a picture twice, and generate the path twice; the course is the intended one.
    assert not [w for w in wrong if "handshake" in w or "ended" in w], wrong
    before, after = (Counter(m.topic for m in read_bag(bag)) for bag in (killed, tmp_path / "whole"))
    assert after == before
    assert after["/path/targets"] >= 1
