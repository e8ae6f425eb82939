"""The simulated folder: whole files only, every call bounded, one user at a time."""

from __future__ import annotations

import errno
import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path
from types import SimpleNamespace

import pytest

from doormill_ros.abb import signals
from doormill_ros.abb.link_errors import (
    DownloadError,
    FileMissingError,
    FileNameError,
    FolderInUseError,
    FolderMissingError,
    LinkError,
    ReadTimeoutError,
    SignalReadError,
    SignalWriteError,
    UploadError,
    WriteTimeoutError,
)
from doormill_ros.abb.transport import Transport
from doormill_ros.abb.transports import simulated_folder
from doormill_ros.abb.transports.bounded import BoundedCaller, CallTimeout
from doormill_ros.abb.transports.simulated_folder import SimulatedFolderTransport
from doormill_ros.simulation.controller.cabinet.io_port import FolderIo
from support.waiting import LIMIT


@pytest.fixture
def link(tmp_path: Path):
    transport = SimulatedFolderTransport(tmp_path, timeout=60.0)
    yield transport
    transport.close()


def test_is_a_transport(link: SimulatedFolderTransport) -> None:
    assert isinstance(link, Transport)


def test_the_robot_program_sees_what_the_pc_writes_and_the_other_way_round(
    link: SimulatedFolderTransport, tmp_path: Path
) -> None:
    robot = FolderIo(tmp_path)
    assert [link.read_signal(name) for name in signals.ALL_SIGNALS] == [False] * 5
    for value in (1, 0, 1):
        robot.write(signals.REQUEST, value)
        assert link.read_request() is bool(value)
        link.set_ready(bool(value))
        assert robot.read(signals.READY) == value
        assert link.read_ready() is bool(value)


def test_files_come_back_byte_for_byte_and_go_away(link: SimulatedFolderTransport, tmp_path: Path) -> None:
    data = bytes(range(256)) * 10
    link.write_file("Hei2.txt", data)
    assert (tmp_path / "Hei2.txt").read_bytes() == data
    assert link.read_file("Hei2.txt") == data
    link.remove_file("Hei2.txt")
    link.remove_file("Hei2.txt")
    with pytest.raises(FileMissingError):
        link.read_file("Hei2.txt")


def test_a_reader_never_meets_a_part_of_a_file(link: SimulatedFolderTransport, tmp_path: Path) -> None:
    versions = [bytes([65 + i]) * 100_000 for i in range(4)]
    link.write_file("Hei2.txt", versions[0])
    seen, stop = set(), threading.Event()

    def read() -> None:
        while not stop.is_set():
            seen.add((tmp_path / "Hei2.txt").read_bytes())

    reader = threading.Thread(target=read)
    reader.start()
    limit, count = time.monotonic() + LIMIT, 0
    while count < 60 or (len(seen) < 2 and time.monotonic() < limit):
        link.write_file("Hei2.txt", versions[count % 4])
        count += 1
    stop.set()
    reader.join()
    assert len(seen) > 1
    assert seen <= set(versions)


@pytest.mark.parametrize("content", [b"", b"2", b"high", b"11"])
def test_a_signal_that_is_neither_high_nor_low_is_an_error(
    link: SimulatedFolderTransport, tmp_path: Path, content: bytes
) -> None:
    (tmp_path / "io" / signals.REQUEST).write_bytes(content)
    with pytest.raises(SignalReadError, match="allowed are '0' and '1'"):
        link.read_request()


def test_an_instant_without_content_is_read_over(
    link: SimulatedFolderTransport, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "io" / signals.REQUEST
    path.write_bytes(b"")
    pauses: list[float] = []

    def pause(seconds: float) -> None:
        pauses.append(seconds)
        if len(pauses) == 2:
            path.write_bytes(b"1\n")

    monkeypatch.setattr(simulated_folder, "time", SimpleNamespace(sleep=pause))
    assert link.read_request() is True
    assert len(pauses) == 2


@pytest.mark.parametrize(
    "name", ["", ".", "..", "a/b", "/etc/passwd", ".hidden", "a b", "ä.txt", "x" * 81, "$x", "a\n"]
)
def test_names_that_could_leave_the_folder_are_refused(link: SimulatedFolderTransport, name: str) -> None:
    for operation in (link.read_file, link.remove_file, lambda n: link.write_file(n, b"x")):
        with pytest.raises(FileNameError):
            operation(name)


def test_a_full_disk_leaves_the_old_file_and_no_rest(
    link: SimulatedFolderTransport, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    link.write_file("Hei2.txt", b"old")
    link.set_ready(True)

    def full(*_: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    def half(path: Path, data: bytes) -> None:
        with path.open("wb") as file:
            file.write(data[: len(data) // 2])
        full()

    with monkeypatch.context() as patch:
        patch.setattr(Path, "write_bytes", half)
        with pytest.raises(UploadError, match="disk is full"):
            link.write_file("Hei2.txt", b"new")
    assert sorted(p.name for p in tmp_path.iterdir() if p.is_file() and p.name[0] != ".") == ["Hei2.txt"]
    assert not list(tmp_path.glob("*tmp*")) + list(tmp_path.glob(".*tmp*"))
    assert link.read_file("Hei2.txt") == b"old"
    with monkeypatch.context() as patch:
        patch.setattr(os, "replace", full)
        with pytest.raises(SignalWriteError):
            link.set_ready(True)
        link.set_ready(False)  # lowering must not need space
    assert link.read_ready() is False


def test_a_folder_that_hangs_ends_in_a_timeout_and_order_is_kept(tmp_path: Path) -> None:
    link = SimulatedFolderTransport(tmp_path, timeout=60.0)
    link._timeout = 0.2
    os.mkfifo(tmp_path / "Hei2.txt")  # opening it blocks in the kernel, as a disk that hangs does
    with pytest.raises(ReadTimeoutError):
        link.read_file("Hei2.txt")
    with pytest.raises(WriteTimeoutError):
        link.set_ready(True)
    link._timeout = 60.0
    # The disk answers again; what timed out behind the hanging call was never sent.
    with open(tmp_path / "Hei2.txt", "wb"):
        pass
    link.set_ready(False)
    assert link.read_ready() is False
    link.close()


def test_a_call_given_up_behind_a_hanging_one_is_never_made() -> None:
    caller, started, release, made = BoundedCaller("test"), threading.Event(), threading.Event(), []

    def hang() -> None:
        started.set()
        release.wait(LIMIT)

    hanging = threading.Thread(target=lambda: caller.call(hang, 120.0))
    hanging.start()
    assert started.wait(LIMIT)
    with pytest.raises(CallTimeout):
        caller.call(lambda: made.append("late"), 0.05)
    release.set()
    hanging.join()
    caller.call(lambda: made.append("next"), 60.0)
    assert made == ["next"]
    caller.close()
    with pytest.raises(CallTimeout):
        caller.call(lambda: made.append("closed"), 60.0)
    assert made == ["next"]


def test_a_second_bridge_is_kept_out_until_the_first_dies(tmp_path: Path) -> None:
    code = (
        "import sys, time\n"
        "from doormill_ros.abb.transports.simulated_folder import SimulatedFolderTransport\n"
        "t = SimulatedFolderTransport(sys.argv[1]); print('up', flush=True); time.sleep(600)\n"
    )
    environment = {**os.environ, "PYTHONPATH": str(Path(__file__).resolve().parents[2])}
    with subprocess.Popen(
        [sys.executable, "-c", code, str(tmp_path)], stdout=subprocess.PIPE, env=environment
    ) as holder:
        assert holder.stdout.readline() == b"up\n"
        with pytest.raises(FolderInUseError, match="stop the other"):
            SimulatedFolderTransport(tmp_path)
        holder.send_signal(signal.SIGKILL)
        holder.wait()
    SimulatedFolderTransport(tmp_path).close()


def test_rests_of_a_killed_writer_are_removed(tmp_path: Path) -> None:
    (tmp_path / "io").mkdir()
    rests = [tmp_path / ".Hei2.txt.123.doormill-tmp", tmp_path / "io" / ".doPathReady.123.doormill-tmp"]
    for rest in rests:
        rest.write_bytes(b"half")
    SimulatedFolderTransport(tmp_path).close()
    assert not any(rest.exists() for rest in rests)


def test_a_missing_folder_is_named(tmp_path: Path) -> None:
    with pytest.raises(FolderMissingError, match="start the simulated controller first"):
        SimulatedFolderTransport(tmp_path / "nowhere")


def test_a_folder_that_goes_away_is_an_error_and_not_a_low_signal(tmp_path: Path) -> None:
    home = tmp_path / "home"
    home.mkdir()
    link = SimulatedFolderTransport(home)
    home.rename(tmp_path / "elsewhere")
    with pytest.raises(LinkError):
        link.read_request()
    with pytest.raises(LinkError):
        link.set_ready(True)
    link.close()


def test_a_folder_in_the_place_of_the_file_is_an_error(
    link: SimulatedFolderTransport, tmp_path: Path
) -> None:
    (tmp_path / "Hei2.txt").mkdir()
    with pytest.raises(DownloadError):
        link.read_file("Hei2.txt")
    with pytest.raises(UploadError):
        link.write_file("Hei2.txt", b"x")
    with pytest.raises(LinkError):
        link.remove_file("Hei2.txt")


def test_wait_is_ended_by_wake(link: SimulatedFolderTransport) -> None:
    slow = SimulatedFolderTransport.__new__(SimulatedFolderTransport)
    slow.__dict__.update(link.__dict__, _poll_interval=60.0)
    threading.Timer(0.05, slow.wake).start()
    begin = time.monotonic()
    slow.wait(LIMIT)
    assert time.monotonic() - begin < LIMIT
