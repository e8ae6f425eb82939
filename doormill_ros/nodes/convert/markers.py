"""A door and its milling program as markers for RViz and Foxglove."""

from __future__ import annotations

import numpy as np
from geometry_msgs.msg import Point, Vector3
from std_msgs.msg import ColorRGBA, Header
from visualization_msgs.msg import Marker, MarkerArray

from doormill_ros.arrays import FloatArray
from doormill_ros.cell.places.layout import CellLayout
from doormill_ros.frames import BASE_FRAME, transform
from doormill_ros.nodes.convert.geometry import pose_message
from doormill_ros.recipes.recipe import Recipe
from doormill_ros.robot.bodies import Body, load_bodies
from doormill_ros.robot.description import Robot
from doormill_ros.toolpath.mills.waiting_tools import waiting_tools
from doormill_ros.toolpath.program import AT_POINTS, MillingProgram
from doormill_ros.toolpath.settings import PathSettings

NOMINAL = ColorRGBA(r=0.55, g=0.55, b=0.55, a=1.0)
CORRECTED = ColorRGBA(r=0.10, g=0.45, b=0.85, a=1.0)
CORRECTION = ColorRGBA(r=0.90, g=0.35, b=0.10, a=1.0)
DOOR = ColorRGBA(r=0.80, g=0.65, b=0.45, a=0.4)  # paths lie in it, on the far side too
ROBOT_BODY = ColorRGBA(r=0.95, g=0.45, b=0.10, a=0.25)
OBSTACLE = ColorRGBA(r=0.45, g=0.45, b=0.50, a=0.5)
THIN, THICK = 0.002, 0.004  # m; thinner is less than a pixel where a whole door is seen
EXAGGERATION = 100.0  # corrections are tenths of a millimetre on a door of metres


def _marker(header: Header, name: str, kind: int, width: float, colour: ColorRGBA) -> Marker:
    marker = Marker(header=header, ns=name, id=0, type=kind, action=Marker.ADD, color=colour)
    marker.pose.orientation.w = 1.0
    marker.scale = Vector3(x=width, y=width, z=width)
    return marker


def _point(p: FloatArray) -> Point:
    return Point(x=float(p[0]), y=float(p[1]), z=float(p[2]))


def _door_marker(header: Header, T_base_door: FloatArray, door: Recipe) -> Marker:
    size = np.array([door.thickness, door.width, door.height])
    # A marker's pose is that of its middle, a door's that of its lowest corner at the hinges.
    pose = pose_message(T_base_door @ transform(translation=size / 2.0))
    scale = Vector3(x=float(size[0]), y=float(size[1]), z=float(size[2]))
    return Marker(
        header=header, ns="door", type=Marker.CUBE, action=Marker.ADD, pose=pose, scale=scale, color=DOOR
    )


def _body_marker(header: Header, body: Body, colour: ColorRGBA) -> list[Marker]:
    """A box, or the cylinder and the two balls of a capsule."""
    if body.size is not None:
        pose, size = pose_message(body.T_frame_body), body.size
        parts = [(Marker.CUBE, pose, size)]
    else:
        start, end = body.ends
        width = 2.0 * body.margin
        length = float(np.linalg.norm(end - start))
        parts = [(Marker.CYLINDER, pose_message(body.T_frame_body), np.array([width, width, length]))]
        ball = np.full(3, width)
        parts += [(Marker.SPHERE, pose_message(transform(translation=at)), ball) for at in (start, end)]
    return [
        Marker(
            header=header,
            ns=body.name,
            id=number,
            type=kind,
            action=Marker.ADD,
            pose=pose,
            scale=Vector3(x=float(size[0]), y=float(size[1]), z=float(size[2])),
            color=colour,
            frame_locked=True,
        )
        for number, (kind, pose, size) in enumerate(parts)
    ]


def body_markers(robot: Robot, layout: CellLayout, settings: PathSettings) -> MarkerArray:
    """What robot, spindle and cell take up for the check of motions, each in the frame that moves it.

    The tools of the rack are those that wait between doors, as wide as any may be.
    """
    markers = []
    for body in load_bodies(robot):
        markers += _body_marker(Header(frame_id=body.link), body, ROBOT_BODY)
    for part in layout.spindle:
        markers += _body_marker(Header(frame_id=robot.flange_link), part, ROBOT_BODY)
    for obstacle in (*layout.obstacles, *waiting_tools(layout, robot, settings, {})):
        markers += _body_marker(Header(frame_id=BASE_FRAME), obstacle, OBSTACLE)
    return MarkerArray(markers=markers)


def no_markers(header: Header) -> MarkerArray:
    """What takes the markers of an earlier program away."""
    return MarkerArray(markers=[Marker(header=header, action=Marker.DELETEALL)])


def program_markers(
    program: MillingProgram, door: Recipe, T_base_door: FloatArray, header: Header
) -> MarkerArray:
    """The door, nominal and corrected path in execution order, corrections exaggerated.

    Args:
        program: What to show.
        door: Its door.
        T_base_door: Where the door was found, shape (4, 4).
        header: Frame base_link and the stamp of the picture.
    """
    nominal = _marker(header, "nominal path", Marker.LINE_STRIP, THIN, NOMINAL)
    corrected = _marker(header, "corrected path", Marker.LINE_STRIP, THICK, CORRECTED)
    corrections = _marker(header, "correction x 100", Marker.LINE_LIST, THICK, CORRECTION)
    for motion in program.motions:
        if motion.kind in AT_POINTS:
            continue
        for index in ([] if motion.via is None else [motion.via]) + [motion.target]:
            target = program.targets[index]
            p_nominal, p_corrected = target.T_base_tool_nominal[:3, 3], target.T_base_tool_corrected[:3, 3]
            nominal.points.append(_point(p_nominal))
            corrected.points.append(_point(p_corrected))
            corrections.points.append(_point(p_nominal))
            corrections.points.append(_point(p_nominal + EXAGGERATION * (p_corrected - p_nominal)))
    body = _door_marker(header, T_base_door, door)
    return MarkerArray(markers=[*no_markers(header).markers, body, nominal, corrected, corrections])
