"""Every topic of the cell once: its type and its quality of service; names are in `cell/graph/topic_names.py`."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import PoseStamped, TwistStamped
from nav_msgs.msg import Path
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import CameraInfo, CompressedImage, Image, JointState
from std_msgs.msg import Bool, String
from visualization_msgs.msg import MarkerArray

from doormill_interfaces.msg import (
    AbbStatus,
    ControllerState,
    DoorInspection,
    DoorLocalization,
    DoorPlacement,
    DoorRecipe,
    ExecutedPath,
    MilledDoor,
    ModelVerdict,
    RunResult,
    RunsVerdict,
    RunVerdict,
    SensorLocalization,
    SensorReading,
    SpindleLoad,
    TargetArray,
)
from doormill_ros.cell.graph import topic_names


def _qos(
    depth: int,
    durability: DurabilityPolicy = DurabilityPolicy.VOLATILE,
    reliability: ReliabilityPolicy = ReliabilityPolicy.RELIABLE,
) -> QoSProfile:
    return QoSProfile(
        depth=depth, history=HistoryPolicy.KEEP_LAST, reliability=reliability, durability=durability
    )


#: The latest value counts and late joiners get it.
STATE = _qos(1, DurabilityPolicy.TRANSIENT_LOCAL)
#: Every message counts, late joiners do not get old ones.
EVENT = _qos(10)
#: What a run is replayed from is kept for whom its publisher comes to know of a moment late, as a recorder that was
#: started with it. Nodes ask for EVENT or PICTURE, so that none acts on an old one.
KEPT_EVENT = _qos(10, DurabilityPolicy.TRANSIENT_LOCAL)
#: A picture of two megabytes that loses one fragment is lost, hence reliable where the camera offers it,
#: as the simulated one does; a driver that offers sensor data quality is taken as it is.
PICTURE = _qos(5)
KEPT_PICTURE = _qos(5, DurabilityPolicy.TRANSIENT_LOCAL)
PICTURE_FALLBACK = _qos(5, reliability=ReliabilityPolicy.BEST_EFFORT)
#: What tf2's own broadcasters offer on /tf; /tf_static is STATE.
TRANSFORMS = _qos(100)


@dataclass(frozen=True)
class Topic:
    """A topic: relative name, message class, quality of service; `fallback` for a lesser offer.

    If `nested`, nodes receive light objects with the fields of `type`: real ones would hold thousands of messages.
    """

    name: str
    type: Any
    offered: QoSProfile
    requested: QoSProfile
    fallback: QoSProfile | None = None
    nested: bool = False

    @property
    def kept(self) -> Topic:
        """As asked for by who tells old messages by their run: none is missed that DDS makes known late."""
        return replace(self, requested=self.offered)

    @property
    def latched(self) -> bool:
        """Nodes of the cell ask for what was published before they were there."""
        return bool(self.requested.durability == DurabilityPolicy.TRANSIENT_LOCAL)


def _topic(name: str, message_type: Any, qos: QoSProfile, fallback: QoSProfile | None = None) -> Topic:
    return Topic(name, message_type, qos, qos, fallback)


IMAGE = Topic(topic_names.IMAGE, Image, KEPT_PICTURE, PICTURE, PICTURE_FALLBACK)
COMPRESSED = _topic(topic_names.COMPRESSED, CompressedImage, PICTURE, PICTURE_FALLBACK)
#: As `image_transport` names the ways that pictures take.
PICTURES = {"raw": IMAGE, "compressed": COMPRESSED}
CAMERA_INFO = Topic(topic_names.CAMERA_INFO, CameraInfo, KEPT_PICTURE, PICTURE, PICTURE_FALLBACK)
#: Way [m] and turn [rad] of the camera since its calibration, in base axes; there in cells with marks.
CAMERA_MOVED = _topic(topic_names.CAMERA_MOVED, TwistStamped, EVENT)
DOOR_POSE = Topic(topic_names.DOOR_POSE, PoseStamped, KEPT_EVENT, EVENT)
DOOR_LOCALIZATION = Topic(topic_names.DOOR_LOCALIZATION, DoorLocalization, KEPT_EVENT, EVENT)
DOOR_OVERLAY = _topic(topic_names.DOOR_OVERLAY, Image, PICTURE, PICTURE_FALLBACK)
#: Of all door sensors but the camera; three pictures in one message are of its size.
SENSOR_READING = Topic(topic_names.SENSOR_READING, SensorReading, KEPT_PICTURE, PICTURE, PICTURE_FALLBACK)
#: Of each sensor, the camera among them, where the cell has several.
SENSOR_LOCALIZATION = Topic(topic_names.SENSOR_LOCALIZATION, SensorLocalization, KEPT_EVENT, EVENT)
DOOR_RECIPE = _topic(topic_names.DOOR_RECIPE, DoorRecipe, STATE)
PATH_TARGETS = Topic(topic_names.PATH_TARGETS, TargetArray, KEPT_EVENT, EVENT, nested=True)
PATH_NOMINAL = _topic(topic_names.PATH_NOMINAL, Path, STATE)
PATH_CORRECTED = _topic(topic_names.PATH_CORRECTED, Path, STATE)
PATH_MARKERS = _topic(topic_names.PATH_MARKERS, MarkerArray, STATE)
CELL_BODIES = _topic(topic_names.CELL_BODIES, MarkerArray, STATE)
PATH_JOINT_STATES = _topic(topic_names.PATH_JOINT_STATES, JointState, STATE)
ROBOT_DESCRIPTION = _topic(topic_names.ROBOT_DESCRIPTION, String, STATE)
#: The latest counts, but a bag tells of every state: one that is lost on the wire is sent again only while it is kept,
#: and a door's states follow each other within milliseconds.
ABB_STATUS = Topic(topic_names.ABB_STATUS, AbbStatus, _qos(16, DurabilityPolicy.TRANSIENT_LOCAL), STATE)
ABB_REQUEST = _topic(topic_names.ABB_REQUEST, Bool, STATE)
ABB_READY = _topic(topic_names.ABB_READY, Bool, STATE)
CONTROLLER_STATE = _topic(topic_names.CONTROLLER_STATE, ControllerState, STATE)
ABB_TARGET_FILE = _topic(topic_names.ABB_TARGET_FILE, String, STATE)
#: While a door is milled, from controllers that can tell.
SPINDLE_LOAD = _topic(topic_names.SPINDLE_LOAD, SpindleLoad, EVENT)
#: Whoever keeps results gets each, though runs that are refused at once follow each other faster than it looks.
RUN_RESULT = Topic(topic_names.RUN_RESULT, RunResult, STATE, _qos(10, DurabilityPolicy.TRANSIENT_LOCAL))
#: Id of the run of which a robot may mill its share, in the namespace of that robot.
SHARE_GO = _topic(topic_names.SHARE_GO, String, STATE)
DOOR_PLACEMENT = _topic(topic_names.DOOR_PLACEMENT, DoorPlacement, STATE)
EXECUTED_PATH = _topic(topic_names.EXECUTED_PATH, ExecutedPath, STATE)
#: What the tool would have done had the targets not been corrected; of a robot that mills a share.
UNCORRECTED_PATH = _topic(topic_names.UNCORRECTED_PATH, ExecutedPath, STATE)
MILLED_DOOR = _topic(topic_names.MILLED_DOOR, MilledDoor, STATE)
#: Several doors may be measured at once, and none shall be lost.
DOOR_INSPECTION = _topic(topic_names.DOOR_INSPECTION, DoorInspection, _qos(100))
#: What was handed in as files; apart from the gauge's, as no run waits for it. Who shows ended runs asks for what was
#: handed in before it was there, bags hold it once.
MODEL_INSPECTED = Topic(
    topic_names.MODEL_INSPECTED, DoorInspection, _qos(100, DurabilityPolicy.TRANSIENT_LOCAL), _qos(100)
)
MODEL_VERDICT = _topic(topic_names.MODEL_VERDICT, ModelVerdict, STATE)
RUNS_VERDICT = _topic(topic_names.RUNS_VERDICT, RunsVerdict, STATE)
RUN_VERDICT = _topic(topic_names.RUN_VERDICT, RunVerdict, STATE)
DIAGNOSTICS = _topic(topic_names.DIAGNOSTICS, DiagnosticArray, EVENT)

ALL: tuple[Topic, ...] = (
    IMAGE,
    CAMERA_INFO,
    DOOR_POSE,
    DOOR_LOCALIZATION,
    DOOR_OVERLAY,
    SENSOR_READING,
    SENSOR_LOCALIZATION,
    DOOR_RECIPE,
    PATH_TARGETS,
    PATH_NOMINAL,
    PATH_CORRECTED,
    PATH_MARKERS,
    CELL_BODIES,
    PATH_JOINT_STATES,
    ROBOT_DESCRIPTION,
    ABB_STATUS,
    ABB_REQUEST,
    ABB_READY,
    CONTROLLER_STATE,
    ABB_TARGET_FILE,
    SPINDLE_LOAD,
    RUN_RESULT,
    DOOR_PLACEMENT,
    EXECUTED_PATH,
    MILLED_DOOR,
    RUN_VERDICT,
    DOOR_INSPECTION,
    MODEL_INSPECTED,
    MODEL_VERDICT,
    RUNS_VERDICT,
    DIAGNOSTICS,
)


def at(topic: Topic, namespace: str, name: str = "") -> Topic:
    """A topic as it is in a namespace below the node's own ("" for that), under another name where one is given."""
    named = name or topic.name
    return replace(topic, name=f"{namespace}/{named}" if namespace else named)
