"""Is there a posture and a way for a feature at all? A search that shares nothing with the planner.

Postures come from the controller's own closed-form kinematics at every turn about the tool axis and on every
branch, ways from a bidirectional random tree in joint space (Kuffner and LaValle 2000), shapes from the judge.
"""

from dataclasses import dataclass, field, replace

import numpy as np

from doormill_ros.frames import inverse, transform
from doormill_ros.recipes.door import R_FEATURE_TOOL
from doormill_ros.robot.description import load_robot
from doormill_ros.simulation.controller.motions.arm import ControllerArm
from doormill_ros.simulation.judge.bodies import Box, load_cell
from doormill_ros.simulation.judge.links import BASE, FLANGE
from doormill_ros.simulation.judge.shapes import cylinder_gap
from support.file_run import HOME

# A hair more than the planner keeps, so that "no posture" says what nobody finds: it looks in samples, he all along.
MARGIN = 0.018  # rad from a joint limit: the planner keeps 1 degree
WRIST = 0.053  # smallest sine of axis 5: the planner keeps 3 degrees
CLEARANCE = 0.0125  # m: the planner keeps 12 mm
STEP = 0.008  # m that no point moves further along a way between two looks
TURNS = np.radians(np.arange(0.0, 360.0, 15.0))
FRONT = 0.030  # m before the surface, where a feature's way begins
REACH = 0.6  # rad of one step of the tree


def seen_from(cell, T_cell_robot):
    """The judged cell with its obstacles in the base frame of a robot that stands elsewhere, shape (4, 4)."""
    T_robot_cell = inverse(T_cell_robot)
    boxes = tuple(replace(box, at=T_robot_cell @ box.at) for box in cell.obstacles)
    return replace(cell, obstacles=boxes)


@dataclass
class WaySearch:
    """Robot and door in the cell."""

    recipe: object
    T_base_door: np.ndarray
    robot: str = "irb6600_175_255"
    clearance: float = CLEARANCE
    T_cell_robot: np.ndarray = field(default_factory=lambda: np.eye(4))  # of a robot beside the cell's first

    def __post_init__(self):
        robot = load_robot(self.robot)
        self.arm = ControllerArm(robot.dh, robot.lower, robot.upper, robot.max_velocity)
        self.low, self.high = robot.lower + MARGIN, robot.upper - MARGIN
        self.cell = seen_from(load_cell(self.robot), self.T_cell_robot)
        size = np.array([self.recipe.thickness, self.recipe.width, self.recipe.height])
        self.door = Box("door", BASE, self.T_base_door @ transform(translation=size / 2.0), size / 2.0)
        self.home = np.radians(HOME)

    def gap(self, q, mill_radius=None, cuts=False):
        """Smallest gap of arm and spindle, and of the mill where a radius is given, at q (n, 6); shape (n,).

        A mill that `cuts` may be in the door.
        """
        frames = self.cell.links.frames(q)
        least = np.full(len(q), np.inf)
        for box in (self.door, *self.cell.obstacles):
            T = inverse(box.at)
            for body in self.cell.bodies:
                least = np.minimum(least, body.gap(T @ frames[body.link], box.half))
            if mill_radius is not None and not (cuts and box is self.door):
                tool = T @ frames[FLANGE] @ self.cell.T_flange_tool
                back = tool[:, :3, 3] - self.cell.nose * tool[:, :3, 2]
                radius = np.full(len(q), mill_radius)
                least = np.minimum(least, cylinder_gap(tool[:, :3, 3], back, radius, box.half))
        return least

    def postures(self, feature, turns=TURNS, front=FRONT, mill_radius=None):
        """Joint angles in front of a feature, (k, 6), from which all of it is served on one branch and turn.

        Second, why the others are none: how many (turn, branch) fail by reach and limits, by wrist, by touch.

        Args:
            feature: What is to be milled.
            turns: Turns about the tool axis that are allowed [rad].
            front: How far before the surface its way begins [m].
            mill_radius: Of the mill that must touch nothing but the door; None: of the feature's tool [m].
        """
        inset = min(feature.tool.radius, feature.shape.width / 2 - 1e-6, feature.shape.length / 2 - 1e-6)
        ring = feature.outline(inset=inset).points(step=0.02)
        depths = [-front, 0.0, feature.cut_depth(self.recipe.size)]
        points = np.concatenate([np.column_stack([ring, np.full(len(ring), z)]) for z in depths])
        T_feature = self.T_base_door @ self.recipe.T_door_feature(feature)
        radius = feature.tool.radius if mill_radius is None else mill_radius
        found, why = [], {"reach": 0, "wrist": 0, "touch": 0}
        for turn in turns:
            c, s = np.cos(turn), np.sin(turn)
            tool = R_FEATURE_TOOL @ np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
            T = T_feature @ np.stack([transform(tool, point) for point in points])
            all_q = self.arm.branches(T @ inverse(self.cell.T_flange_tool))  # (n, 8, 6)
            for branch in range(8):
                q = all_q[:, branch]
                if np.isnan(q).any():
                    why["reach"] += 1
                    continue
                q = np.unwrap(q, axis=0)
                fits = False
                for k in np.ndindex(3, 3, 3):
                    shifted = q + 2 * np.pi * (np.array([k[0], 0, 0, k[1], 0, k[2]]) - [1, 0, 0, 1, 0, 1])
                    if np.all((shifted > self.low) & (shifted < self.high)):
                        q, fits = shifted, True
                        break
                if not fits:
                    why["reach"] += 1
                elif np.abs(np.sin(q[:, 4])).min() < WRIST:
                    why["wrist"] += 1
                elif self.gap(q, radius, cuts=True).min() < self.clearance:
                    why["touch"] += 1
                else:
                    found.append(q[0])
        return np.array(found).reshape(-1, 6), why

    def free(self, start, end, mill_radius):
        """Whether the straight way in joint space is free."""
        turned = np.abs(end - start)
        way = max(turned @ self.cell.links.reach(body.link, body.extent) for body in self.cell.bodies)
        count = max(2, int(np.ceil(way / STEP)) + 1)
        # From coarse to fine, so that most ways that are not free are left early.
        for share in (np.linspace(0, 1, min(count, 9)), np.linspace(0, 1, count)):
            q = start + share[:, None] * (end - start)
            if self.gap(q, mill_radius).min() < self.clearance:
                return False
        return True

    def way(self, goal, mill_radius, seed=0, tries=400):
        """Joint angles from home to a posture, or None where none was found in so many tries."""
        if self.gap(np.stack([self.home, goal]), mill_radius).min() < self.clearance:
            return None
        if self.free(self.home, goal, mill_radius):
            return [self.home, goal]
        rng = np.random.default_rng(seed)
        trees = ([(self.home, -1)], [(goal, -1)])
        low, high = np.maximum(self.low, -np.pi), np.minimum(self.high, np.pi)
        for number in range(tries):
            mine, other = trees if number % 2 == 0 else trees[::-1]
            aim = rng.uniform(low, high)
            if rng.random() < 0.3:
                aim = other[rng.integers(len(other))][0] + rng.normal(0, 0.1, 6)
            at = int(np.argmin([np.abs(q - aim).max() for q, _ in mine]))
            step = aim - mine[at][0]
            new = mine[at][0] + step * min(1.0, REACH / np.abs(step).max())
            if np.any((new < self.low) | (new > self.high)) or not self.free(mine[at][0], new, mill_radius):
                continue
            mine.append((new, at))
            near = int(np.argmin([np.abs(q - new).max() for q, _ in other]))
            if self.free(new, other[near][0], mill_radius):
                ends = (_back(mine, len(mine) - 1), _back(other, near))
                first, second = ends if mine is trees[0] else ends[::-1]
                return [*first[::-1], *second]
        return None

    def serves(self, feature, seed=0, tries=400):
        """What speaks for a feature: "way", "posture" without a way, or why there is no posture."""
        postures, why = self.postures(feature)
        if not len(postures):
            return "no posture: " + ", ".join(f"{name} {n}" for name, n in why.items() if n)
        order = np.argsort(np.abs(postures - self.home).max(axis=1))
        for goal in postures[order][:4]:
            if self.way(goal, feature.tool.radius, seed, tries) is not None:
                return "way"
        return "posture"


def _back(tree, at):
    """Angles from a node to its root."""
    found = []
    while at >= 0:
        q, at = tree[at]
        found.append(q)
    return found
