"""Whether the middleware still has the shared memory into which other processes put what this one is to hear.

Fast DDS listens to a file in /dev/shm for each of its ports. A process that takes the listener for dead removes the
file and makes it anew. Where the listener lives (seen on an overloaded machine, while nodes were killed and started
again) it goes on listening to a file that nobody can write into any more: it speaks and is seen by all, and hears
nobody, for ever. No setting of the middleware prevents that while discovery is kept to this machine.
"""

from __future__ import annotations

from pathlib import Path

#: What Fast DDS calls the thread that listens to a port, and its file.
THREAD, FILE = "dds.shm.", "/dev/shm/fastdds_port"
REMOVED = " (deleted)"
#: Lowest port of a domain (DDSI-RTPS 2.2, 9.6.1.1). Those below are shared by all domains of a machine; a process whose
#: file there is taken away was seen to hear as before.
LOWEST = 7400


def lost_mailboxes(process: str = "self") -> tuple[str, ...]:
    """Ports of its domain whose file was taken from a process; none with another middleware or without /proc.

    Args:
        process: Its number, or `self`.
    """
    folder = Path("/proc") / process
    try:
        maps = (folder / "maps").read_text(encoding="utf-8", errors="replace")
        heard = {name[len(THREAD) :] for name in _threads(folder) if name.startswith(THREAD)}
    except OSError:
        return ()
    gone = (line.rstrip() for line in maps.splitlines() if line.rstrip().endswith(REMOVED))
    files = {line.rpartition(FILE)[2].removesuffix(REMOVED) for line in gone if FILE in line}
    return tuple(sorted(port for port in heard & files if port.isdigit() and int(port) >= LOWEST))


def _threads(folder: Path) -> list[str]:
    names = []
    for path in (folder / "task").iterdir():
        try:
            names.append((path / "comm").read_text(encoding="utf-8", errors="replace").strip())
        except OSError:  # it ended meanwhile
            continue
    return names
