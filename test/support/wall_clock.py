"""A wall clock that a test sets, for processes that it starts: they see it, the machine does not."""

from __future__ import annotations

import os
import struct
import subprocess
from pathlib import Path

SOURCE = Path(__file__).with_suffix(".cpp")
VARIABLE = "DOORMILL_TEST_WALL_CLOCK"


class WallClock:
    """How far the clock is off, in a file; a process that runs in `environment` goes by it.

    Args:
        folder: For the library and the file.

    Attributes:
        environment: What a process needs beside the test's own.
    """

    def __init__(self, folder: Path) -> None:
        library = folder / "wall_clock.so"
        subprocess.run(["g++", "-O1", "-fPIC", "-shared", "-o", library, SOURCE, "-ldl"], check=True)
        self._file = folder / "wall_clock"
        self._file.write_bytes(bytes(8))
        self.environment = {"LD_PRELOAD": str(library), VARIABLE: str(self._file)}
        self.ahead = 0.0

    def step(self, by: float) -> None:
        """Set the clock forwards [s], or back."""
        self.ahead += by
        # In place: processes have mapped the file.
        with open(self._file, "r+b", buffering=0) as file:
            os.pwrite(file.fileno(), struct.pack("=q", round(self.ahead * 1e9)), 0)
