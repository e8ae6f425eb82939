"""Node /controller_simulator: a controller that runs our RAPID program and moves a compliant robot."""

from __future__ import annotations

import threading
from pathlib import Path
from typing import Any

from std_msgs.msg import Header

from doormill_interfaces.msg import DoorPlacement, DoorRecipe, RunResult, TargetArray
from doormill_ros.cell.layout import load_layout
from doormill_ros.cell.summary import TOLERANCE
from doormill_ros.frames import BASE_FRAME, DOOR_FRAME
from doormill_ros.messages.from_message import program_of, recipe_of, transform_of
from doormill_ros.nodes import topics
from doormill_ros.nodes.convert.executed import executed_message, milled_message
from doormill_ros.nodes.managed_node import ManagedNode
from doormill_ros.nodes.reporting_node import OK, NodeParameter
from doormill_ros.robot.description import load_robot
from doormill_ros.simulation.controller.arm import ControllerArm
from doormill_ros.simulation.controller.rws_server.cabinet import Cabinet
from doormill_ros.simulation.controller.rws_server.server import serve
from doormill_ros.simulation.milled_part import inspect
from doormill_ros.simulation.robot_cell import RobotCell, RobotCellRun, load_effects

STOP_LIMIT = 5.0  # s


class ControllerSimulator(ManagedNode):
    """Starts the RAPID program for each clamped door and inspects what it milled."""

    PARAMETERS = (
        NodeParameter("home", "out/controller/HOME", "folder behind the controller's HOME:"),
        NodeParameter(
            "effects", "", "YAML list of what the simulated robot hides; empty: joint springs only"
        ),
        NodeParameter("time_scale", 0.0, "simulated over real seconds; 0: as fast as possible", 0.0, 1e6),
        NodeParameter(
            "spindle_works", True, "false: the spindle never comes to speed, the program stops with a fault"
        ),
        NodeParameter(
            "web_services", "", "Robot Web Services over HOME and signals: rws1, rws2; empty: none"
        ),
        NodeParameter("web_services_port", 8090, "their TCP port on 127.0.0.1; 0: any free one", 0, 65535),
        NodeParameter(
            "web_services_certificates", "out/controller", "folder that rws2 writes controller.crt and key to"
        ),
    )

    def __init__(self, **kwargs: Any) -> None:
        super().__init__("controller_simulator", **kwargs)

    def setup(self) -> None:
        """Build the robot; subscribe."""
        effects = self.value("effects")
        # The published geometry is all that the truth takes from the robot's description.
        robot = load_robot(load_layout().robot)
        self._cell = RobotCell(
            Path(self.value("home")),
            ControllerArm(robot.dh, robot.lower, robot.upper, robot.max_velocity),
            load_effects(Path(effects)) if effects else (),
            self.value("time_scale") or None,
            self.value("spindle_works"),
        )
        self._web_services = serve(
            self.value("web_services"),
            Cabinet.create(Path(self.value("home")), io=self._cell.io),
            self.value("web_services_port"),
            Path(self.value("web_services_certificates")),
        )
        self._recipe: DoorRecipe | None = None
        self._placement: DoorPlacement | None = None
        self._targets: TargetArray | None = None
        self._run: RobotCellRun | None = None
        self._thread: threading.Thread | None = None
        self._executed = self.publisher(topics.EXECUTED_PATH)
        self._milled = self.publisher(topics.MILLED_DOOR)
        self.subscribe(topics.DOOR_RECIPE, self._take_recipe)
        self.subscribe(topics.DOOR_PLACEMENT, self._take_placement)
        self.subscribe(topics.PATH_TARGETS, self._take_targets)
        self.subscribe(topics.RUN_RESULT, self._take_result)

    def stop(self) -> None:
        """Stop the program and the robot."""
        self._halt()

    def teardown(self) -> None:
        """End the web services."""
        if self._web_services is not None:
            self._web_services.stop()

    def _take_recipe(self, recipe: DoorRecipe) -> None:
        self._recipe = recipe

    def _take_targets(self, targets: TargetArray) -> None:
        if targets.accepted:
            self._targets = targets

    def _take_result(self, result: RunResult) -> None:
        # A refused door is taken out by the operator, who also stops the waiting program.
        if not result.success and self._placement is not None and result.run_id == self._placement.run_id:
            self._halt()
            self._cell.reset()

    def _take_placement(self, placement: DoorPlacement) -> None:
        if self._placement is not None and placement.run_id == self._placement.run_id:
            return
        self._halt()
        self._placement = placement
        self._run = self._cell.start(placement.door_id)
        self._thread = threading.Thread(
            target=self.guarded(self._mill), args=(self._run, placement), name="controller", daemon=True
        )
        self._thread.start()

    def _halt(self) -> None:
        if self._run is not None:
            self._run.stop()
        if self._thread is not None:
            self._thread.join(STOP_LIMIT)
        self._run = self._thread = None

    def _mill(self, run: RobotCellRun, placement: DoorPlacement) -> None:
        self.report(OK, "program running", door_id=placement.door_id)
        if run.execute():
            self._inspect(run, placement)
        else:
            self.report(OK, "program stopped", door_id=placement.door_id)

    def _inspect(self, run: RobotCellRun, placement: DoorPlacement) -> None:
        targets, recipe = self._targets, self._recipe
        if targets is None or recipe is None or targets.run_id != placement.run_id:
            return
        program, door = program_of(targets), recipe_of(recipe)
        executed = run.executed_path(program)
        header = Header(stamp=self.get_clock().now().to_msg(), frame_id=BASE_FRAME)
        self._executed.publish(executed_message(executed, header, placement))
        T_base_door = transform_of(placement.pose)
        corrected = inspect(door, T_base_door, executed)
        uncorrected = inspect(door, T_base_door, self._cell.execute_uncorrected(program))
        header = Header(stamp=self.get_clock().now().to_msg(), frame_id=DOOR_FRAME)
        self._milled.publish(milled_message(door, corrected, uncorrected, TOLERANCE, header, placement))
        self.report(OK, "door milled", door_id=placement.door_id, deviation=corrected.max_deviation)
