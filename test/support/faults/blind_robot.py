"""A robot that checks nothing: it mills whatever lies there when ready is high, to see the PC's part alone."""

from __future__ import annotations

import logging
import random
import time

from doormill_ros.abb import signals
from doormill_ros.simulation.controller.io_port import FolderIo
from doormill_ros.simulation.controller.rapid.errors import SignalError
from support.faults.scenario import Scenario
from support.faults.world import DOORS, World, digest

_READY_FALL_LIMIT = 6.0


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
            if not self._wait_ready(0, _READY_FALL_LIMIT):
                self.world.log("robot", event="ready does not fall")
                continue
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
            time.sleep(0.02)
            placement = self._clamp_next()
            self._request()
        patience = self.chance.choice([0.15, 1.0, 3.0, 3.0])
        if not self._wait_ready(1, patience):
            self.world.log("robot", event="gave up", placement=placement)
            return
        self._read_and_mill(placement)

    def _read_and_mill(self, placement: int) -> None:
        data = self._read_slowly()
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

    def _read_slowly(self) -> bytes:
        """Line by line with pauses, as ReadStr does: what is overwritten meanwhile reads mixed."""
        pause = self.scenario.options.get("read_pause", 0.0)
        try:
            with (self.world.home / signals.TARGET_FILE).open("rb", buffering=0) as file:
                data = b""
                while chunk := file.read(128):
                    data += chunk
                    time.sleep(pause)
                return data
        except OSError:
            return b""

    def _request(self) -> None:
        self.number = int(self._kept("number", "0")) + 1
        self.world.replace("number", str(self.number))
        (self.world.home / signals.REQUEST_FILE).write_text(f"{self.number}\n")
        self.io.write(signals.REQUEST, 1)

    def _clamp_next(self) -> int:
        placement = self.world.door()[0] + 1
        self.world.clamp(placement, self.chance.choice(DOORS))
        return placement

    def _wait_ready(self, value: int, limit: float) -> bool:
        end = time.monotonic() + limit
        while self.io.read(signals.READY) != value:
            if time.monotonic() > end:
                return False
            time.sleep(0.002)
        return True

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
        world.log("faults", what=f"the robot program stops: {error}")  # a full disk is full for it too
