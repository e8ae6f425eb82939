"""Every node of the package on its own, and good messages for whatever it listens to."""

from __future__ import annotations

import array
import copy
from dataclasses import dataclass, field
from inspect import signature
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from geometry_msgs.msg import Point
from rclpy.context import Context
from rclpy.parameter import Parameter
from rclpy.serialization import deserialize_message, serialize_message

from doormill_interfaces.msg import DoorRecipe, SensorReading
from doormill_ros.cell.places.layout import CAMERA
from doormill_ros.localization.gige.library import Aravis
from doormill_ros.localization.sensors.registry import CELL_SENSORS
from doormill_ros.nodes.abb_bridge import AbbBridge
from doormill_ros.nodes.bag_recorder import BagRecorder
from doormill_ros.nodes.base import topics
from doormill_ros.nodes.base.reporting_node import ReportingNode
from doormill_ros.nodes.door_localizer import DoorLocalizer
from doormill_ros.nodes.door_shares import DoorShares
from doormill_ros.nodes.folder_camera import FolderCamera
from doormill_ros.nodes.gige_camera import GigeCamera
from doormill_ros.nodes.model_monitor import ModelMonitor
from doormill_ros.nodes.operator_page import OperatorPage
from doormill_ros.nodes.recipe_database import RecipeDatabaseNode
from doormill_ros.nodes.sensing.sensor_localizer import SensorLocalizer
from doormill_ros.nodes.simulated.controller_simulator import ControllerSimulator
from doormill_ros.nodes.simulated.sensor_simulator import SensorSimulator
from doormill_ros.nodes.simulated.shared_door_judge import SharedDoorJudge
from support.hostile.messages import filled
from support.package_nodes import reporting_nodes

RUNS = 12
#: Of nodes that think for long about each good message, or listen to all there is.
FEWER = {SharedDoorJudge: 3, BagRecorder: 2}
ALL_SENSORS = ",".join((CAMERA, *CELL_SENSORS))


@dataclass(frozen=True)
class Listener:
    """A node and what it is started with, beside what it always needs."""

    kind: type[ReportingNode]
    values: dict[str, Any] = field(default_factory=dict)
    arguments: dict[str, Any] = field(default_factory=dict)

    @property
    def name(self) -> str:
        return "-".join(
            [self.kind.__name__, *self.arguments, *self.values, *map(str, self.arguments.values())]
        )

    def up(self, context: Context, folder: Path) -> Any:
        """The active node, that nobody spins."""
        (folder / "HOME").mkdir()
        values = {"autostart": False, **_values_of(folder).get(self.kind, {}), **self.values}
        overrides = [Parameter(name, value=value) for name, value in values.items()]
        arguments = dict(self.arguments)
        if self.kind is GigeCamera:
            arguments["aravis"] = Aravis(SimpleNamespace(Camera=SimpleNamespace(new=_no_camera)), OSError)
        node: Any = self.kind(context=context, parameter_overrides=overrides, **arguments)
        node.trigger_configure()
        node.trigger_activate()
        assert node.active, node._health[1]
        return node


def listeners() -> list[Listener]:
    """Every node of the package, and once more where it listens to more or to others."""
    found = [Listener(kind) for kind in reporting_nodes() if kind is not SensorLocalizer]
    found += [Listener(SensorLocalizer, {"sensors": name}, {"sensor": name}) for name in CELL_SENSORS]
    return [
        *found,
        Listener(AbbBridge, {"shared": True, "sensors": f"{CAMERA},{next(iter(CELL_SENSORS))}"}),
        Listener(AbbBridge, {"gauge": True}),
        Listener(DoorShares, {"gauge": True}),
        Listener(DoorLocalizer, {"image_transport": "compressed"}),
    ]


def taps_of(node: Any) -> list[Any]:
    """Its subscriptions but those that only tell of signs of life, on which nothing is ever published."""
    return [tap for tap in node.subscriptions if "_alive/" not in tap.topic_name]


def feed(tap: Any, message: Any, number: int) -> None:
    """As the executor would."""
    given = serialize_message(message) if tap.raw else message
    if len(signature(tap.callback).parameters) > 1:
        tap.callback(given, {"source_timestamp": number, "publication_sequence_number": number})
    else:
        tap.callback(given)


def good_message(tap: Any, recorded: dict[str, bytes], run: int, sensor: str = "") -> Any:
    """One that was recorded on this topic, or of this type, or a generated one of the recorded run.

    Args:
        tap: Subscription.
        recorded: By topic.
        run: Which of several to take.
        sensor: Whose reading it is to be, if it is one.
    """
    if tap.topic_name in recorded:
        return deserialize_message(recorded[tap.topic_name], tap.msg_type)
    types = {f"/{topic.name}": topic.type for topic in topics.ALL}
    same = next((name for name in recorded if types.get(name) is tap.msg_type), None)
    if same is not None:
        return deserialize_message(recorded[same], tap.msg_type)
    recipe = deserialize_message(recorded[f"/{topics.DOOR_RECIPE.name}"], DoorRecipe)
    message = filled(tap.msg_type)
    for name in ("run_id", "door_id"):
        if hasattr(message, name):
            setattr(message, name, getattr(recipe, name))
    if isinstance(message, SensorReading):
        message.sensor = sensor
        _read(message, run, recorded)
    return message


def _read(reading: SensorReading, run: int, recorded: dict[str, bytes]) -> None:
    """Fill one of the three lists, in turn."""
    image = deserialize_message(recorded[f"/{topics.IMAGE.name}"], topics.IMAGE.type)
    reading.distances, reading.points, reading.pictures = array.array("d"), [], []
    if run % 3 == 0:
        reading.distances = array.array("d", [0.05] * 5)
    elif run % 3 == 1:
        reading.points = [Point(x=1.0, y=0.1 * number, z=0.5) for number in range(6)]
    else:
        reading.pictures = [copy.deepcopy(image)]


def _no_camera(_: object) -> Any:
    raise OSError("there is no camera")


def _values_of(folder: Path) -> dict[type[ReportingNode], dict[str, Any]]:
    home = str(folder / "HOME")
    return {
        AbbBridge: {"address": home, "archive": str(folder / "targets")},
        BagRecorder: {"bag": str(folder / "bag"), "catalogue": str(folder / "runs.db")},
        ControllerSimulator: {"home": home},
        DoorLocalizer: {"check_age": False},
        FolderCamera: {"folder": home},
        ModelMonitor: {name: str(folder / name) for name in ("inspections", "bags", "models")},
        OperatorPage: {"port": 0, "history": str(folder / "history")},
        RecipeDatabaseNode: {"database_url": f"sqlite:///{folder / 'recipes.db'}"},
        SensorSimulator: {"sensors": ALL_SENSORS},
    }
