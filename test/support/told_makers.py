"""Makers of target files who were told of weights, and where the cell was taught."""

from dataclasses import replace

import numpy as np

from doormill_ros.cell.places.gravity import Gravity, ToolLoad
from doormill_ros.correction.gravity import with_gravity
from doormill_ros.pipeline.plan import MillingSetup
from doormill_ros.robot.description import Robot
from doormill_ros.robot.weights import LinkWeights
from support.milled_worlds import TOLD, TOOL_CENTRE


def told(setup: MillingSetup, name: str) -> MillingSetup:
    """The setup of the maker in a world of TOLD; the world may be another one than he was told."""
    mass, std, taught, world = TOLD[name]
    load = ToolLoad(mass, std, TOOL_CENTRE, "told", True)
    gravity = Gravity(load, bool(world.links), tuple(map(np.array, taught)))
    robot = replace(setup.robot, links=links(setup.robot, world.links)) if world.links else setup.robot
    return replace(setup, robot=robot, model=with_gravity(setup.model, robot, gravity))


def links(robot: Robot, mass: tuple[float, ...]) -> LinkWeights:
    """Links with their centres half way between their ends, nothing balanced."""
    _, d, a, alpha = robot.dh.T
    centre = -0.5 * np.column_stack([a, d * np.sin(alpha), d * np.cos(alpha)])
    none = np.zeros(6)
    return LinkWeights(np.array(mass), none, centre, none, none, "told", True)
