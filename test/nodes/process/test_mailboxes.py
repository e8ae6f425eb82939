"""A process that hears nobody, or that one who was started again does not hear, ends, to be started again."""

from __future__ import annotations

import mmap
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from doormill_ros.nodes.process.mailboxes import (
    FILE,
    HEARD_LOOKS,
    LOWEST,
    SPOKEN_LOOKS,
    THREAD,
    Mailboxes,
    lost_mailboxes,
)
from support.cell_processes import executable
from support.waiting import LIMIT

#: Beyond those that tests have (conftest.py): nobody speaks there who might take a busy process for dead.
DOMAIN = 100


def ports_of(process: int) -> list[str]:
    """Ports of its domain in shared memory that a process listens to."""
    names = [path.read_text().strip() for path in Path(f"/proc/{process}/task").glob("*/comm")]
    ports = [name.removeprefix(THREAD) for name in names if name.startswith(THREAD)]
    return [port for port in ports if port.isdigit() and int(port) >= LOWEST]


@contextmanager
def active(folder: Path, name: str) -> Iterator[tuple[subprocess.Popen[bytes], Path]]:
    """An active node as a process of its own, and what it says."""
    with watched(folder, name, [executable(name)]) as running:
        yield running


@contextmanager
def watched(folder: Path, name: str, program: list[str]) -> Iterator[tuple[subprocess.Popen[bytes], Path]]:
    """A program of that node, once it is active."""
    log = folder / f"{name}.txt"
    command = [*program, "--ros-args", "-p", f"database_url:=sqlite:///{folder / 'r.sqlite'}"]
    own = {"ROS_DOMAIN_ID": str(DOMAIN), "ROS_LOG_DIR": str(folder / "ros")}
    with open(log, "wb") as said:
        process = subprocess.Popen(command, stdout=said, stderr=said, env={**os.environ, **own})
    try:
        wait_for(lambda: "active" in log.read_text(), process, log)
        yield process, log
    finally:
        process.kill()
        process.wait()


def wait_for(condition: Callable[[], object], process: subprocess.Popen[bytes], log: Path) -> None:
    """Wait for something, as long as a process lives."""
    deadline = time.monotonic() + LIMIT
    while not condition():
        assert process.poll() is None, log.read_text()
        assert time.monotonic() < deadline, log.read_text()
        time.sleep(0.05)


def forget_waiting(port: str) -> None:
    """Let a port look as its listener leaves it that is killed between two messages.

    Fast DDS keeps what its listeners do in front of its own name, 20 bytes for each of 1024: the first byte of one
    says whether it is there (1), waits (2), or works on a message (4).
    """
    with open(f"{FILE}{port}", "r+b") as file, mmap.mmap(file.fileno(), 0) as memory:
        first = memory.find(b"fastdds\0") - 1024 * 20
        assert memory[first] in (1, 3, 5)
        memory[first] = 1


@pytest.fixture
def node(tmp_path: Path) -> Iterator[tuple[subprocess.Popen[bytes], Path]]:
    """An active /recipe_database."""
    with active(tmp_path, "recipe_database") as node:
        yield node


def test_a_node_that_hears_nobody_ends_and_says_why(node: tuple[subprocess.Popen[bytes], Path]) -> None:
    process, log = node
    ports = ports_of(process.pid)
    assert ports
    assert lost_mailboxes(str(process.pid)).heard == ()
    Path(f"{FILE}{ports[-1]}").unlink()
    assert lost_mailboxes(str(process.pid)).heard == (ports[-1],)
    assert process.wait(LIMIT) == 0
    assert "hears nobody any more" in log.read_text()
    assert ports[-1] in log.read_text()


#: The node's program, telling each look that found no loss.
TELLING = """
from doormill_ros.nodes import recipe_database
from doormill_ros.nodes.process.mailboxes import Mailboxes

look = Mailboxes.look

def told(self):
    why = look(self)
    print("looked:", why or "all is well", flush=True)
    return why

Mailboxes.look = told
raise SystemExit(recipe_database.main())
"""


def test_one_that_hears_ends_when_it_is_told(tmp_path: Path) -> None:
    with watched(tmp_path, "recipe_database", [sys.executable, "-c", TELLING]) as (process, log):
        wait_for(lambda: log.read_text().count("looked: all is well") > HEARD_LOOKS, process, log)
        process.send_signal(signal.SIGINT)
        assert process.wait(LIMIT) == 0
        assert log.read_text().count("looked:") == log.read_text().count("looked: all is well")


def test_a_node_that_one_started_again_does_not_hear_ends_and_says_why(
    node: tuple[subprocess.Popen[bytes], Path], tmp_path: Path
) -> None:
    process, log = node
    with active(tmp_path, "door_localizer") as (other, _):
        (port,) = ports_of(other.pid)
        wait_for(lambda: f"{FILE}{port}" in Path(f"/proc/{process.pid}/maps").read_text(), process, log)
        other.kill()
        other.wait()
        forget_waiting(port)
    with active(tmp_path, "door_localizer") as (other, _):
        assert ports_of(other.pid) == [port]
        assert lost_mailboxes(str(process.pid)).spoken == (port,)
        assert process.wait(LIMIT) == 0
        assert other.poll() is None
    assert "does not hear this one" in log.read_text()
    assert port in log.read_text()


def test_a_file_of_one_who_ended_is_no_loss_while_nobody_listens_in_his_place() -> None:
    port = LOWEST + 250 * 101 + 249  # of no domain that a test has
    file = Path(f"{FILE}{port}")
    file.write_bytes(bytes(4096))
    hold = "import mmap, sys, time; f = open(sys.argv[1]); m = mmap.mmap(f.fileno(), 4096, prot=mmap.PROT_READ)\n"
    wait = "print('there', flush=True); time.sleep(600)"
    listen = "import fcntl, sys, time; f = open(sys.argv[1]); fcntl.flock(f, fcntl.LOCK_EX)\n"
    lock = Path(f"{FILE}{port}_el")
    with running(hold + wait, file) as holding:
        mailboxes = Mailboxes(str(holding.pid))
        assert [mailboxes.look() for _ in range(9)] == [""] * 9
        file.unlink()
        assert [mailboxes.look() for _ in range(9)] == [""] * 9
        lock.touch()  # of one who was killed
        assert [mailboxes.look() for _ in range(9)] == [""] * 9
        with running(listen + wait, lock):
            assert lost_mailboxes(str(holding.pid)).spoken == (str(port),)
            looks = [mailboxes.look() for _ in range(SPOKEN_LOOKS)]
            assert looks[:-1] == [""] * (SPOKEN_LOOKS - 1)
            assert f"port {port}" in looks[-1]
        assert mailboxes.look() == ""
        lock.unlink()


@contextmanager
def running(code: str, *arguments: Path) -> Iterator[subprocess.Popen[bytes]]:
    """A process that runs some code, once that has said something."""
    command = [sys.executable, "-c", code, *arguments]
    with subprocess.Popen(command, stdout=subprocess.PIPE) as process:
        try:
            assert process.stdout is not None
            assert process.stdout.readline()
            yield process
        finally:
            process.kill()


def test_who_cannot_be_looked_at_has_lost_nothing() -> None:
    assert lost_mailboxes("none") == ((), ())
    assert Mailboxes("none").look() == ""
