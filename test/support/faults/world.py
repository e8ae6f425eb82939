"""What all processes of a run share: the door in the cell, and what was planned and milled."""

from __future__ import annotations

import fcntl
import hashlib
import json
import os
import threading
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from doormill_ros.abb.target_file.target_file import render_target_file
from doormill_ros.cell.places.layout import load_layout
from doormill_ros.files import write_atomically
from doormill_ros.frames import inverse
from doormill_ros.robot.configuration import ConfData
from doormill_ros.robot.description import load_robot
from doormill_ros.robot.inverse import inverse_branches
from doormill_ros.toolpath.program import MillingProgram, Motion, MotionKind, Target

#: Held while a log of this process is written.
LOGGING = threading.Lock()
DOORS = ("door_a", "door_b")
_LONGEST_LINE = 8192  # bytes of a log
#: Somewhere in front of the robot, near its home position, so that the real program can go there.
_FIRST = np.array([1.35, 0.4, 1.3])


#: Each door of a kind has its path beside that of the other [m].
_BESIDE = {"door_a": 0.0, "door_b": 0.12}
TARGETS = 14


def positions(placement: int, door_id: str) -> list[tuple[float, float]]:
    """Where the tool goes for a door: y and z of every target in order [mm]."""
    first = float(_FIRST[1]) + _BESIDE[door_id]
    return [(1000.0 * (first + 0.004 * i), 1000.0 * height(placement)) for i in range(TARGETS)]


def is_milling(x: float) -> bool:
    """Whether a target's x [mm] is that of a door's path."""
    return abs(x - 1000.0 * float(_FIRST[0])) < 0.5


def height(placement: int) -> float:
    """Height of the targets for a placement [m]: each has its own."""
    return float(_FIRST[2]) + 0.001 * (placement % 50)


@dataclass(frozen=True)
class World:
    """The folders of one run."""

    root: Path

    @classmethod
    def create(cls, root: Path) -> World:
        """Make the folders."""
        world = cls(root)
        world.home.mkdir(parents=True)
        (world.home / "io").mkdir()
        world.clamp(0, DOORS[0])
        return world

    @property
    def home(self) -> Path:
        """The controller's HOME folder."""
        return self.root / "home"

    def clamp(self, placement: int, door_id: str) -> None:
        """A door is put into the cell, each time a little differently: a new placement."""
        self.replace("placement", f"{placement} {door_id}")

    def replace(self, name: str, text: str) -> None:
        """Write a small file in one step: a process killed in between leaves the old one."""
        write_atomically(self.root / name, text)

    def door(self) -> tuple[int, str]:
        """The present placement and door, as a picture would show them."""
        number, door_id = (self.root / "placement").read_text().split()
        return int(number), door_id

    def log(self, name: str, **entry: Any) -> None:
        """Append a line; what a killed process logged before stays. "faults" holds what struck, and nothing else."""
        line = json.dumps({"t": time.monotonic(), **entry}) + "\n"
        with LOGGING, (self.root / f"{name}.jsonl").open("a") as file:
            fcntl.flock(file, fcntl.LOCK_EX)
            file.write(line)

    def entries(self, name: str) -> list[dict[str, Any]]:
        """All lines of a log."""
        try:
            text = (self.root / f"{name}.jsonl").read_text()
        except FileNotFoundError:
            return []
        return [json.loads(line) for line in text.splitlines()]

    def last(self, name: str) -> dict[str, Any]:
        """The last line of a log, empty before there is one."""
        try:
            with (self.root / f"{name}.jsonl").open("rb") as file:
                size = file.seek(0, os.SEEK_END)
                file.seek(max(0, size - _LONGEST_LINE))
                lines = file.read().splitlines()
        except FileNotFoundError:
            return {}
        return json.loads(lines[-1]) if lines else {}


def digest(data: bytes) -> str:
    """Name of a file's content."""
    return hashlib.sha256(data).hexdigest()


def make_file(placement: int, door_id: str, run_id: str) -> bytes:
    """A real target file of 14 targets; the placement is in its recipe version and its poses."""
    conf = ConfData(0, 0, -1, 1)
    targets, zeros = [], np.zeros(6)
    for i in range(TARGETS):
        T_base_tool = np.eye(4)
        T_base_tool[:3, :3] = [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]]
        T_base_tool[:3, 3] = [_FIRST[0], _FIRST[1] + _BESIDE[door_id] + 0.004 * i, height(placement)]
        targets.append(Target(str(i), T_base_tool, T_base_tool, zeros, conf, zeros, zeros))
    layout = load_layout()
    flange = targets[0].T_base_tool_corrected @ inverse(layout.T_flange_tool)
    first = inverse_branches(load_robot(layout.robot), flange[None])[0, conf.cfx]
    ends = [(MotionKind.ABSOLUTE, 0), *((MotionKind.LINEAR, i) for i in range(TARGETS))]
    motions = tuple(
        Motion(kind, i, None, 0.1, "z0" if i < TARGETS - 1 else "fine", "", False) for kind, i in ends
    )
    program = MillingProgram(
        door_id,
        placement,
        tuple(targets),
        motions,
        points=(first,),
        home=layout.home,
        tool=layout.T_flange_tool,
    )
    return render_target_file(program, run_id)
