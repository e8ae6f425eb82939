"""The robot's side of a run with the RAPID modules themselves, on the virtual controller."""

from __future__ import annotations

import random
from collections.abc import Callable

from doormill_ros.abb import signals
from doormill_ros.abb.errors import AbbError
from doormill_ros.robot.description import load_robot
from doormill_ros.simulation.controller.arm import ControllerArm
from doormill_ros.simulation.controller.controller import VirtualController
from doormill_ros.simulation.controller.io_port import FolderIo
from support.faults.scenario import Scenario
from support.faults.world import DOORS, World, digest, height

_PERSISTENT = ("seenRuns", "seenNext")


class WatchedIo(FolderIo):
    """Tells what the program is about to write."""

    def __init__(self, world: World, before_write: Callable[[str, int], None]) -> None:
        super().__init__(world.home)
        self._before_write = before_write

    def write(self, name: str, value: int) -> None:
        """Tell, then write."""
        self._before_write(name, value)
        super().write(name, value)


class RapidRobot:
    """Runs `main` of rapid/DoorMill.mod again and again and logs what it accepts."""

    def __init__(self, world: World, scenario: Scenario, incarnation: int) -> None:
        self.world = world
        self.chance = random.Random(f"rapid/{scenario.seed}/{incarnation}")
        self.placement = 0
        self.requested = False
        self.accepted = False
        robot = load_robot("irb6600_175_255")
        arm = ControllerArm(robot.dh, robot.lower, robot.upper, robot.max_velocity)
        self.io = WatchedIo(world, self._before_write)
        self.controller = VirtualController(world.home, arm, io=self.io, patience=6.0)
        self._restore()

    def run(self) -> None:
        """Door after door until killed."""
        while True:
            self.requested = self.accepted = False
            placement = self.world.door()[0] + 1
            self.placement = placement
            self.world.clamp(placement, self.chance.choice(DOORS))
            self.controller.program.write("expectedDoor", f'"{self.world.door()[1]}"')
            try:
                self.controller.run()
            except AbbError as error:
                self.world.log("robot", event="stopped", placement=placement, reason=str(error)[:200])
            if self.io.read(signals.FAULT):
                reason = self.controller.program.read("refusal")
                self.world.log("robot", event="refused", placement=placement, reason=str(reason))

    def _before_write(self, name: str, value: int) -> None:
        if name == signals.REQUEST and value == 1 and not self.requested:
            self.requested = True
            self.world.log("robot", event="request", placement=self.placement)
        if name == signals.BUSY and value == 1 and not self.accepted:
            # The program has accepted the file: what it has in memory is what it will mill.
            self.accepted = True
            self._keep()
            read = self.controller.program.read
            planned = next((p for p in self.world.entries("planned") if p["run"] == read("runId")), None)
            self.world.log(
                "robot",
                event="milled",
                placement=self.placement,
                door=self.world.door()[1],
                sha=self._content(planned),
                run=read("runId"),
            )

    def _content(self, planned: dict | None) -> str:
        """The planned file's digest, if every number in the program's memory is the planned one."""
        read = self.controller.program.read
        if planned is None:
            return digest(b"nobody planned this")
        same = read("doorId") == planned["door"] and read("recipeVersion") == planned["placement"]
        same = same and (read("targetCount"), read("moveCount")) == (14, 14)
        heights = [target[0][2] for target in read("targets")[:14]]
        same = same and all(abs(z - 1000.0 * height(planned["placement"])) < 0.01 for z in heights)
        return planned["sha"] if same else digest(b"not what was planned")

    def _keep(self) -> None:
        """PERS data outlive the program."""
        values = {name: self.controller.program.read(name) for name in _PERSISTENT}
        quoted = ",".join(f'"{run}"' for run in values["seenRuns"])
        self.world.replace("pers", f"[{quoted}]\n{int(values['seenNext'])}\n")

    def _restore(self) -> None:
        path = self.world.root / "pers"
        if path.exists():
            for name, text in zip(_PERSISTENT, path.read_text().splitlines(), strict=True):
                self.controller.program.write(name, text)
