"""What really happens to one door of a shift in a world."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.frames import inverse, rotation_from_vector, transform
from doormill_ros.recipes.recipe import Recipe
from doormill_ros.simulation.controller.motions.limits import ControllerLimits, load_limits
from doormill_ros.simulation.controller.records.executed_path import ExecutedPath
from doormill_ros.simulation.truth.last_motion import last_directions
from doormill_ros.simulation.world.corners import cut_corners
from doormill_ros.simulation.world.engagement import engaged_wrench
from doormill_ros.simulation.world.robot import WorldRobot
from doormill_ros.simulation.world.servo import lagging
from doormill_ros.simulation.world.world_file import ShiftWorld

TAKT = 180.0  #: from the begin of a door to that of the next one, about 500 doors a day [s]
FORCE, GAUGE, LOAD = 1, 2, 3  #: what is drawn, beside the world's seed and the door's number
SECONDS = 3600.0  #: an hour


class DoorTruth:
    """One door of a shift.

    Attributes:
        number: Of the door, the first one is 0.
        world: What holds for it.
    """

    def __init__(self, world: ShiftWorld, number: int, dh: FloatArray, T_flange_tool: FloatArray) -> None:
        """Take the published geometry.

        Args:
            world: The shift's.
            number: Of the door.
            dh: Denavit-Hartenberg table of the robot, shape (6, 4).
            T_flange_tool: The tool, shape (4, 4).
        """
        self.number = number
        self.world = world.door(number)
        self._seed = world.seed
        self._T_flange_tool = T_flange_tool
        self._robot = WorldRobot(dh, self.world.robot, self.world.tool, self.world.links)

    def drawn(self, what: int) -> np.random.Generator:
        """Random numbers of this door's own: FORCE, GAUGE or LOAD."""
        return np.random.default_rng([self._seed, self.number, what])

    def T_base_door(self, pictured: FloatArray) -> FloatArray:
        """Where the door stands while it is milled, shape (4, 4), when it was pictured at `pictured`."""
        clamp = self.world.clamp
        if self.number < clamp.from_door:
            return pictured
        return transform(translation=clamp.shift) @ pictured

    @property
    def camera_moved(self) -> tuple[FloatArray, FloatArray]:
        """How far the camera is from its mounting, base axes: translation, shape (3,) [m], and rotation, (3, 3)."""
        camera = self.world.camera
        if self.number < camera.from_door:
            return np.zeros(3), np.eye(3)
        return camera.moved, rotation_from_vector(np.array(camera.turned))

    @property
    def limits(self) -> ControllerLimits:
        """What the controller refuses and how fast it is: config/controller.yaml, but what the world names."""
        named, limits = self.world.controller, load_limits()
        return replace(
            limits,
            segment_time=limits.segment_time if named.segment_time is None else named.segment_time,
            acceleration=limits.acceleration if named.acceleration is None else named.acceleration,
        )

    def executed(self, recipe: Recipe, T_base_door: FloatArray, path: ExecutedPath) -> ExecutedPath:
        """Where the tool really was.

        Args:
            recipe: The door.
            T_base_door: Where it stands while it is milled, shape (4, 4).
            path: What the controller commanded, with the wrenches that the targets were corrected for; these stay in
                the path, nobody in a workshop knows others.
        """
        wrench = self.wrench(recipe, T_base_door, path)
        flange = self._robot.flange(path.q, wrench, self._T_flange_tool[:3, 3], last_directions(path.q))
        actual = flange @ self._T_flange_tool
        commanded = path.T_base_tool_commanded[:, :3, 3]
        actual[:, :3, 3] += (
            self.bent(wrench[:, :3], path.T_base_tool_commanded[:, :3, 2])
            + self.grown(
                path.time, commanded, (path.T_base_tool_commanded @ inverse(self._T_flange_tool))[:, :3, 3]
            )
            + cut_corners(path.time, commanded, self.world.controller.corner)
            + lagging(path.time, commanded, self.world.controller.lag)
            - 2.0 * commanded
        )
        return replace(path, T_base_tool=actual)

    @property
    def hardness(self) -> float:
        """How many times what is assumed the wood takes from this door's mill, wear and chance of the door included."""
        force = self.world.force
        factor = force.factor * (1.0 + force.wear_per_door * self.number)
        return factor * max(0.0, 1.0 + force.scatter * float(self.drawn(FORCE).standard_normal()))

    def wrench(self, recipe: Recipe, T_base_door: FloatArray, path: ExecutedPath) -> FloatArray:
        """Wrench of the wood on the tool at its centre point, base axes, shape (n, 6) [N, N m]; see `executed`."""
        force, T_base_tool = self.world.force, path.T_base_tool_commanded
        wrench = path.wrench
        if force.law == "engagement":
            wrench = engaged_wrench(recipe, T_base_door, path)
        turn = rotation_from_vector(force.angle * T_base_tool[:, :3, 2])
        turned = [np.einsum("nij,nj->ni", turn, part) for part in (wrench[:, :3], wrench[:, 3:])]
        result: FloatArray = self.hardness * np.concatenate(turned, axis=1)
        return result

    def bent(self, force: FloatArray, axis: FloatArray) -> FloatArray:
        """Way of the tip under forces, along unit tool axes; shapes (n, 3) [m], [N]."""
        stiffness = self.world.tool.stiffness
        if stiffness is None:
            return np.zeros_like(force)
        across: FloatArray = force - np.sum(force * axis, axis=1, keepdims=True) * axis
        return across / stiffness

    def grown(self, time: FloatArray, points: FloatArray, flange: FloatArray) -> FloatArray:
        """Way of the tool, away from the robot's base, because the arm is warm; shape (n, 3) [m].

        Args:
            time: Since the begin of this door, shape (n,) [s].
            points: Where the tool is, base frame, shape (n, 3) [m].
            flange: Where the arm ends, shape (n, 3) [m].
        """
        temperature = self.world.temperature
        hours = (self.number * TAKT + time) / SECONDS
        warmer = temperature.rise * -np.expm1(-hours / temperature.hours)
        length = np.linalg.norm(points, axis=1, keepdims=True)
        way: FloatArray = temperature.growth * points / length + temperature.expansion * flange
        return warmer[:, None] * way
