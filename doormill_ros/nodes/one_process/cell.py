"""All nodes of the cell composed into one process, on simulated hardware."""

from __future__ import annotations

import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from types import TracebackType
from typing import Any

import rclpy
import yaml

from doormill_ros.cell.graph.door_sensors import chosen_sensors, node_of
from doormill_ros.cell.graph.node_names import (
    ABB_BRIDGE,
    BAG_RECORDER,
    CAMERA_SIMULATOR,
    CONTROLLER_SIMULATOR,
    DOOR_LOCALIZER,
    DOOR_SHARES,
    MODEL_MONITOR,
    OPERATOR_PAGE,
    PATH_GENERATOR,
    SENSOR_SIMULATOR,
)
from doormill_ros.cell.graph.two_robots import in_robot
from doormill_ros.cell.output.run_folder import RunFolder
from doormill_ros.cell.output.summary import RunSummary
from doormill_ros.cell.places.layout import CAMERA, load_layout
from doormill_ros.files import write_atomically
from doormill_ros.interrupts import Terminated
from doormill_ros.localization.sensors.registry import CELL_SENSORS, registered
from doormill_ros.nodes.abb_bridge import AbbBridge
from doormill_ros.nodes.bag_recorder import BagRecorder
from doormill_ros.nodes.base.chosen_values import check_values
from doormill_ros.nodes.base.managed_node import ManagedNode
from doormill_ros.nodes.base.robots import ROBOTS, robot_arguments
from doormill_ros.nodes.door_localizer import DoorLocalizer
from doormill_ros.nodes.door_shares import DoorShares
from doormill_ros.nodes.model_monitor import ModelMonitor
from doormill_ros.nodes.one_process.cell_driver import CellDriver
from doormill_ros.nodes.operator_page import OperatorPage
from doormill_ros.nodes.path_generator import PathGenerator
from doormill_ros.nodes.process.composition import Composition
from doormill_ros.nodes.process.run import check_start
from doormill_ros.nodes.recipe_database import RecipeDatabaseNode
from doormill_ros.nodes.sensing.sensor_localizer import SensorLocalizer
from doormill_ros.nodes.sensing.sensors_parameter import SENSORS_PARAMETER
from doormill_ros.nodes.simulated.camera_simulator import CameraSimulator
from doormill_ros.nodes.simulated.controller_simulator import ControllerSimulator
from doormill_ros.nodes.simulated.sensor_simulator import SensorSimulator
from doormill_ros.nodes.simulated.shared_door_judge import SharedDoorJudge
from doormill_ros.operator.access.token import Keys
from doormill_ros.simulation.robot_cell import RobotCell

#: Longest wait for each stage [s]: its devices are played by the processor that also has to answer them.
PATIENCE = 60.0
_PATIENT = {f"limit.{stage}": PATIENCE for stage in ("recipe", "picture", "targets", "request", "ready")}
#: Longest silence of a node or a folder [s]: who shares an interpreter with all others dies with them, or not at all.
SILENCE = 30.0
#: Topics of one name for a whole network; a cell in a namespace has its own.
GLOBAL = ("tf", "tf_static", "diagnostics")

NODES: tuple[Callable[..., ManagedNode], ...] = (BagRecorder, RecipeDatabaseNode)
#: Nodes whose parameters the user of the one-process cell chooses.
_CHOSEN: dict[str, type[ManagedNode]] = {
    CAMERA_SIMULATOR: CameraSimulator,
    CONTROLLER_SIMULATOR: ControllerSimulator,
    OPERATOR_PAGE: OperatorPage,
    PATH_GENERATOR: PathGenerator,
}

#: Who has to know which sensors there are, beside these themselves.
SENSOR_NODES = (DOOR_LOCALIZER, ABB_BRIDGE, CAMERA_SIMULATOR, SENSOR_SIMULATOR)


@dataclass(frozen=True)
class CellOptions:
    """What the user of the one-process cell may choose.

    Attributes:
        parameters: By node name.
        page: Serve the operator's page, and question inspected doors.
        token: Allows control from that page, or one for each role; None: it only shows.
        namespace: Of every node, such as "/cell1"; empty: none. Cells in namespaces of their own share nothing.
        controller: The controller of doors that were milled before; None for one of the cell's own.
        sensors: What finds the door, the first one mills; empty for those of config/cell.yaml.
        robots: 1, or 2 for one on either side of the door, in namespaces of their own.
    """

    parameters: dict[str, dict[str, Any]] = field(default_factory=dict)
    page: bool = False
    token: str | Keys | None = field(default=None, repr=False)
    namespace: str = ""
    controller: RobotCell | None = None
    sensors: tuple[str, ...] = ()
    robots: int = 1

    def check(self) -> None:
        """Judge what can be judged before there are nodes, and before anything of an earlier run is removed.

        Raises:
            BadParameterError: A node would not take its value, or the list of sensors is none.
            BadCellFile: The cell's file is of no use.
            BadSensorFile: A sensor is named that does not exist.
            RosArgumentsError: ROS 2 does not start here, such as for its domain.
        """
        for node, values in self.parameters.items():
            if node in _CHOSEN:
                check_values(node, _CHOSEN[node], values)
        self.finders()
        check_start(self.namespace)

    def millers(self, folder: RunFolder) -> list[Callable[[], ManagedNode]]:
        """Makers of the nodes of the robot, or of both and of those that they share."""
        if self.robots == 1:
            return [PathGenerator, AbbBridge, partial(ControllerSimulator, self.controller)]
        found: list[Callable[[], ManagedNode]] = []
        names = self.sensors or chosen_sensors(load_layout())
        finders = tuple(node_of(name) for name in names)
        for robot in ROBOTS:
            place = in_robot(robot)
            folder.controller_of(place).mkdir(parents=True, exist_ok=True)
            own: dict[type[ManagedNode], dict[str, Any]] = {
                PathGenerator: {"share": robot},
                AbbBridge: {
                    "shared": True,
                    "address": folder.controller_of(place),
                    "archive": folder.targets / place,
                },
                ControllerSimulator: {"share": robot, "home": folder.controller_of(place)},
            }
            for node, values in own.items():
                arguments = robot_arguments(robot, values, self.namespace, finders)
                found.append(partial(node, cli_args=arguments))
        return [*found, SharedDoorJudge, DoorShares]

    def finders(self) -> list[Callable[[], ManagedNode]]:
        """Makers of the nodes that find the door, and of who plays their sensors' drivers.

        Raises:
            BadParameterError: The list of sensors is none.
            BadSensorFile: It names one that does not exist.
        """
        names = self.sensors or chosen_sensors(load_layout())
        beside = [partial(SensorLocalizer, name) for name in registered(names)]
        camera = [DoorLocalizer] if CAMERA in names else []
        return [*camera, *beside, *([SensorSimulator] if beside else [])]

    def arguments(self, folder: RunFolder) -> list[str]:
        """ROS arguments that put everything the nodes write into the run's folder; leaves their parameters there."""
        chosen: dict[str, dict[str, Any]] = {
            BAG_RECORDER: {"bag": folder.bag},
            ABB_BRIDGE: {
                "address": folder.controller,
                "archive": folder.targets,
                "limit.sign_of_life": SILENCE,
                "limit.answer": SILENCE,
                **_PATIENT,
            },
            DOOR_SHARES: {"note": folder.targets, **_PATIENT},
            CONTROLLER_SIMULATOR: {"home": folder.controller, "gauged": self.page},
            OPERATOR_PAGE: {"history": folder.root, "audit": folder.audit, "robots": self.robots},
            PATH_GENERATOR: {"models": folder.models},
            MODEL_MONITOR: {
                "inspections": folder.inspections,
                "bags": folder.shift or folder.root,
                "models": folder.models,
            },
        }
        for node in (*SENSOR_NODES, *CELL_SENSORS) if self.sensors else ():
            chosen.setdefault(node, {})[SENSORS_PARAMETER.name] = ",".join(self.sensors)
        for node, values in self.parameters.items():
            chosen.setdefault(node, {}).update(values)
        arguments = ["cell", "--ros-args"]
        if self.namespace:
            remapped = [("__ns", self.namespace), *((f"/{name}", name) for name in GLOBAL)]
            arguments += [part for old, new in remapped for part in ("-r", f"{old}:={new}")]
        # A node in a namespace is not named by -p.
        document = {
            f"/**/{node}": {"ros__parameters": {name: _plain(value) for name, value in values.items()}}
            for node, values in chosen.items()
        }
        write_atomically(folder.parameters, yaml.safe_dump(document))
        return [*arguments, "--params-file", str(folder.parameters)]


def _plain(value: Any) -> Any:
    """A value as a parameter file holds it."""
    return str(value) if isinstance(value, Path) else value


class Cell:
    """The running cell; a context manager.

    Args:
        folder: Where the run's files go; prepared by the caller.
        options: Parameters of the nodes.
    """

    def __init__(self, folder: RunFolder, options: CellOptions | None = None) -> None:
        self._folder = folder
        options = options or CellOptions()
        nodes: list[Callable[[], ManagedNode]] = [
            *NODES,
            CameraSimulator,
            *options.finders(),
            *options.millers(folder),
        ]
        if options.page:
            nodes += [ModelMonitor, partial(OperatorPage, options.token)]
        self._composition = Composition(options.arguments(folder), nodes, CellDriver)

    def __enter__(self) -> Cell:
        self._composition.__enter__()
        try:
            self._composition.driver.wait_for_action()
        except BaseException:
            self._composition.__exit__(None, None, None)
            raise
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._composition.__exit__(kind, error, trace)

    def mill(self, door_id: str, progress: Callable[[str, float], None] | None = None) -> RunSummary:
        """Mill one door and sum up; a refused door gives a summary too.

        Args:
            door_id: Which door.
            progress: Called with the stage's name and 0..1.

        Raises:
            StageTimeoutError: The action did not end.
        """
        return self._composition.driver.mill(door_id, self._folder, progress or (lambda stage, share: None))

    def stay(self) -> None:
        """Keep the cell up until the process is interrupted."""
        with suppress(KeyboardInterrupt, Terminated):
            while rclpy.ok():
                time.sleep(0.1)


def run_once(
    door_id: str,
    folder: Path,
    options: CellOptions | None = None,
    progress: Callable[[str, float], None] | None = None,
    milled: Callable[[RunSummary], None] | None = None,
) -> RunSummary:
    """Bring the cell up, mill one door, take it down, write summary.json.

    With the operator's page, `milled` is called after that door and the cell stays up until interrupted.
    """
    (options or CellOptions()).check()
    return run_in(RunFolder(folder.resolve()), door_id, options, progress, milled)


def run_in(
    run_folder: RunFolder,
    door_id: str,
    options: CellOptions | None = None,
    progress: Callable[[str, float], None] | None = None,
    milled: Callable[[RunSummary], None] | None = None,
) -> RunSummary:
    """As `run_once`, for a folder that may belong to a shift; its path is absolute, and its options were judged."""
    run_folder.prepare()
    with Cell(run_folder, options) as cell:
        summary = cell.mill(door_id, progress)
        if options is not None and options.page:
            summary.write(run_folder.summary)
            if milled is not None:
                milled(summary)
            cell.stay()
    summary.write(run_folder.summary)
    return summary
