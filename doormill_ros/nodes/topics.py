"""Every topic of the cell once: its name, its type and its quality of service."""

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

    Of a `nested` one, whose messages hold others by the thousand, nodes get messages that are no objects of `type` but
    have its fields.
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


IMAGE = Topic("camera/image_raw", Image, KEPT_PICTURE, PICTURE, PICTURE_FALLBACK)
COMPRESSED = _topic("camera/image_raw/compressed", CompressedImage, PICTURE, PICTURE_FALLBACK)
#: As `image_transport` names the ways that pictures take.
PICTURES = {"raw": IMAGE, "compressed": COMPRESSED}
CAMERA_INFO = Topic("camera/camera_info", CameraInfo, KEPT_PICTURE, PICTURE, PICTURE_FALLBACK)
#: Way [m] and turn [rad] of the camera since its calibration, in base axes; there in cells with marks.
CAMERA_MOVED = _topic("camera/moved", TwistStamped, EVENT)
DOOR_POSE = Topic("door/pose", PoseStamped, KEPT_EVENT, EVENT)
DOOR_LOCALIZATION = Topic("door/localization", DoorLocalization, KEPT_EVENT, EVENT)
DOOR_OVERLAY = _topic("door/overlay", Image, PICTURE, PICTURE_FALLBACK)
#: Of all door sensors but the camera; three pictures in one message are of its size.
SENSOR_READING = Topic("sensors/reading", SensorReading, KEPT_PICTURE, PICTURE, PICTURE_FALLBACK)
#: Of each sensor, the camera among them, where the cell has several.
SENSOR_LOCALIZATION = Topic("sensors/localization", SensorLocalization, KEPT_EVENT, EVENT)
DOOR_RECIPE = _topic("door/recipe", DoorRecipe, STATE)
PATH_TARGETS = Topic("path/targets", TargetArray, KEPT_EVENT, EVENT, nested=True)
PATH_NOMINAL = _topic("path/nominal", Path, STATE)
PATH_CORRECTED = _topic("path/corrected", Path, STATE)
PATH_MARKERS = _topic("path/markers", MarkerArray, STATE)
CELL_BODIES = _topic("cell/bodies", MarkerArray, STATE)
PATH_JOINT_STATES = _topic("path/joint_states", JointState, STATE)
ROBOT_DESCRIPTION = _topic("robot_description", String, STATE)
#: The latest counts, but a bag tells of every state: one that is lost on the wire is sent again only while it is kept,
#: and a door's states follow each other within milliseconds.
ABB_STATUS = Topic("abb/status", AbbStatus, _qos(16, DurabilityPolicy.TRANSIENT_LOCAL), STATE)
ABB_REQUEST = _topic("abb/request", Bool, STATE)
ABB_READY = _topic("abb/ready", Bool, STATE)
CONTROLLER_STATE = _topic("abb/controller_state", ControllerState, STATE)
ABB_TARGET_FILE = _topic("abb/target_file", String, STATE)
#: While a door is milled, from controllers that can tell.
SPINDLE_LOAD = _topic("abb/spindle_load", SpindleLoad, EVENT)
#: Whoever keeps results gets each, though runs that are refused at once follow each other faster than it looks.
RUN_RESULT = Topic("run/result", RunResult, STATE, _qos(10, DurabilityPolicy.TRANSIENT_LOCAL))
#: Id of the run of which a robot may mill its share, in the namespace of that robot.
SHARE_GO = _topic("share/go", String, STATE)
DOOR_PLACEMENT = _topic("simulation/door_placement", DoorPlacement, STATE)
EXECUTED_PATH = _topic("simulation/executed_path", ExecutedPath, STATE)
#: What the tool would have done had the targets not been corrected; of a robot that mills a share.
UNCORRECTED_PATH = _topic("simulation/uncorrected_path", ExecutedPath, STATE)
MILLED_DOOR = _topic("simulation/milled_door", MilledDoor, STATE)
#: Several doors may be measured at once, and none shall be lost.
DOOR_INSPECTION = _topic("door/inspection", DoorInspection, _qos(100))
#: What was handed in as files; apart from the gauge's, as no run waits for it. Who shows ended runs asks for what was
#: handed in before it was there, bags hold it once.
MODEL_INSPECTED = Topic(
    "model/inspected", DoorInspection, _qos(100, DurabilityPolicy.TRANSIENT_LOCAL), _qos(100)
)
MODEL_VERDICT = _topic("model/verdict", ModelVerdict, STATE)
RUNS_VERDICT = _topic("model/runs_verdict", RunsVerdict, STATE)
RUN_VERDICT = _topic("simulation/verdict", RunVerdict, STATE)
DIAGNOSTICS = _topic("/diagnostics", DiagnosticArray, EVENT)

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
