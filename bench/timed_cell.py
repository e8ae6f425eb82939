"""The shipped nodes as processes of their own, with what stands around them in one more: `bench/stand_in.py`."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from held import Held, held_by, processor_time_of, shared_of

from support.cell_processes import CellProcesses

STAND_IN = Path(__file__).resolve().parent / "stand_in.py"
NODES = ("bag_recorder", "recipe_database", "door_localizer", "path_generator", "abb_bridge")
BUSY = "while True: pass"
#: After the last node is active DDS makes processes known to each other; without it bags miss what came first [s].
SETTLING = 2.0


class TimedCell(CellProcesses):
    """See `CellProcesses`; milled doors are those for which the ready signal was taken.

    Attributes:
        up: Time from the first process' start until every node says that it is active [s].
    """

    def __init__(self, folder: Path) -> None:
        super().__init__(folder, nodes=(*NODES, "stand_in"))
        self._home = folder / "HOME"
        self._begun = time.monotonic()

    def start(self, name: str) -> None:
        """Start one of the nodes, or the stand-in."""
        if name != "stand_in":
            super().start(name)
            return
        command = [sys.executable, str(STAND_IN), "--ros-args", "-p", f"ready_hand:home:={self._home}"]
        with open(self.folder / f"{name}.log", "ab") as log:
            self.processes[name] = subprocess.Popen(command, stdout=log, stderr=subprocess.STDOUT)

    def wait_until_up(self) -> None:
        """As the base class, and until the stand-in's nodes are active."""
        super().wait_until_up()
        self.wait_until_active("camera_simulator")
        self.wait_until_active("ready_hand")
        self.up = time.monotonic() - self._begun
        time.sleep(SETTLING)

    def take(self, door: str) -> None:
        """One door up to the end of its run.

        Raises:
            RuntimeError: It was refused.
        """
        result, _ = self.mill(door)
        if not result.success:
            raise RuntimeError(f"{door}: {result.message}")

    def held(self) -> dict[str, Held]:
        """What each of the shipped nodes' processes holds."""
        return {name: held_by(self.processes[name].pid) for name in NODES}

    def processor_times(self) -> dict[str, float]:
        """What each of the shipped nodes' processes has taken [s]."""
        return {name: processor_time_of(self.processes[name].pid) for name in NODES}

    def shared(self) -> tuple[int, int]:
        """Segments of shared memory of all processes, and their bytes."""
        return shared_of(process.pid for process in self.processes.values())


@contextmanager
def timed_cell() -> Iterator[TimedCell]:
    """A cell in folders of its own that nobody else's nodes hear; its files are gone afterwards."""
    os.environ["ROS_DOMAIN_ID"] = str(20 + os.getpid() % 80)
    with tempfile.TemporaryDirectory() as folder:
        os.environ["XDG_DATA_HOME"] = folder
        with TimedCell(Path(folder) / "cell") as cell:
            yield cell


@contextmanager
def busy_core(wanted: bool) -> Iterator[None]:
    """One core with nothing but arithmetic, if wanted."""
    process = subprocess.Popen([sys.executable, "-c", BUSY]) if wanted else None
    try:
        yield
    finally:
        if process is not None:
            process.kill()
            process.wait()
