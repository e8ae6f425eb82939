"""A robot that checks nothing: it mills whatever lies there when ready is high, to see the PC's part alone.

No time decides what it mills. It makes its next request once the PC says that ready is low and not being raised: a
real robot needs seconds for what the PC does in milliseconds, and one that is quicker is protected by the number of
the ready signal alone, which this one does not look at. It sees signal and file in one moment, however long it is kept
from running between the two. How it gives doors up goes by how far the PC got.
"""

from __future__ import annotations

import logging
import os
import random
import time
from collections.abc import Callable
from pathlib import Path
from typing import BinaryIO

from doormill_ros.abb import signals
from doormill_ros.abb.handshake.state import HandshakeState as State
from doormill_ros.simulation.controller.cabinet.io_port import FolderIo
from doormill_ros.simulation.controller.rapid.errors import SignalError
from support.faults.scenario import Scenario
from support.faults.world import DOORS, World, digest

_LOOK = 0.002  # s
#: How far the PC gets with a door, in order.
_COURSE = [
    state.value for state in (State.REQUESTED, State.WRITING, State.VERIFYING, State.RAISING, State.READY)
]
#: Where ready may be high, or become so.
_RAISED = {state.value for state in (State.RAISING, State.READY, State.ACKNOWLEDGED, State.CLEARING)}
#: How far the PC gets with a door that is given up; "": the robot waits for its file.
_PATIENCE = ("requested", "writing", "raising", "", "", "")


class BlindRobot:
    """Asks for paths in the order of the RAPID program, and believes every file."""

    def __init__(self, world: World, scenario: Scenario, incarnation: int) -> None:
        self.world = world
        self.io = FolderIo(world.home)
        self.scenario = scenario
        self.number = 0
        self.chance = random.Random(f"robot/{scenario.seed}/{incarnation}")

    def run(self) -> None:
        """Door after door until killed."""
        while True:
            self.io.write(signals.REQUEST, 0)
            self.io.write(signals.BUSY, 0)
            self._until(self._pc_rests)
            self._one_door()
            time.sleep(self.chance.uniform(0.0, 0.03))

    def _one_door(self) -> None:
        placement = self._clamp_next()
        self.io.write(signals.FAULT, 0)
        self.io.write(signals.DONE, 0)
        self.world.log("robot", event="request", placement=placement)
        self._request()
        if "duplicate" in self.scenario.kind and self.chance.random() < 0.5:
            # An operator starts the program again: the request falls, another door, it rises.
            self.world.log("faults", what=self.scenario.kind)
            time.sleep(self.chance.choice([0.004, 0.02, 0.06]))
            self.io.write(signals.REQUEST, 0)
            self._until(self._pc_rests)
            placement = self._clamp_next()
            self._request()
        patience, seen = self.chance.choice(_PATIENCE), list[bytes]()
        self._until(lambda: self._pc_reached(patience) or self._sees(seen))
        if seen:
            self._mill(placement, seen[0])
        else:
            self.world.log("robot", event="gave up", placement=placement)

    def _mill(self, placement: int, data: bytes) -> None:
        door_id = self.world.door()[1]
        self.world.log("robot", event="offered", placement=placement, door=door_id, sha=digest(data))
        run_id = digest(data)
        self.world.log(
            "robot", event="milled", placement=placement, door=door_id, sha=digest(data), run=run_id
        )
        self.io.write(signals.BUSY, 1)
        self.io.write(signals.REQUEST, 0)
        time.sleep(self.chance.uniform(0.0, 0.05))
        self.io.write(signals.BUSY, 0)
        self.io.write(signals.DONE, 1)

    def _sees(self, seen: list[bytes]) -> bool:
        """Whether ready is high; what lies there then is added, nothing where there is no file."""
        while True:
            try:
                level = self._level.open("rb")
            except FileNotFoundError:
                return False
            with level:
                if level.read().strip() != b"1":
                    return False
                target = self._target(level)
                if target is not None:
                    seen.append(target)
                    return True

    @property
    def _level(self) -> Path:
        return self.world.home / signals.IO_FOLDER / signals.READY

    def _stands(self, level: BinaryIO) -> bool:
        """Nobody wrote ready since its file was opened: who writes a signal replaces its file."""
        return os.path.samestat(os.fstat(level.fileno()), self._level.stat())

    def _target(self, level: BinaryIO) -> bytes | None:
        """The target file that lay there while ready had that level; None when it has not any more.

        Read line by line with pauses, as ReadStr does: what is overwritten meanwhile reads mixed.
        """
        pause = self.scenario.options.get("read_pause", 0.0)
        try:
            file = (self.world.home / signals.TARGET_FILE).open("rb", buffering=0)
        except FileNotFoundError:
            return b"" if self._stands(level) else None
        with file:
            if not self._stands(level):
                return None
            data = b""
            while chunk := file.read(128):
                data += chunk
                time.sleep(pause)
            return data

    def _request(self) -> None:
        self.number = int(self._kept("number", "0")) + 1
        self.world.replace("number", str(self.number))
        (self.world.home / signals.REQUEST_FILE).write_text(f"{self.number}\n")
        self.io.write(signals.REQUEST, 1)

    def _clamp_next(self) -> int:
        placement = self.world.door()[0] + 1
        self.world.clamp(placement, self.chance.choice(DOORS))
        return placement

    def _pc_rests(self) -> bool:
        """Ready is low, and the PC will not raise it for a request that has fallen."""
        # In this order: what the PC says it said before the signal is looked at.
        return self._pc_state() not in _RAISED and not self.io.read(signals.READY)

    def _pc_reached(self, state: str) -> bool:
        """Whether the PC got as far as that with the request, or beyond; never for ""."""
        now = self._pc_state()
        return bool(state) and now in _COURSE and _COURSE.index(now) >= _COURSE.index(state)

    def _pc_state(self) -> str:
        """The state of the handshake, "" before the first one."""
        return str(self.world.last("bridge").get("state", ""))

    def _until(self, condition: Callable[[], bool]) -> None:
        """Without end: a run that hangs is ended by who started it."""
        while not condition():
            time.sleep(_LOOK)

    def _kept(self, name: str, default: str) -> str:
        """PERS data: kept when the program is killed."""
        path = self.world.root / name
        return path.read_text() if path.exists() else default


def blind_process(world: World, scenario: Scenario, incarnation: int) -> None:
    """Entry of the process."""
    logging.disable(logging.CRITICAL)
    if "early" in scenario.kind and incarnation == 0:
        world.log("faults", what=scenario.kind)
    try:
        BlindRobot(world, scenario, incarnation).run()
    except (OSError, SignalError) as error:
        world.log("ended", what=f"robot program: {error}")  # a full disk is full for it too
