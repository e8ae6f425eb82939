"""What each of two robots has about it: the cell, and the other robot as it waits at home beside its rack.

One of them moves at a time, the other stands at home meanwhile, so that a program kept clear of the other one's body
there never meets it.
"""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.cell.graph.two_robots import FIRST
from doormill_ros.cell.places.layout import CellLayout
from doormill_ros.frames import inverse
from doormill_ros.robot.bodies import Body, load_bodies
from doormill_ros.robot.description import Robot
from doormill_ros.robot.urdf import link_poses
from doormill_ros.toolpath.mills.waiting_tools import waiting_tools
from doormill_ros.toolpath.settings import PathSettings

OTHER = "other robot's"  #: before the names of its bodies


def place_of(name: str, layout: CellLayout, robot: Robot, settings: PathSettings) -> CellLayout:
    """The cell as one of the two robots sees it, in its own base frame: rear face free, the other one at home.

    Args:
        name: "first" or "second".
        layout: The cell, first robot's base frame.
        robot: Both of them.
        settings: Where the second one stands.

    Raises:
        RobotDescriptionError: The robot's bodies are not told.
    """
    T_first_second = settings.second_robot.T_base_second
    first = layout.of_two(T_first_second)
    second = first.seen_from(T_first_second)
    own, other, T_own_other = first, second, T_first_second
    if name != FIRST:
        own, other, T_own_other = second, first, inverse(T_first_second)
    waiting = [_standing(body, T_own_other) for body in waiting_tools(other, robot, settings, {})]
    return own.beside([*_at_home(layout, robot, T_own_other), *waiting])


def _at_home(layout: CellLayout, robot: Robot, T_base_other: FloatArray) -> list[Body]:
    """Bodies of the robot that stands elsewhere, in this one's base frame."""
    links = link_poses(robot.urdf, layout.home)
    at = {links[0].parent: np.asarray(T_base_other)}
    for link in links:
        at[link.child] = at[link.parent] @ link.T_parent_child
    own = [(body, body.link) for body in load_bodies(robot)]
    held = [(body, robot.flange_link) for body in layout.spindle]
    return [_standing(body, at[link]) for body, link in [*own, *held]]


def _standing(body: Body, T_base_link: FloatArray) -> Body:
    """The body where its link is now, as one that moves with none."""
    still = Body(
        f"{OTHER} {body.name}",
        body.shape,
        body.size,
        body.position,
        body.rotation,
        body.radius,
        body.start,
        body.end,
    )
    return still.mapped(T_base_link)
