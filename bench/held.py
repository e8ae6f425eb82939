"""What processes hold: resident memory, handles, sockets, shared memory; and what lies in a folder."""

from __future__ import annotations

import os
import re
import time
from collections.abc import Iterable
from dataclasses import astuple, dataclass
from pathlib import Path

SHARED = Path("/dev/shm")
LOOKS, PAUSE = 5, 0.1  # s


@dataclass(frozen=True)
class Held:
    """Resident memory [MB], open handles, sockets among them, threads."""

    memory: float
    handles: int
    sockets: int
    threads: int


def held_by(pid: int) -> Held:
    """What a process of this machine holds: the least of some looks, as files and threads come and go."""
    looks = []
    for _ in range(LOOKS):
        looks.append(_held_now(pid))
        time.sleep(PAUSE)
    return Held(*(min(values) for values in zip(*map(astuple, looks), strict=True)))


def _held_now(pid: int) -> Held:
    process = Path("/proc") / str(pid)
    status = (process / "status").read_text()
    handles = [_target(path) for path in (process / "fd").iterdir()]
    return Held(
        _number(status, "VmRSS") / 1024.0,
        len(handles),
        sum(handle.startswith("socket:") for handle in handles),
        _number(status, "Threads"),
    )


def processor_time_of(pid: int) -> float:
    """Processor time that a process has taken, its kernel's share too [s]."""
    # The second field, the program's name in brackets, may hold blanks.
    fields = (Path("/proc") / str(pid) / "stat").read_text().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def shared_of(pids: Iterable[int]) -> tuple[int, int]:
    """Segments of shared memory that these processes have mapped or open, and their bytes."""
    found: dict[str, int] = {}
    for pid in pids:
        for line in (Path("/proc") / str(pid) / "maps").read_text().splitlines():
            name = line[73:].strip()
            if name.startswith(f"{SHARED}/"):
                path = Path(name)
                found[name] = path.stat().st_size if path.exists() else 0
    return len(found), sum(found.values())


def size_of(folder: Path) -> int:
    """Bytes of all files under a folder."""
    return sum(path.stat().st_size for path in folder.rglob("*") if path.is_file())


def _number(status: str, name: str) -> int:
    found = re.search(rf"^{name}:\s+(\d+)", status, re.MULTILINE)
    assert found is not None, name
    return int(found[1])


def _target(path: Path) -> str:
    try:
        return os.readlink(path)
    except OSError:  # closed since it was listed
        return ""
