"""Node /controller_simulator: a controller that runs our RAPID program and moves a compliant robot."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any, TypeVar

from std_msgs.msg import Header

from doormill_interfaces.msg import DoorPlacement, DoorRecipe, MilledDoor, RunResult, TargetArray
from doormill_ros.cell.graph.node_names import CONTROLLER_SIMULATOR
from doormill_ros.cell.graph.two_robots import SECOND
from doormill_ros.cell.output.gauged import note_gauged
from doormill_ros.cell.places.layout import load_layout
from doormill_ros.cell.places.tolerance import TOLERANCE
from doormill_ros.cell.run.waiting import wait
from doormill_ros.frames import BASE_FRAME, DOOR_FRAME
from doormill_ros.measurements.inspections.inspection_writer import (
    MeasuredPoints,
    inspection_texts,
    write_inspection,
)
from doormill_ros.messages.from_message import program_of, recipe_of, transform_of
from doormill_ros.nodes.base import topics
from doormill_ros.nodes.base.managed_node import ManagedNode
from doormill_ros.nodes.base.node_parameter import NodeParameter
from doormill_ros.nodes.base.reporting_node import OK
from doormill_ros.nodes.convert.executed import executed_message, milled_message, verdict_message
from doormill_ros.nodes.convert.inspection import inspection_message
from doormill_ros.nodes.simulated.simulated_shift import WORLD_PARAMETERS, SimulatedShift
from doormill_ros.robot.description import load_robot
from doormill_ros.simulation.controller.motions.arm import ControllerArm
from doormill_ros.simulation.controller.rws_server.running import served_cabinet
from doormill_ros.simulation.controller.rws_server.serving import VERSIONS, serve
from doormill_ros.simulation.judge.bodies import load_cell
from doormill_ros.simulation.judge.judged_door import judge_door
from doormill_ros.simulation.robot_cell import RobotCell, RobotCellRun, load_effects
from doormill_ros.simulation.spindle_load import SpindleWork
from doormill_ros.simulation.world.cutting_power import CutDoor
from doormill_ros.simulation.world.door_truth import GAUGE, LOAD
from doormill_ros.simulation.world.gauge import NOISE, gauge

STOP_LIMIT = 5.0  # s
#: So long recipe and targets of a milled door may come after it: topics have no common order [s].
KNOWN_LIMIT = 20.0
BAG = "bag"  #: of a run, beside its inspection

Message = TypeVar("Message", DoorRecipe, TargetArray)


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
            "web_services",
            "",
            "Robot Web Services over HOME and signals; empty: none",
            choices=("", *VERSIONS),
        ),
        NodeParameter("web_services_port", 8090, "their TCP port on 127.0.0.1; 0: any free one", 0, 65535),
        NodeParameter(
            "web_services_certificates", "out/controller", "folder that rws2 writes controller.crt and key to"
        ),
        NodeParameter(
            "clamped",
            True,
            "false: somebody opens the clamp of the door that stands; the next is clamped",
            live=True,
        ),
        NodeParameter(
            "share",
            "",
            "first or second: of two robots, whose rack it has; tell what was done, and leave the door to "
            "/shared_door_judge; empty: one robot",
        ),
        NodeParameter("gauged", False, "measure every milled door and tell it on door/inspection"),
        *WORLD_PARAMETERS,
        NodeParameter(
            "shift_began", 0.0, "begin of the shift [s since the epoch]; 0: of the node", 0.0, 1e11
        ),
        NodeParameter(
            "inspection",
            "",
            "folder beside the run's bag for the inspection of its door; empty: none is written",
        ),
    )

    def __init__(self, cell: RobotCell | None = None, **kwargs: Any) -> None:
        """Take the controller of doors that were milled before; None for one that is switched on with the node."""
        super().__init__(CONTROLLER_SIMULATOR, **kwargs)
        self._switched_on = cell

    def setup(self) -> None:
        """Build the robot; subscribe."""
        effects = self.value("effects")
        self._shift = SimulatedShift(
            self.value("world"), self.value("door_number"), self.value("shift_began")
        )
        self._cell = self._switched_on or switch_on(
            Path(self.value("home")),
            load_effects(Path(effects)) if effects else (),
            self.value("time_scale") or None,
            self.value("spindle_works"),
            self.value("share"),
        )
        self._web_services = serve(
            self.value("web_services"),
            served_cabinet(Path(self.value("home")), self._cell.io, lambda: self._cell.controller),
            self.value("web_services_port"),
            Path(self.value("web_services_certificates")),
        )
        # What it signaled before it was started is over, as after a real controller's restart.
        self._cell.reset()
        self._clamped = self.value("clamped")  # as it was last asked for
        self._ended = ""  # run whose door is out of the clamp
        self._told = threading.Condition()
        self._recipe: DoorRecipe | None = None
        self._placement: DoorPlacement | None = None
        self._targets: TargetArray | None = None
        self._run: RobotCellRun | None = None
        self._thread: threading.Thread | None = None
        self._executed = self.publisher(topics.EXECUTED_PATH)
        if self.value("share"):
            self._uncorrected = self.publisher(topics.UNCORRECTED_PATH)
        else:
            self._milled = self.publisher(topics.MILLED_DOOR)
            self._judged_cell = load_cell()
            self._verdict = self.publisher(topics.RUN_VERDICT)
            self._gauged = self.publisher(topics.DOOR_INSPECTION)
        self.subscribe(topics.DOOR_RECIPE, self._take_recipe)
        self.subscribe(topics.DOOR_PLACEMENT, self._take_placement)
        self.subscribe(topics.PATH_TARGETS.kept, self._take_targets)
        self.subscribe(topics.RUN_RESULT, self._take_result)
        self.when_set("clamped", self._move_clamp)

    def stop(self) -> None:
        """Stop the program and the robot."""
        self._halt()

    def teardown(self) -> None:
        """End the web services."""
        if self._web_services is not None:
            self._web_services.stop()

    def _move_clamp(self) -> None:
        clamped = self.value("clamped")
        if self._clamped and not clamped and self._run is not None:
            self._run.open_clamp()
        self._clamped = clamped

    def _take_recipe(self, recipe: DoorRecipe) -> None:
        with self._told:
            self._recipe = recipe
            self._give_work()
            self._told.notify_all()

    def _take_targets(self, targets: TargetArray) -> None:
        if targets.accepted:
            with self._told:
                self._targets = targets
                self._told.notify_all()

    def _take_result(self, result: RunResult) -> None:
        # A refused door is taken out by the operator, who also stops the waiting program; and whoever is started
        # after the end of a run hears of its door and of its end in any order.
        self._ended = result.run_id
        if result.success:
            return  # the program ends by itself
        waits = self._thread is not None and self._thread.is_alive()
        if waits and self._placement is not None and result.run_id == self._placement.run_id:
            self._halt()
            self._cell.reset()

    def _take_placement(self, placement: DoorPlacement) -> None:
        if self._placement is not None and placement.run_id == self._placement.run_id:
            return
        if placement.run_id == self._ended:
            return
        self._halt()
        self._cell.limits = self._shift.begin().limits
        with self._told:
            self._placement, self._cell.spindle.work = placement, None
            self._give_work()
            if not self.active:  # stopped by another thread since it was called
                return
            self._run = self._cell.start(placement.door_id)
            self._thread = threading.Thread(
                target=self.guarded(self._mill), args=(self._run, placement), name="controller", daemon=True
            )
            self._thread.start()

    def _give_work(self) -> None:
        """Tell the spindle which wood it meets, once door and place are those of one run."""
        recipe, placement = self._recipe, self._placement
        if recipe is None or placement is None or recipe.run_id != placement.run_id:
            return
        if self._cell.spindle.work is None:
            pictured = transform_of(placement.pose)
            door = CutDoor(recipe_of(recipe), self._shift.T_base_door(pictured))
            truth = self._shift.door
            self._cell.spindle.work = SpindleWork(door, truth.hardness, truth.drawn(LOAD))

    def _halt(self) -> None:
        with self._told:
            run, thread = self._run, self._thread
            self._run = self._thread = None
            self._told.notify_all()
        if run is not None:
            run.stop()
        if thread is not None:
            thread.join(STOP_LIMIT)

    def _of_run(self, run: RobotCellRun, latest: Callable[[], Message | None], run_id: str) -> Message | None:
        """The latest message once it is of that run; None where that does not come before its door goes."""

        def told() -> Message | None:
            message = latest()
            return message if message is not None and message.run_id == run_id else None

        wait(self._told, lambda: told() or self._run is not run, KNOWN_LIMIT)
        return told()

    def _publish(self, publisher: Any, message: Any) -> None:
        """Tell it unless the node was stopped meanwhile: its publishers are destroyed without waiting for a door."""
        with self._told:
            if self.active:
                publisher.publish(message)

    def _say(self, words: str, **values: Any) -> None:
        with self._told:
            if self.active:
                self.report(OK, words, **values)

    def _mill(self, run: RobotCellRun, placement: DoorPlacement) -> None:
        self._say("program running", door_id=placement.door_id)
        if run.execute():
            self._inspect(run, placement)
        else:
            self._say("program stopped", door_id=placement.door_id)

    def _inspect(self, run: RobotCellRun, placement: DoorPlacement) -> None:
        targets = self._of_run(run, lambda: self._targets, placement.run_id)
        if self.value("share"):
            if targets is not None:
                self._tell_share(run, placement, targets)
            return
        recipe = self._of_run(run, lambda: self._recipe, placement.run_id)
        if targets is None or recipe is None:
            # Nobody shall wait for what cannot come.
            self._publish(self._milled, MilledDoor(run_id=placement.run_id, door_id=placement.door_id))
            return
        program, door = program_of(targets), recipe_of(recipe)
        T_base_door = self._shift.T_base_door(transform_of(placement.pose))
        executed, uncorrected = (
            self._shift.executed(door, T_base_door, path)
            for path in (run.executed_path(program), self._cell.execute_uncorrected(program))
        )
        self._publish(self._executed, executed_message(executed, self._header(BASE_FRAME), placement))
        turning = run.spindle_turned(executed)
        judged = judge_door(door, T_base_door, executed, uncorrected, self._judged_cell, turning)
        header = self._header(DOOR_FRAME)
        self._publish(self._verdict, verdict_message(judged.verdict, header, placement))
        if self.value("inspection") or self.value("gauged"):
            noise = self._shift.door.drawn(GAUGE)
            self._tell_gauged(gauge(door, T_base_door, executed, noise), placement.run_id)
        parts = judged.corrected, judged.uncorrected
        self._publish(self._milled, milled_message(door, *parts, TOLERANCE, header, placement))
        self._say("door milled", door_id=placement.door_id, deviation=judged.corrected.worst)

    def _header(self, frame: str) -> Header:
        return Header(stamp=self.get_clock().now().to_msg(), frame_id=frame)

    def _tell_share(self, run: RobotCellRun, placement: DoorPlacement, targets: TargetArray) -> None:
        """What this robot did to the door, and would have done without correction; the former comes last."""
        program = program_of(targets)
        header = self._header(BASE_FRAME)
        uncorrected = self._cell.execute_uncorrected(program)
        self._publish(self._uncorrected, executed_message(uncorrected, header, placement))
        self._publish(self._executed, executed_message(run.executed_path(program), header, placement))
        self._say("share milled", door_id=placement.door_id)

    def _tell_gauged(self, points: MeasuredPoints, run_id: str) -> None:
        ended = self._shift.ended()
        # Before anybody can keep it: what is found without a note is taken for somebody's.
        note_gauged(Path(self.value("home")).parent, *inspection_texts(BAG, run_id, ended, NOISE, points))
        if self.value("inspection"):
            folder = Path(self.value("inspection"))
            write_inspection(folder, folder.parent / BAG, run_id, ended, NOISE, points)
        if self.value("gauged"):
            self._publish(self._gauged, inspection_message(points, run_id, ended, NOISE))


def switch_on(
    home: Path,
    effects: Iterable[Mapping[str, Any]] = (),
    time_scale: float | None = None,
    spindle_works: bool = True,
    share: str = "",
) -> RobotCell:
    """The robot of the cell's layout and its controller.

    Args:
        home: As of `RobotCell`, and likewise the three that follow.
        effects: What the robot hides.
        time_scale: Simulated over real seconds.
        spindle_works: False for a spindle that never comes to speed.
        share: "second" for the robot that has the second one's rack.
    """
    layout = load_layout()
    if share == SECOND:
        layout = replace(layout, rack=layout.rack_of_second)
    # The published geometry is all that the truth takes from the robot's description.
    robot = load_robot(layout.robot)
    arm = ControllerArm(robot.dh, robot.lower, robot.upper, robot.max_velocity)
    return RobotCell(home, arm, effects, time_scale, spindle_works, layout)
