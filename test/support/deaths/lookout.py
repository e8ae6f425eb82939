"""Looks at the signals in a controller's folder, in a process of its own: `python lookout.py HOME`.

A thread among others waits for them, however it is favoured, and on a machine at work misses starts. Tells a line of
JSON for each thing seen, bytes in base64: `{"start": FILE, "asked": TIME}` when the robot began to mill, the file that
stood there while `goPathReady` held the number of the request that stands, and when that was made [s since the epoch],
null for never; `{"named": FILE}` what the controller named as milled to its end. `doPathReady` rises after the number:
a robot that is quick has begun by then. The first line is empty: it looks. Ends when its input does.
"""

from __future__ import annotations

import base64
import json
import os
import signal
import sys
import threading
import time
from contextlib import suppress
from pathlib import Path

LOOK = 0.001  # s
FIRST = -15  #: niceness


def read(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except OSError:
        return b""


def tell(**seen: object) -> None:
    line = {k: base64.b64encode(v).decode() if isinstance(v, bytes) else v for k, v in seen.items()}
    sys.stdout.write(json.dumps(line) + "\n" if line else "\n")
    sys.stdout.flush()


def watch(home: Path, ended: threading.Event) -> None:
    answered, request = home / "io" / "goPathReady", home / "Hei2.req"
    busy, target = home / "io" / "doPathBusy", home / "Hei2.txt"

    def is_ready() -> bool:
        number = read(answered).strip()
        return number not in (b"", b"0") and number == read(request).strip()

    def asked_at() -> float | None:
        """When the program wrote the number of its request, by the machine's own clock."""
        try:
            return request.stat().st_mtime
        except OSError:
            return None

    nothing: tuple[bytes, float | None] = (b"", None)
    was_busy, kept, named = True, nothing, b""
    tell()
    while True:
        last = ended.is_set()
        # Ready before the file was read and after it, for one request: no write of the PC was met halfway.
        if is_ready():
            asked, data = asked_at(), read(target)
            if data and is_ready() and asked_at() == asked:
                kept = data, asked
        milled = read(home / "Hei2.end")
        if milled != named:
            named = milled
            tell(named=named)
        is_busy = read(busy).strip() == b"1"
        if is_busy and not was_busy:
            if kept[1] != asked_at():
                kept = nothing  # what answered an earlier request
            tell(start=kept[0], asked=kept[1])
            kept = nothing
        was_busy = is_busy
        if last:
            return
        time.sleep(LOOK)


def main() -> None:
    with suppress(PermissionError):  # without the right to it, it may look too late on a machine at work
        os.setpriority(os.PRIO_PROCESS, 0, FIRST)
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # whoever asked ends it
    ended = threading.Event()

    def wait_for_end() -> None:
        sys.stdin.read()
        ended.set()

    threading.Thread(target=wait_for_end, daemon=True).start()
    watch(Path(sys.argv[1]), ended)


if __name__ == "__main__":
    main()
