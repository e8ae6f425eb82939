"""The drive of the simulated spindle: what its frequency converter tells the controller of its load.

It follows the executed path in whatever time the controller plays it. A cell that is faster than time is therefore
looked at less often by a PC than one at the pace of a workshop, and what it sees then is as true.
"""

from __future__ import annotations

import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from doormill_ros.abb.signals import IO_FOLDER, SPINDLE_LOAD
from doormill_ros.files import write_atomically
from doormill_ros.simulation.controller.controller import VirtualController
from doormill_ros.simulation.world.cutting_power import SPECIFIC, CutDoor

NOMINAL = 5000.0  #: power of the drive [W]
IDLE = 0.1  #: share of it that a turning spindle takes in the air: bearings and fan [assumption]
SMOOTHING = 0.1  #: time constant of the converter's output [s]
NOISE = 0.005  #: its standard deviation, share of the nominal power
#: Shortest time between two files, by the clock of the wall [s]; a bridge that nobody told looks every 0.25 s.
SHOWN = 0.02
PERCENT = 100.0


@dataclass(frozen=True, eq=False)
class SpindleWork:
    """A door that is being milled.

    Attributes:
        door: What is left of it.
        factor: Of the work that the wood takes: dull mills and hard wood take more.
        rng: Draws the noise.
    """

    door: CutDoor
    factor: float
    rng: np.random.Generator


class SpindleDrive:
    """Gives the controller's analog input and its file the load, as simulated time passes.

    Attributes:
        work: The door in hand; None while nobody knows it, then the spindle turns in the air.
    """

    def __init__(self, home: Path) -> None:
        """Stand still; the file is there from now on.

        Args:
            home: Folder behind HOME:, with the signals beside it.
        """
        self._file = home / IO_FOLDER / SPINDLE_LOAD
        self.work: SpindleWork | None = None
        self._begin()
        self._write(0.0)

    def _begin(self) -> None:
        self._controller: VirtualController | None = None
        self._load = self._now = 0.0
        self._seen = 0
        self._shown_at = float("-inf")

    def advance(self, controller: VirtualController) -> None:
        """Time has passed: follow the path so far."""
        cell = controller.cell
        if SPINDLE_LOAD not in cell.kinds:
            return
        if controller is not self._controller:
            self._begin()
            self._controller = controller
        recording = controller.recording
        volume, now = 0.0, controller.now()
        for i in range(self._seen, len(recording.time)):
            if self.work is not None:
                context, tool = recording.context[i], recording.surroundings[i].tool
                volume += self.work.door.take(context.feature, recording.poses[i][:3, 3], tool)
        self._seen = len(recording.time)
        passed, self._now = now - self._now, now
        if passed <= 0.0:
            return
        turning = cell.read(cell.spindle_drive)
        factor = 0.0 if self.work is None else self.work.factor
        load = turning * (IDLE + factor * SPECIFIC * volume / passed / NOMINAL)
        self._load += (load - self._load) * -np.expm1(-passed / SMOOTHING)
        self._show(controller)

    def _show(self, controller: VirtualController) -> None:
        noise = 0.0 if self.work is None else NOISE * self.work.rng.standard_normal()
        percent = PERCENT * max(self._load + noise, 0.0)
        controller.cell.set_input(SPINDLE_LOAD, percent)
        if time.monotonic() - self._shown_at >= SHOWN:
            self._shown_at = time.monotonic()
            self._write(percent)

    def _write(self, percent: float) -> None:
        write_atomically(self._file, f"{percent:.2f}".encode())
