"""Whether this process and the others still share the memory in which they leave messages for each other.

Fast DDS listens to a file in /dev/shm for each of its ports, and opens those of the others to speak to them. Seen where
nodes were killed and started again:

- On an overloaded machine a process takes a listener for dead, removes its file and makes it anew. Where the listener
  lives it goes on listening to a file that nobody can write into any more: it speaks and is seen by all, and hears
  nobody, for ever.
- A listener that was killed between two messages, neither waiting for one nor at work on one, leaves a file that
  passes every check of Fast DDS. Who had it open goes on writing into it, for ever, while the node that was started
  again listens to a new file of that name: it is heard by all and does not hear them.

No setting of the middleware prevents either while discovery is kept to this machine.
"""

from __future__ import annotations

import fcntl
import re
from collections import Counter
from pathlib import Path
from typing import NamedTuple

#: What Fast DDS calls the thread that listens to a port, and its file.
THREAD, FILE = "dds.shm.", "/dev/shm/fastdds_port"
_REMOVED = re.compile(re.escape(FILE) + r"(\d+) \(deleted\)$", re.MULTILINE)
#: Lowest port of a domain (DDSI-RTPS 2.2, 9.6.1.1). Those below are shared by all domains of a machine; a process whose
#: file there is taken away was seen to hear as before.
LOWEST = 7400
#: So many looks in a row a port has to be lost. A file of one who ended otherwise is given up within seconds.
HEARD_LOOKS, SPOKEN_LOOKS = 2, 4


class Lost(NamedTuple):
    """Ports of its domain that a process listens to in vain (`heard`), and that it writes to in vain (`spoken`).

    To the latter another process listens by a new file of that name.
    """

    heard: tuple[str, ...] = ()
    spoken: tuple[str, ...] = ()


def lost_mailboxes(process: str = "self") -> Lost:
    """What a process has lost; nothing with another middleware or without /proc.

    Args:
        process: Its number, or `self`.
    """
    folder = Path("/proc") / process
    try:
        maps = (folder / "maps").read_text(encoding="utf-8", errors="replace")
        heard = _heard(folder)
    except OSError:
        return Lost()
    removed = {port for port in _REMOVED.findall(maps) if int(port) >= LOWEST}
    return Lost(tuple(sorted(heard & removed)), tuple(sorted(filter(_is_listened, removed - heard))))


class Mailboxes:
    """Looked at again and again, tells when a process has to end, so that it can be started again.

    Args:
        process: Its number, or `self`.
    """

    def __init__(self, process: str = "self") -> None:
        self._process = process
        self._heard: Counter[str] = Counter()
        self._spoken: Counter[str] = Counter()

    def look(self) -> str:
        """Why it has to end; empty while there is no reason."""
        lost = lost_mailboxes(self._process)
        self._heard = Counter({port: self._heard[port] + 1 for port in lost.heard})
        self._spoken = Counter({port: self._spoken[port] + 1 for port in lost.spoken})
        heard = ", ".join(port for port, looks in self._heard.items() if looks >= HEARD_LOOKS)
        if heard:
            return (
                "This process hears nobody any more: another one took it for dead and removed its port "
                f"{heard} in /dev/shm; it ends, so that it can be started again."
            )
        spoken = ", ".join(port for port, looks in self._spoken.items() if looks >= SPOKEN_LOOKS)
        if spoken:
            return (
                f"A process that was started again does not hear this one, which still writes to port {spoken} in "
                "/dev/shm of the one before; this one ends, so that it can be started again."
            )
        return ""


def _is_listened(port: str) -> bool:
    """Somebody listens to a port, in another container perhaps: he has it locked."""
    try:
        with open(f"{FILE}{port}_el", "rb") as lock:
            fcntl.flock(lock, fcntl.LOCK_SH | fcntl.LOCK_NB)  # ends with the file
    except BlockingIOError:
        return True
    except OSError:  # nobody did ever
        pass
    return False


def _heard(folder: Path) -> set[str]:
    names = []
    for path in (folder / "task").iterdir():
        try:
            names.append((path / "comm").read_text(encoding="utf-8", errors="replace").strip())
        except OSError:  # it ended meanwhile
            continue
    ports = (name.removeprefix(THREAD) for name in names if name.startswith(THREAD))
    return {port for port in ports if port.isdigit() and int(port) >= LOWEST}
