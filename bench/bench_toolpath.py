"""Correction of a whole door against a loop of Pinocchio calls; the milled outline against polygon unions."""

from __future__ import annotations

import logging

import numpy as np
import shapely

from doormill_ros.cell.places.layout import load_layout
from doormill_ros.correction.loaded_robot import LoadedRobot
from doormill_ros.correction.loads import certain
from doormill_ros.frames import apply_twist, inverse, twist_between
from doormill_ros.recipes.documents import load_recipe
from doormill_ros.robot.description import load_robot
from doormill_ros.robot.kinematics import Kinematics
from doormill_ros.robot_model.elastic.joint_springs import JointSpringModel
from doormill_ros.simulation.controller.records.executed_path import ExecutedPath
from doormill_ros.simulation.judge.milled_part import inspect
from doormill_ros.toolpath.generate import generate_program
from harness import Entry, compare
from support.pinocchio_model import PinocchioKinematics
from support.tool_poses import T_door_tool

OUTLINE_SAMPLES = 4000


def run() -> list[Entry]:
    logging.getLogger("doormill_ros").setLevel(logging.ERROR)
    layout = load_layout()
    robot = load_robot(layout.robot)
    return [correction(layout, robot), judge(layout)]


def correction(layout, robot) -> Entry:
    """All targets of the standard door, corrected to 1 um."""
    recipe, model = load_recipe("standard_door"), JointSpringModel(robot)
    T_base_door = layout.T_base_door(recipe.width, recipe.thickness)

    program = generate_program(recipe, T_base_door, layout, robot, model)
    nominal = np.array([t.T_base_tool_nominal for t in program.targets])
    q = np.array([t.q for t in program.targets])
    wrench = np.array([t.wrench for t in program.targets])
    bench = LoadedRobot(Kinematics(robot), model, layout.T_flange_tool)
    still = np.zeros_like(q)
    single = PinocchioKinematics(robot)
    point = layout.T_flange_tool[:3, 3]

    def loop():
        """The same iteration with the same model, target by target."""
        for T, angles, load in zip(nominal, q, wrench, strict=True):
            turn = np.linalg.inv(single.jacobian(angles, point))
            for _ in range(25):
                J = single.jacobian(angles, point)
                deflection = J @ ((J.T @ load) / robot.stiffness)
                loaded = apply_twist(single.forward(angles) @ layout.T_flange_tool, deflection)
                missing = twist_between(loaded, T)
                if max(np.linalg.norm(missing[:3]), np.linalg.norm(missing[3:])) <= 1e-6:
                    break
                angles = angles + turn @ missing

    n = len(program.targets)
    return compare(
        f"correction of {n} targets to 1 um",
        lambda: bench.corrected(nominal, q, certain(wrench, still)),
        "Pinocchio, target by target",
        loop,
    )


def judge(layout) -> Entry:
    """Deviation along a hinge's outline, 1 um, from a finely sampled path."""
    recipe = load_recipe("thesis_190_0deg")
    hinge = recipe.features[0]
    T_base_door = layout.T_base_door(recipe.width, recipe.thickness)
    T_base_feature = T_base_door @ recipe.T_door_feature(hinge)
    radius = hinge.width / 2.0 - hinge.tool.radius
    angle = np.linspace(0.0, 2.0 * np.pi, OUTLINE_SAMPLES)
    middle = 0.045 * np.sign(np.sin(angle))
    xy = np.column_stack([radius * np.cos(angle), middle + radius * np.sin(angle)])
    T_feature_tool = np.tile(T_door_tool(hinge, recipe.size), (OUTLINE_SAMPLES, 1, 1))
    T_feature_tool = inverse(recipe.T_door_feature(hinge)) @ T_feature_tool
    T_feature_tool[:, :2, 3], T_feature_tool[:, 2, 3] = xy, hinge.depth
    T = T_base_feature @ T_feature_tool
    n = OUTLINE_SAMPLES
    path = ExecutedPath(
        np.arange(n),
        T,
        T,
        np.zeros((n, 6)),
        np.zeros(n),
        np.ones(n, bool),
        np.full(n, hinge.id),
        np.zeros((n, 6)),
    )

    def unions():
        """Every stretch as a polygon, their union for each of five depths, distances to its edge."""
        points = shapely.points(hinge.outline().points(step=2.5e-4, chord_error=1e-7))
        for _ in range(5):
            stretches = shapely.linestrings(np.stack([xy[:-1], xy[1:]], axis=1))
            swept = shapely.union_all(shapely.buffer(stretches, hinge.tool.radius, quad_segs=64))
            shapely.distance(points, swept.exterior)

    return compare(
        f"deviation along an outline, {n} samples, 5 depths",
        lambda: inspect(recipe, T_base_door, path, only=[hinge.id]),
        "shapely, union of polygons",
        unions,
        n=3,
    )
