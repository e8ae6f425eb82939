"""The layouts for Foxglove and RViz name topics that the cell has, in frames that the messages carry."""

from __future__ import annotations

import json
import re
from typing import Any
from xml.etree import ElementTree

import yaml
from rclpy.qos import DurabilityPolicy, QoSCompatibility, QoSProfile, ReliabilityPolicy, qos_check_compatible

from doormill_ros.cell.places.layout import load_layout
from doormill_ros.frames import BASE_FRAME, CAMERA_FRAME, DOOR_FRAME, TOOL_FRAME
from doormill_ros.nodes.base import topics
from doormill_ros.recording.bag_reader import read_bag
from doormill_ros.robot.description import load_robot
from support.source_tree import ROOT

BAG = ROOT / "bags" / "thesis_190_0deg"
#: Titles of panels in Foxglove and in Lichtblick 1.28, the open viewer made from its sources.
TITLES = {"foxglovePanelTitle", "lichtblickPanelTitle"}
#: Settings by panel type that both read, by the classes of Foxglove's layout library (foxglove-sdk 0.30,
#: foxglove.layouts) and by Lichtblick's types of panel configurations.
SETTINGS = {
    "3D": {"cameraState", "followTf", "layers", "scene", "topics", "transforms"},
    "Image": {"imageMode", "scene", "topics"},
    "DiagnosticSummary": {"hardwareIdFilter", "minLevel", "pinnedIds", "sortByLevel", "topicToRender"},
    "StateTransitions": {"isSynced", "paths"} | TITLES,
    "RawMessages": {"expansion", "topicPath"},
    "Plot": TITLES
    | {
        "isSynced",
        "legendDisplay",
        "paths",
        "showLegend",
        "xAxisLabel",
        "xAxisPath",
        "xAxisVal",
        "yAxisLabel",
    },
}
CAMERA = {
    "distance", "far", "fovy", "near", "perspective", "phi",
    "target", "targetOffset", "targetOrientation", "thetaOffset",
}  # fmt: skip
SCENE = {"labelScaleFactor", "transforms"}
TRANSFORMS = {"axisScale", "enablePreloading", "lineWidth", "showLabel"}
IMAGE_MODE = {"calibrationTopic", "imageTopic"}
SERIES = {"color", "enabled", "label", "showLine", "timestampMethod", "value"}
LAYERS = {
    "foxglove.Grid": {"divisions", "frameId", "size"},
    "foxglove.Urdf": {"controlMode", "displayMode", "jointStatesTopic", "sourceType", "topic"},
}
OF_EVERY_LAYER = {"instanceId", "label", "layerId", "visible"}
TOPIC_TYPES = {
    "/path/markers": "visualization_msgs/msg/MarkerArray",
    "/path/nominal": "nav_msgs/msg/Path",
    "/path/corrected": "nav_msgs/msg/Path",
    "/path/joint_states": "sensor_msgs/msg/JointState",
    "/door/pose": "geometry_msgs/msg/PoseStamped",
    "/door/overlay": "sensor_msgs/msg/Image",
    "/camera/image_raw": "sensor_msgs/msg/Image",
    "/camera/camera_info": "sensor_msgs/msg/CameraInfo",
    "/robot_description": "std_msgs/msg/String",
    "/diagnostics": "diagnostic_msgs/msg/DiagnosticArray",
}


def layout() -> dict[str, Any]:
    return json.loads((ROOT / "config" / "foxglove-layout.json").read_text())


def recorded_types() -> dict[str, str]:
    """Type by topic of a reference bag."""
    return {item.topic: item.type_name for item in read_bag(BAG)}


def test_foxglove_layout_is_of_the_form_that_the_app_exports() -> None:
    document = layout()
    assert document.keys() == {"configById", "globalVariables", "layout", "playbackConfig", "userNodes"}
    panels = document["configById"]
    shown: list[str] = []

    def walk(node: Any) -> None:
        if isinstance(node, str):
            shown.append(node)
            return
        assert node.keys() <= {"direction", "first", "second", "splitPercentage"}
        assert node["direction"] in ("row", "column")
        assert 0 < node.get("splitPercentage", 50) < 100
        walk(node["first"])
        walk(node["second"])

    walk(document["layout"])
    assert sorted(shown) == sorted(panels)
    assert len(panels) >= 6
    for panel, settings in panels.items():
        kind = panel.split("!")[0]
        assert settings.keys() <= SETTINGS[kind], panel
        assert settings.get("cameraState", {}).keys() <= CAMERA
        assert settings.get("scene", {}).keys() <= SCENE
        assert settings.get("scene", {}).get("transforms", {}).keys() <= TRANSFORMS
        assert settings.get("imageMode", {}).keys() <= IMAGE_MODE
        assert (settings.keys() & TITLES) in (set(), TITLES), f"{panel} has no title in one of the viewers"
        for series in settings.get("paths", ()):
            assert series.keys() <= SERIES
        for name, layer in settings.get("layers", {}).items():
            assert layer.keys() <= OF_EVERY_LAYER | LAYERS[layer["layerId"]], name
            assert layer["instanceId"] == name


def test_foxglove_layout_shows_recorded_topics_of_types_its_panels_draw() -> None:
    named = set(re.findall(r'"(/[a-z]\w*/?\w*)[".]', json.dumps(layout()["configById"])))
    types = recorded_types()
    assert named <= types.keys()
    drawn = {topic: types[topic] for topic in named if topic in TOPIC_TYPES}
    assert drawn == TOPIC_TYPES


def test_foxglove_series_lead_to_fields_of_the_messages() -> None:
    latest = {item.topic: item.message for item in read_bag(BAG)}
    panels = layout()["configById"].values()
    values = [series["value"] for panel in panels for series in panel.get("paths", ())]
    values += [panel["xAxisPath"]["value"] for panel in panels if "xAxisPath" in panel]
    assert len(values) >= 6
    for value in values:
        topic, *fields = value.split(".")
        found = latest[topic]
        for field in fields:
            name, index = re.fullmatch(r"(\w+)(?:\[(\d*:?)\])?", field).groups()
            found = getattr(found, name)
            found = found if index is None else found[0 if index == ":" else int(index)]
        assert found is not None


def test_foxglove_follows_the_frame_of_the_messages() -> None:
    scene = layout()["configById"]["3D!door"]
    assert scene["followTf"] == scene["layers"]["grid"]["frameId"] == BASE_FRAME


def test_foxglove_knows_every_frame_after_a_jump_in_time() -> None:
    # After a jump a viewer looks up one earlier message a topic, but `frames` has one frame a message.
    panels = layout()["configById"]
    spatial = {name for name in panels if name.split("!")[0] in ("3D", "Image")}
    assert len(spatial) == 3
    for name in spatial:
        assert panels[name]["scene"]["transforms"]["enablePreloading"] is True, name


def test_foxglove_plots_without_time_are_not_zoomed_to_the_times_of_other_panels() -> None:
    panels = layout()["configById"].values()
    plots = [panel for panel in panels if panel.get("xAxisVal", "timestamp") != "timestamp"]
    assert [panel["isSynced"] for panel in plots] == [False]
    # By index Lichtblick forgets how many points there are as soon as a message of another topic comes.
    assert [panel["xAxisVal"] for panel in plots] == ["currentCustom"]


def test_rviz_shows_recorded_topics_with_the_durability_they_have() -> None:
    document = yaml.safe_load((ROOT / "config" / "cell.rviz").read_text())
    manager = document["Visualization Manager"]
    assert manager["Global Options"]["Fixed Frame"] == BASE_FRAME
    used = [d[key] for d in manager["Displays"] for key in ("Topic", "Description Topic") if key in d]
    named = {topic["Value"]: topic["Durability Policy"] for topic in used}
    assert len(named) == 6
    assert set(named) <= recorded_types().keys()
    assert {t for t, durability in named.items() if durability == "Transient Local"} == {
        "/path/nominal", "/path/corrected", "/path/markers", "/robot_description"
    }  # fmt: skip


#: Properties of displays and views in the sources of rviz_default_plugins and rviz_common 14.3.
OF_EVERY_DISPLAY = {"Class", "Enabled", "Name"}
RVIZ = {
    "Grid": {"Cell Size", "Plane Cell Count"},
    "RobotModel": {"Description Source", "Description Topic"},
    "TF": {"Frame Timeout", "Marker Scale"},
    "Pose": {"Axes Length", "Axes Radius", "Shape", "Topic"},
    "Path": {"Color", "Line Style", "Line Width", "Topic"},
    "MarkerArray": {"Topic"},
    "Image": {"Topic"},
}
RVIZ_TOPIC = {"Depth", "Durability Policy", "Reliability Policy", "Value"}
RVIZ_POLICIES = {
    "Reliable": ReliabilityPolicy.RELIABLE,
    "Best Effort": ReliabilityPolicy.BEST_EFFORT,
    "Transient Local": DurabilityPolicy.TRANSIENT_LOCAL,
    "Volatile": DurabilityPolicy.VOLATILE,
}


def test_rviz_reads_every_setting_and_its_subscriptions_match_what_the_nodes_offer() -> None:
    manager = yaml.safe_load((ROOT / "config" / "cell.rviz").read_text())["Visualization Manager"]
    offered = {f"/{t.name}": t.offered for t in topics.ALL}
    assert len(manager["Displays"]) >= 6
    for display in manager["Displays"]:
        plugin, kind = display["Class"].split("/")
        assert plugin == "rviz_default_plugins"
        assert display.keys() <= OF_EVERY_DISPLAY | RVIZ[kind], display["Name"]
        for topic in (display[key] for key in ("Topic", "Description Topic") if key in display):
            assert topic.keys() <= RVIZ_TOPIC
            profile = QoSProfile(
                depth=topic["Depth"],
                reliability=RVIZ_POLICIES[topic["Reliability Policy"]],
                durability=RVIZ_POLICIES[topic["Durability Policy"]],
            )
            verdict, why = qos_check_compatible(offered[topic["Value"]], profile)
            assert verdict != QoSCompatibility.ERROR, f"{display['Name']}: {why}"
            # Less than what is offered would lose pictures of many fragments.
            assert profile.reliability == offered[topic["Value"]].reliability
    view = manager["Views"]["Current"]
    assert view.keys() <= {"Class", "Distance", "Focal Point", "Pitch", "Yaw"}
    assert view["Class"] == "rviz_default_plugins/Orbit"


def test_viewers_draw_the_robots_without_files_beside_the_description() -> None:
    paths = sorted((ROOT / "config" / "robots").glob("*/robot.urdf"))
    assert len(paths) >= 2
    for path in paths:
        root = ElementTree.parse(path).getroot()
        shapes = {child.tag for geometry in root.iter("geometry") for child in geometry}
        assert shapes, path
        assert shapes <= {"box", "cylinder"}, path
        drawn = {link.get("name") for link in root.iter("link") if link.find("visual") is not None}
        assert drawn == {link.get("name") for link in root.iter("link")}, path


def test_the_recorded_frames_reach_from_the_base_to_every_link_door_and_camera() -> None:
    parents = {}
    for item in read_bag(BAG):
        single = item.type_name == "geometry_msgs/msg/TransformStamped"
        many = item.type_name == "tf2_msgs/msg/TFMessage"
        for t in [item.message] if single else item.message.transforms if many else ():
            parents[t.child_frame_id] = t.header.frame_id
    robot = ElementTree.parse(load_robot(load_layout().robot).urdf).getroot()
    shown = {link.get("name") for link in robot.iter("link")} | {DOOR_FRAME, CAMERA_FRAME, TOOL_FRAME}
    assert parents.keys() | {BASE_FRAME} == shown
    for frame in shown:
        steps = 0
        while frame != BASE_FRAME:
            frame, steps = parents[frame], steps + 1
            assert steps <= len(parents)


def test_shown_messages_are_in_the_base_frame() -> None:
    frames = {}
    for item in read_bag(BAG, ["/path/nominal", "/path/corrected", "/door/pose", "/path/markers"]):
        header = item.message.markers[-1].header if item.topic == "/path/markers" else item.message.header
        frames[item.topic] = header.frame_id
    assert len(frames) == 4
    assert frames == dict.fromkeys(frames, BASE_FRAME)
    assert len(frames) == 4
