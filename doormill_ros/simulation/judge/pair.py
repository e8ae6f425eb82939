"""Judge two robots that milled a share of one door each, one after the other: either against the other where it stands.

Each is held against all that the other takes up, as boxes, so a capsule counts a little thicker than it is.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.frames import inverse, transform
from doormill_ros.recipes.recipe import Recipe
from doormill_ros.simulation.controller.records.executed_path import ExecutedPath
from doormill_ros.simulation.judge.bodies import Body, Box, Capsule, JudgedCell
from doormill_ros.simulation.judge.judge import judge
from doormill_ros.simulation.judge.links import BASE, FLANGE
from doormill_ros.simulation.judge.rack import carried_by, first_tool, in_rack
from doormill_ros.simulation.judge.verdict import Harm, Verdict

Kind = TypeVar("Kind", bound=Harm)


@dataclass(frozen=True, eq=False)
class Milled:
    """What one robot did to the door.

    Attributes:
        robot: What it is called in a verdict.
        T_cell_robot: Its base in the base frame of the cell, shape (4, 4).
        executed: Everything it did, in its own base frame; None: it had nothing to mill and stands at home.
    """

    robot: str
    T_cell_robot: FloatArray
    executed: ExecutedPath | None


def judge_pair(
    recipe: Recipe, T_cell_door_true: FloatArray, milled: Sequence[Milled], cell: JudgedCell
) -> Verdict:
    """What the robots of a run touched beside the wood to be cut, one another among it.

    Args:
        recipe: The door and all its features.
        T_cell_door_true: Where the door really stood, shape (4, 4).
        milled: Both robots in the order in which they moved, each of them after the one before; a robot stands where
            its path begins until then and where it ends from then on, or at home where it has none.
        cell: Robot, spindle and obstacles as the cell's file has them; the rear face is free. Who does not stand in the
            base frame of the cell is the second robot.
    """
    for robot in milled:
        if not np.allclose(robot.T_cell_robot, np.eye(4)):
            cell = cell.of_two(robot.T_cell_robot)
    cells = [
        cell if np.allclose(robot.T_cell_robot, np.eye(4)) else replace(cell, rack=cell.rack_of_second)
        for robot in milled
    ]
    verdicts, before = [], 0
    widest = max(feature.tool.radius for feature in recipe.features)
    for number, own in enumerate(milled):
        if own.executed is None:
            continue
        T_robot_cell = inverse(own.T_cell_robot)
        others: list[Box] = []
        for k, other in enumerate(milled):
            if k == number:
                continue
            T_own_other = T_robot_cell @ other.T_cell_robot
            q, carried = waits(other, cells[k], 0 if k > number else -1)
            others += standing(cell, q, T_own_other, other.robot, widest)
            others += waiting(cells[k], recipe, carried, T_own_other, other.robot)
        obstacles = [replace(box, at=T_robot_cell @ box.at) for box in cell.obstacles]
        about = replace(cells[number], obstacles=(*obstacles, *others), boards=())
        found = judge(recipe, T_robot_cell @ T_cell_door_true, own.executed, about)
        verdicts.append(_told_of(found, own.robot, before))
        before += found.judged
    return Verdict(
        before,
        tuple(touch for verdict in verdicts for touch in verdict.touches),
        tuple(gone for verdict in verdicts for gone in verdict.gone),
        tuple(torn for verdict in verdicts for torn in verdict.torn),
        tuple(bad for verdict in verdicts for bad in verdict.bad),
    )


def waits(robot: Milled, cell: JudgedCell, sample: int) -> tuple[FloatArray, str]:
    """Joint angles, shape (6,) [rad], and tool of a robot that waits, by the first or the last of its samples."""
    if robot.executed is None or not len(robot.executed):
        return cell.home, first_tool(cell)
    return robot.executed.q[sample], str(carried_by(robot.executed, first_tool(cell))[sample])


def standing(
    cell: JudgedCell, q: FloatArray, T_own_other: FloatArray, robot: str, mill_radius: float
) -> list[Box]:
    """All that a robot takes up in one posture, in the base frame of the one that moves.

    Args:
        cell: Its shapes.
        q: Its joint angles, shape (6,) [rad].
        T_own_other: Its base frame in that of the one that moves, shape (4, 4).
        robot: What it is called.
        mill_radius: Of the widest mill that it may hold [m].
    """
    frames = {link: T_own_other @ at[0] for link, at in cell.links.frames(q[None]).items()}
    held = Box(
        "mill",
        FLANGE,
        cell.T_flange_tool @ transform(translation=np.array([0.0, 0.0, -cell.nose / 2.0])),
        np.array([mill_radius, mill_radius, cell.nose / 2.0]),
    )
    boxes = []
    for body in (*cell.bodies, *cell.rooted, held):
        at, half = _box_of(body)
        boxes.append(Box(f"{robot}'s {body.name}", BASE, frames[body.link] @ at, half))
    return boxes


def waiting(cell: JudgedCell, recipe: Recipe, carried: str, T_own_other: FloatArray, robot: str) -> list[Box]:
    """What is in the rack of a robot, in the base frame of the one that moves.

    Args:
        cell: Its rack.
        recipe: Whose tools it knows.
        carried: Tool in the robot's spindle.
        T_own_other: Its base frame in that of the one that moves, shape (4, 4).
        robot: What it is called.
    """
    return [
        replace(item.box, name=f"{robot}'s {item.box.name}", at=T_own_other @ item.box.at)
        for item in in_rack(cell, recipe)
        if item.there(carried)
    ]


def _box_of(body: Body) -> tuple[FloatArray, FloatArray]:
    """Pose of the smallest box along a body in its link's frame, shape (4, 4), and half its extents, shape (3,) [m]."""
    if isinstance(body, Capsule):
        along = body.end - body.start
        at = np.eye(4)
        # Any three axes at right angles, the last one along the capsule.
        at[:3, :3] = np.linalg.svd(along[None])[2].T[:, ::-1]
        at[:3, :3] *= np.linalg.det(at[:3, :3])
        at[:3, 3] = 0.5 * (body.start + body.end)
        return at, np.array([body.radius, body.radius, 0.5 * float(np.linalg.norm(along)) + body.radius])
    return body.at, body.half


def _told_of(verdict: Verdict, robot: str, before: int) -> Verdict:
    """A verdict whose bodies and samples are told from those of the other robot."""

    def moved(harms: tuple[Kind, ...]) -> tuple[Kind, ...]:
        return tuple(replace(h, samples=frozenset(before + number for number in h.samples)) for h in harms)

    touches = tuple(replace(touch, body=f"{robot}'s {touch.body}") for touch in moved(verdict.touches))
    return Verdict(verdict.judged, touches, moved(verdict.gone), moved(verdict.torn), moved(verdict.bad))
