"""The robot's side of a run: the project's RAPID modules in one continuous run on the virtual controller.

A plant clamps one door after the other. What is milled is taken from the motions alone, beside the door that stands in
the clamp at that moment; nothing of what the program believes is asked.
"""

from __future__ import annotations

import logging
import os
import random
import threading
import time
from collections.abc import Callable

from doormill_ros.abb import signals
from doormill_ros.abb.errors import AbbError
from doormill_ros.robot.description import load_robot
from doormill_ros.simulation.controller.cabinet.cell import DOOR_CLAMPED
from doormill_ros.simulation.controller.cabinet.io_port import FolderIo
from doormill_ros.simulation.controller.controller import EXPECTED_DOOR, VirtualController
from doormill_ros.simulation.controller.motions.arm import ControllerArm
from doormill_ros.simulation.controller.operation.panel import OrderRefusedError
from doormill_ros.simulation.controller.rapid.machine import Dialog, Move
from support.faults.scenario import Scenario
from support.faults.world import DOORS, World, is_milling

#: How long a plant leaves a door in the clamp that was milled [s]; a PLC has to see DONE too.
_HOLD = 0.6
#: How long an operator looks at a door that comes to nothing before he takes it out [s].
_PATIENCE = (0.4, 2.0, 8.0, 8.0)


class WatchedIo(FolderIo):
    """Tells what the program is about to write."""

    def __init__(self, world: World, before_write: Callable[[str, int], None]) -> None:
        super().__init__(world.home)
        self._before_write = before_write

    def write(self, name: str, value: int) -> None:
        """Tell, then write."""
        self._before_write(name, value)
        super().write(name, value)


class WatchedController(VirtualController):
    """Tells every motion that it is given."""

    told: Callable[[Move], None]

    def move(self, move: Move) -> None:
        """Tell, then move."""
        self.told(move)
        super().move(move)


class RapidRobot:
    """Runs `main` again and again, with a plant that clamps doors and an operator who starts after stops."""

    def __init__(self, world: World, scenario: Scenario, incarnation: int) -> None:
        self.world = world
        self.scenario = scenario
        self.chance = random.Random(f"rapid/{scenario.seed}/{incarnation}")
        self.inside: tuple[int, str] | None = None  # the door in the clamp
        robot = load_robot("irb6600_175_255")
        arm = ControllerArm(robot.dh, robot.lower, robot.upper, robot.max_velocity)
        self.io = WatchedIo(world, self._before_write)
        self.controller = WatchedController(
            world.home,
            arm,
            io=self.io,
            on_stopped=self._operate,
        )
        self.controller.told = self._moved
        self.controller.teach_pendant.operator = self._answer
        self.controller.cell.set_input(DOOR_CLAMPED, 0)

    def run(self) -> None:
        """Door after door until killed."""
        threading.Thread(target=self._plant, name="plant", daemon=True).start()
        self.controller.panel.start()
        try:
            self.controller.serve()
        except AbbError as error:
            self.world.log("robot", event="stopped", reason=str(error)[:300])
            raise

    # The plant

    def _plant(self) -> None:
        while True:
            placement, door = self.world.door()[0] + 1, self.chance.choice(DOORS)
            self.world.clamp(placement, door)
            while not self.controller.pendant_lines:
                time.sleep(0.005)  # a name from before the start is forgotten
            self.controller.program.write(EXPECTED_DOOR, f'"{door}"')
            self.inside = (placement, door)
            self.controller.cell.set_input(DOOR_CLAMPED, 1)
            self._until_done(placement)
            self.controller.cell.set_input(DOOR_CLAMPED, 0)
            time.sleep(self.chance.uniform(0.02, 0.1))
            self.inside = None

    def _until_done(self, placement: int) -> None:
        begin, patience = time.monotonic(), self.chance.choice(_PATIENCE)
        doubled = "duplicate" in self.scenario.kind and self.chance.random() < 0.5
        restarted = "restarts of the controller" in self.scenario.kind and self.chance.random() < 0.4
        while True:
            time.sleep(0.01)
            if self.io.read(signals.DONE) and self._done == placement:
                time.sleep(_HOLD)
                return
            asked = self.io.read(signals.REQUEST)
            if asked and doubled:
                self.world.log("faults", what=self.scenario.kind)
                time.sleep(self.chance.choice([0.004, 0.02, 0.06]))
                return
            if asked and restarted:
                restarted = False
                self.world.log("faults", what=self.scenario.kind)
                time.sleep(self.chance.uniform(0.0, 0.3))
                self.controller.panel.warm_start()
            busy = asked or self.io.read(signals.BUSY)
            if not busy and time.monotonic() - begin > patience:
                return
            if self.io.read(signals.FAULT) and time.monotonic() - begin > 4.0 * patience:
                return

    # The operator

    def _operate(self, controller: VirtualController) -> None:
        state = controller.panel.state
        try:
            if not controller.panel.motors_on:
                controller.panel.motors(True)
            if state.pointer_lost:
                controller.panel.pointer_to_main()
            if not controller.panel.start_wanted:
                controller.panel.start()
        except OrderRefusedError:
            time.sleep(0.01)

    def _answer(self, dialog: Dialog) -> str:
        """The first button; a robot that is away from home is jogged there, which this process cannot."""
        if not self._at_home():
            os._exit(0)
        return next(text for text, _ in dialog.buttons if text)

    def _at_home(self) -> bool:
        home = self.controller.program.read("jposHome")[0]
        now = self.controller.current_joints()
        return all(abs(a - b) < 1.0 for a, b in zip(now, home, strict=True))

    # What is seen of the program

    _done = 0

    def _moved(self, move: Move) -> None:
        if move.kind == "MoveAbsJ":
            return
        x, y, z = move.target[0]
        if is_milling(x):
            placement, door = self.inside or (0, "none")
            self.world.log("robot", event="moved", placement=placement, door=door, y=y, z=z)

    def _before_write(self, name: str, value: int) -> None:
        placement, door = self.inside or (0, "none")
        if name == signals.REQUEST and value == 1 and not self.io.read(name):
            self.world.log("robot", event="request", placement=placement)
        elif name == signals.DONE and value == 1 and not self.io.read(name):
            self._done = placement
            self.world.log("robot", event="milled", placement=placement, door=door)
        elif name == signals.FAULT and value == 1 and not self.io.read(name):
            reason = self.world.home / signals.REFUSED_FILE
            text = reason.read_text() if reason.exists() else ""
            self.world.log("robot", event="refused", placement=placement, reason=text.replace("\n", " "))


def rapid_process(world: World, scenario: Scenario, incarnation: int) -> None:
    """Entry of the process."""
    logging.disable(logging.CRITICAL)
    if "early" in scenario.kind and incarnation == 0:
        world.log("faults", what=scenario.kind)
    RapidRobot(world, scenario, incarnation).run()
