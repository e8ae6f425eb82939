"""A disk of the controller that is full for a while; a fault counts once a file was refused for want of room.

Who may mount gets a file system of its own for HOME: it is full for the robot program and the signals too. Elsewhere
the system gives the bridge's process no room for a whole target file.
"""

from __future__ import annotations

import contextlib
import errno
import os
import shutil
import subprocess
from collections.abc import Callable, Iterator
from pathlib import Path

from doormill_ros.abb.link_errors import UploadError
from support.faults.world import LOGGING, World
from support.full_disk import room_for

#: What the system says, and the status of the web services that meet it.
_NO_ROOM = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
_FAILED = 500
_MARK = "bridge-has-no-room"


@contextlib.contextmanager
def mounted(home: Path) -> Iterator[bool]:
    """A file system of 64 kB for HOME; False where this user may not mount one."""
    options = ["-t", "tmpfs", "-o", "size=64k", "tmpfs", str(home)]
    mount = shutil.which("mount")
    done = mount is not None and not subprocess.run([mount, *options], capture_output=True).returncode
    if done:
        (home / "io").mkdir()
    try:
        yield done
    finally:
        if done:
            subprocess.run(["umount", "-l", str(home)], check=False, capture_output=True)


def fill(world: World, full: bool) -> None:
    """Leave no byte free, or give the space back."""
    own = os.path.ismount(world.home)
    ballast = world.home / "ballast" if own else world.root / _MARK
    if not full:
        ballast.unlink(missing_ok=True)
        return
    with contextlib.suppress(OSError), ballast.open("ab") as file:
        while own:
            file.write(b"x" * 512)
            file.flush()


def write_on(world: World, write: Callable[[str, bytes], None], name: str, data: bytes) -> None:
    """Write a file through the link, and note it as a fault where there was no room for it.

    Raises:
        LinkError: It was not written.
    """
    if not world.entries("faults"):  # a robot program that has no room either may make no request any more
        fill(world, full=True)
    try:
        if (world.root / _MARK).exists():
            with LOGGING, room_for(len(data) // 2):  # the limit is the whole process's, of its logs as well
                write(name, data)
        else:
            write(name, data)
    except UploadError as error:
        if error.data.get("errno") in _NO_ROOM or error.data.get("status") == _FAILED:
            world.log("faults", what=f"no room for {name}")
        raise
