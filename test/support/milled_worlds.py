"""What a target file mills on robots and under forces that its maker did not know.

A world is springs, play, a weight at the flange and a force; it reads the file, not the planner. Forces are given as
numbers: those that the maker believed in, changed, or a force of the world's own that turns with the feed.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.transform import Rotation

from doormill_ros.abb.target_file.target_file import render_target_file
from doormill_ros.frames import inverse
from doormill_ros.simulation.controller.records.executed_path import ExecutedPath
from doormill_ros.simulation.judge.milled_part import inspect
from doormill_ros.simulation.truth.robot import TruthRobot
from doormill_ros.simulation.world.robot import WorldRobot
from doormill_ros.simulation.world.world_file import LinksOfWorld, RobotOfWorld, ToolOfWorld
from support.file_run import read_file
from support.ideal_controller import LINE_STEP, run_file_ideally

RUN_ID = "20260101T000000000000Z"
STANDARD_GRAVITY = 9.80665  # m/s^2
TOOL_CENTRE = np.array([0.0, 0.0, 0.1])  #: of mass, flange frame [m]
#: Springs that ship with the robot, typed in again from the table of docs/thesis.md [N m / rad].
SPRINGS = np.array([2.442e6, 2.167e6, 1.683e6, 3.443e5, 1.172e5, 4.567e4])
#: Wrench at the tool centre point, base axes, shape (n, 6), from the believed one and the executed path.
Force = Callable[[np.ndarray, ExecutedPath], np.ndarray]


def as_believed(believed: np.ndarray, path: ExecutedPath) -> np.ndarray:
    """The force that the file was made for."""
    return believed


def times(factor: float) -> Force:
    """The believed force, larger or smaller."""
    return lambda believed, path: factor * believed


def turned(degrees: float) -> Force:
    """The believed force, turned about the tool."""
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    R_tool = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])

    def force(believed, path):
        R = path.T_base_tool[:, :3, :3]
        turn = R @ R_tool @ np.swapaxes(R, 1, 2)
        return np.concatenate(
            [np.einsum("nij,nj->ni", turn, believed[:, part]) for part in (slice(0, 3), slice(3, 6))], axis=1
        )

    return force


def beside_the_feed(newton: float) -> Force:
    """A force of the world's own: square to the feed and the tool, nobody's belief."""

    def force(believed, path):
        way = np.gradient(path.T_base_tool[:, :3, 3], axis=0)
        side = np.cross(path.T_base_tool[:, :3, 2], way)
        length = np.linalg.norm(side, axis=1, keepdims=True)
        side = np.where(length > 1e-9, side / np.maximum(length, 1e-12), 0.0)
        return np.concatenate([newton * side, np.zeros_like(side)], axis=1)

    return force


@dataclass(frozen=True)
class World:
    """A robot that bends and what it meets.

    Attributes:
        springs: Factor on each joint's spring, shape (6,).
        gap: Play of every joint [rad].
        mass: At the flange, its centre 0.1 m in front [kg].
        links: Masses of the links, each half way between its ends, or none [kg].
        taught: Postures at which the tool tip touched the points that door and camera are placed by [rad].
        force: What acts on the tool.
    """

    springs: tuple[float, ...] = (1.0,) * 6
    gap: float = 0.0
    mass: float = 0.0
    links: tuple[float, ...] = ()
    taught: tuple[tuple[float, ...], ...] = ()
    force: Force = as_believed

    def robot(self, dh) -> TruthRobot:
        """The robot of the world."""
        play = [
            {"cause": "joint_backlash", "where": f"joint {k + 1}", "parameters": {"gap": self.gap}}
            for k in range(6)
            if self.gap
        ]
        return TruthRobot(dh, play, SPRINGS * np.array(self.springs))


def flanks(q, gap: float):
    """Direction in which a joint with play last moved, at every sample, shape (n,).

    It lies on the other flank once it has moved back by its play, not before.
    """
    state, reached, found = 0.0, q[0], []
    for angle in q:
        if state == 0.0 and angle != reached:
            state = np.sign(angle - reached)
        if (angle - reached) * state >= 0.0:
            reached = angle
        elif abs(angle - reached) > gap:
            state, reached = -state, angle
        found.append(state)
    return np.array(found)


def soft_and_stiff(seeds) -> dict[str, World]:
    """Springs 30 % softer or stiffer, all at once and each by itself."""
    worlds = {
        "springs all soft": World(springs=(0.7,) * 6),
        "springs all stiff": World(springs=(1.3,) * 6),
    }
    for seed in seeds:
        factors = np.random.default_rng(seed).uniform(0.7, 1.3, 6)
        worlds[f"springs set {seed}"] = World(springs=tuple(float(f) for f in factors))
    return worlds


#: Masses of the links of no robot in particular [kg].
LINKS = (500.0, 120.0, 115.0, 130.0, 12.0, 4.0)
#: The tool along x before the lowest door, at three points 0.3 to 0.8 m apart, and 1.5 m higher.
LOW = (
    (-0.2, 0.962, 0.333, -0.25, -1.292, 0.07),
    (0.2, 0.962, 0.333, 0.25, -1.292, -0.07),
    (0.0, 0.6, 0.3, 0.0, -0.9, 0.0),
)
HIGH = (0.0, 0.3, -0.8, 0.0, 0.5, 0.0)
WORLDS = {
    "as believed": World(),
    **soft_and_stiff(range(4)),
    "no force": World(force=times(0.0)),
    "half the force": World(force=times(0.5)),
    "twice the force": World(force=times(2.0)),
    "force turned by 90": World(force=turned(90.0)),
    "force turned by -90": World(force=turned(-90.0)),
    "force turned by 180": World(force=turned(180.0)),
    "gap of 1e-4 rad": World(gap=1e-4),
    "25 kg not told": World(mass=25.0),
    "25 kg not told, taught low": World(mass=25.0, taught=LOW),
    "25 kg and links not told, taught low": World(mass=25.0, links=LINKS, taught=LOW),
    "150 N beside the feed": World(force=beside_the_feed(150.0)),
    "150 N from the other side": World(force=beside_the_feed(-150.0)),
}


#: Worlds with a weight that the maker of the file was told of: mass, its deviation [kg], where he taught, the world.
TOLD = {
    "25 kg told": (25.0, 0.0, (), World(mass=25.0)),
    "25 kg told, taught low": (25.0, 0.0, LOW, World(mass=25.0, taught=LOW)),
    "25 kg told, taught at one posture": (25.0, 0.0, (HIGH,), World(mass=25.0, taught=(HIGH,))),
    "25 kg told, taught low and high": (25.0, 0.0, (*LOW, HIGH), World(mass=25.0, taught=(*LOW, HIGH))),
    "25 kg told, springs soft": (25.0, 0.0, (), World(mass=25.0, springs=(0.7,) * 6)),
    "25 kg told, springs stiff": (25.0, 0.0, (), World(mass=25.0, springs=(1.3,) * 6)),
    "25 kg told, 15 hang there": (25.0, 10.0, (), World(mass=15.0)),
    "25 kg told, 35 hang there": (25.0, 10.0, (), World(mass=35.0)),
    "25 kg and links told": (25.0, 0.0, (), World(mass=25.0, links=LINKS)),
    "25 kg and links told, taught low": (25.0, 0.0, LOW, World(mass=25.0, links=LINKS, taught=LOW)),
}


def believed_wrenches(program) -> np.ndarray:
    """Wrench that a program's maker believed in where each motion begins and ends, shape (m, 2, 6) [N, N m]."""
    return np.array([[motion.wrench, motion.last_wrench] for motion in program.motions])


def shares(motion: np.ndarray) -> np.ndarray:
    """How much of its motion lies behind each sample, 0..1, where samples of one motion are equally far apart."""
    place = np.arange(len(motion))
    first = np.searchsorted(motion, motion, side="left")
    last = np.searchsorted(motion, motion, side="right") - 1
    return (place - first) / np.maximum(last - first, 1)


class MilledFile:
    """A target file as an ideal controller runs it, ready to be bent by any world."""

    def __init__(
        self,
        text: str,
        believed: np.ndarray,
        dh: np.ndarray,
        T_flange_tool: np.ndarray,
        line_step: float = LINE_STEP,
    ) -> None:
        """Run the file.

        Args:
            text: The target file.
            believed: Wrench where each motion of the file begins and ends, base axes, shape (m, 2, 6) [N, N m]; it
                goes evenly from the one to the other.
            dh: Denavit-Hartenberg table of the robot, shape (6, 4).
            T_flange_tool: Tool centre point in the flange, shape (4, 4).
            line_step: Between samples of a straight cut [m].
        """
        self.dh, self.T_flange_tool = dh, T_flange_tool
        self.path = run_file_ideally(read_file(text), TruthRobot(dh), T_flange_tool, line_step)
        first, last = np.swapaxes(believed[self.path.motion], 0, 1)
        force = first + shares(self.path.motion)[:, None] * (last - first)
        self.believed = np.where(self.path.cutting[:, None], force, 0.0)
        self.keep = np.char.str_len(self.path.feature) > 0

    def milled(self, world: World) -> ExecutedPath:
        """Where the tool really went while it was at its features."""
        path, keep = self.path, self.keep
        force = np.where(path.cutting[:, None], world.force(self.believed, path), 0.0)[keep]
        direction = np.array([flanks(q, world.gap) for q in path.q.T]).T
        T = self._bent(world, path.q[keep], force, direction[keep])
        if world.taught:
            T = inverse(self._taken_up(world)) @ T
        return ExecutedPath(
            path.time[keep],
            T,
            path.T_base_tool[keep],
            path.q[keep],
            path.motion[keep],
            path.cutting[keep],
            path.feature[keep],
            force,
        )

    def _bent(self, world: World, q: np.ndarray, force: np.ndarray, direction: np.ndarray) -> np.ndarray:
        """T_base_tool under forces on the tool and under weight, shape (n, 4, 4)."""
        tip = self.T_flange_tool[:3, 3]
        if world.links:
            robot = WorldRobot(
                self.dh,
                RobotOfWorld(stiffness_factor=world.springs, gap=(world.gap,) * 6),
                ToolOfWorld(mass=world.mass, com=TOOL_CENTRE),
                LinksOfWorld(masses=world.links),
            )
            return robot.flange(q, force, tip, direction) @ self.T_flange_tool
        robot = world.robot(self.dh)
        if world.mass:
            weight = np.array([0.0, 0.0, -world.mass * STANDARD_GRAVITY])
            arm = robot.forward(q)[:, :3, :3] @ (TOOL_CENTRE - tip)
            force = force + np.concatenate(
                [np.broadcast_to(weight, arm.shape), np.cross(arm, weight)], axis=1
            )
        return robot.deflected(q, force, tip, direction) @ self.T_flange_tool

    def _taken_up(self, world: World) -> np.ndarray:
        """The frame that teaching found, in the one that it would have found with a rigid arm, shape (4, 4)."""
        q = np.array(world.taught)
        still = np.zeros_like(q)
        believed = (TruthRobot(self.dh).forward(q) @ self.T_flange_tool)[:, :3, 3]
        touched = self._bent(world, q, still, still)[:, :3, 3]
        middle = believed.mean(axis=0)
        R = np.eye(3)
        if len(q) > 2:
            R = Rotation.align_vectors(touched - touched.mean(axis=0), believed - middle)[0].as_matrix()
        T = np.eye(4)
        T[:3, :3], T[:3, 3] = R, touched.mean(axis=0) - R @ middle
        return T


def commanded(
    program, dh: np.ndarray, T_flange_tool: np.ndarray, line_step: float = LINE_STEP
) -> ExecutedPath:
    """What an ideal controller commands by a program's target file, with the wrenches that its maker believed in."""
    text = render_target_file(program, RUN_ID).decode("ascii")
    file = MilledFile(text, believed_wrenches(program), dh, T_flange_tool, line_step)
    return replace(file.path, wrench=file.believed)


def both_files(program, dh, T_flange_tool) -> tuple[MilledFile, ...]:
    """The program's target file, and the same file without its corrections."""
    believed = believed_wrenches(program)
    plain = tuple(replace(t, T_base_tool_corrected=t.T_base_tool_nominal) for t in program.targets)
    return tuple(
        MilledFile(render_target_file(p, RUN_ID).decode("ascii"), believed, dh, T_flange_tool)
        for p in (program, replace(program, targets=plain))
    )


def wall_errors(recipe, T_base_door, files, world: World) -> dict[str, tuple[float, float]]:
    """Largest wall error of every feature, corrected and uncorrected [m]."""
    corrected, plain = (inspect(recipe, T_base_door, file.milled(world)) for file in files)
    return {a.feature: (_wall(a), _wall(b)) for a, b in zip(corrected.features, plain.features, strict=True)}


def _wall(result) -> float:
    # Without the deepest of the judge's layers: where the floor is too high it lies in the wood, and has no wall.
    return float(np.abs(result.by_depth[:-1]).max())
