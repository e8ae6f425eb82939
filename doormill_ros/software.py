"""Which software this is: its version, and a digest of its code by which two installations are told apart."""

from __future__ import annotations

import functools
import hashlib
from pathlib import Path

from doormill_ros import __version__

DIGITS = 12  # of the digest


@functools.cache
def software() -> str:
    """Version and digest of the package's Python files, such as `0.1.0+1f2e3d4c5b6a`.

    Taken from the code itself: a version number stays the same while somebody works on the code.
    """
    folder = Path(__file__).parent
    digest = hashlib.sha256()
    for path in sorted(folder.rglob("*.py")):
        digest.update(f"{path.relative_to(folder).as_posix()}\n".encode())
        digest.update(hashlib.sha256(path.read_bytes()).digest())
    return f"{__version__}+{digest.hexdigest()[:DIGITS]}"
