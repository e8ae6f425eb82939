"""A process whose port in shared memory another one took away hears nobody: it ends, to be started again."""

from __future__ import annotations

import os
import signal
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from doormill_ros.nodes.mailboxes import FILE, LOWEST, THREAD, lost_mailboxes
from support.cell_processes import executable

LIMIT = 120.0  # s


def ports_of(process: int) -> list[str]:
    """Ports of its domain in shared memory that a process listens to."""
    names = [path.read_text().strip() for path in Path(f"/proc/{process}/task").glob("*/comm")]
    ports = [name.removeprefix(THREAD) for name in names if name.startswith(THREAD)]
    return [port for port in ports if port.isdigit() and int(port) >= LOWEST]


@pytest.fixture
def node(tmp_path: Path) -> Iterator[tuple[subprocess.Popen[bytes], Path]]:
    """An active /recipe_database as a process of its own, and what it says."""
    log = tmp_path / "log.txt"
    command = [
        executable("recipe_database"),
        "--ros-args",
        "-p",
        f"database_url:=sqlite:///{tmp_path / 'r.sqlite'}",
    ]
    with open(log, "wb") as said:
        process = subprocess.Popen(
            command, stdout=said, stderr=said, env={**os.environ, "ROS_LOG_DIR": str(tmp_path / "ros")}
        )
    try:
        deadline = time.monotonic() + LIMIT
        while "active" not in log.read_text():
            assert process.poll() is None, log.read_text()
            assert time.monotonic() < deadline, log.read_text()
            time.sleep(0.05)
        yield process, log
    finally:
        process.kill()
        process.wait()


def test_a_node_that_hears_nobody_ends_and_says_why(node: tuple[subprocess.Popen[bytes], Path]) -> None:
    process, log = node
    ports = ports_of(process.pid)
    assert ports
    assert lost_mailboxes(str(process.pid)) == ()
    Path(f"{FILE}{ports[-1]}").unlink()
    assert lost_mailboxes(str(process.pid)) == (ports[-1],)
    assert process.wait(LIMIT) == 0
    assert "hears nobody any more" in log.read_text()
    assert ports[-1] in log.read_text()


def test_one_that_hears_ends_when_it_is_told(node: tuple[subprocess.Popen[bytes], Path]) -> None:
    process, log = node
    time.sleep(7.0)  # two looks
    assert process.poll() is None
    process.send_signal(signal.SIGINT)
    assert process.wait(LIMIT) == 0
    assert "hears nobody any more" not in log.read_text()


def test_who_cannot_be_looked_at_has_lost_nothing() -> None:
    assert lost_mailboxes("none") == ()
