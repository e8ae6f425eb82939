"""Choose one configuration for a whole path: reachable, away from trouble, as stiff as can be."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.robot.branch_rules import BranchRules, Rejected, check_reach, refusal, too_close
from doormill_ros.robot.chain import JOINTS
from doormill_ros.robot.description import Robot
from doormill_ros.robot.errors import (
    BranchError,
    JointLimitError,
    RobotError,
    SingularityError,
)
from doormill_ros.robot.inverse import BRANCHES, inverse_branches
from doormill_ros.robot.kinematics import Kinematics
from doormill_ros.robot.singularity import clearance

_TURN = 2.0 * np.pi
_WRIST_ROLLS = (3, 5)  # joints that turn about one line where axis 5 is straight


def choose_branch(
    robot: Robot,
    T_base_flange: FloatArray,
    *,
    rules: BranchRules | None = None,
    segment: FloatArray | None = None,
    branches: Iterable[int] = range(BRANCHES),
    turn_over: bool = False,
) -> FloatArray:
    """Joint angles along a path in one configuration.

    A candidate is a branch, followed continuously along the path, with the whole turns of its
    joints. Of those that keep to the rules the one whose softest pose is stiffest wins, by the
    translational compliance of the flange under the robot's own joint stiffness; among equally
    stiff ones the one farthest from its limits.

    Args:
        robot: The robot.
        T_base_flange: Poses in the order of the path, shape (n, 4, 4).
        rules: What to keep to; None for the defaults.
        segment: Label of the segment each pose belongs to, shape (n,). Between neighbouring segments
            the robot is free to move joint by joint; when no one configuration serves the whole
            path the wrist may flip there. None for a path that allows no change.
        branches: Branches (cfx) to choose from.
        turn_over: Whether the arm, too, may be turned over between segments that none of its postures serves alone.

    Returns:
        Joint angles, shape (n, 6) [rad].

    Raises:
        UnreachableError: A pose is out of reach.
        JointLimitError: Every way exceeds a joint limit.
        SingularityError: Every way within the limits passes too close to a singularity.
        BranchError: Each pose can be reached, yet no configuration serves the path.
        GeometryError: The robot has no closed-form inverse here.
    """
    rules = rules or BranchRules()
    T_base_flange = np.asarray(T_base_flange, dtype=float)
    if T_base_flange.ndim != 3 or T_base_flange.shape[1:] != (4, 4) or not len(T_base_flange):
        raise ValueError(f"the path has shape {T_base_flange.shape}, allowed is (n, 4, 4) with n > 0")
    solutions = inverse_branches(robot, T_base_flange)
    check_reach(robot, T_base_flange, solutions)
    n = len(solutions)
    labels = np.zeros(n, dtype=int) if segment is None else np.asarray(segment)
    if labels.shape != (n,):
        raise ValueError(f"segment has shape {labels.shape}, allowed is ({n},), one label a pose")
    borders = [0, *(np.nonzero(labels[1:] != labels[:-1])[0] + 1).tolist(), n]
    search = _Search(robot, rules, _flange_compliance(robot))
    try:
        return search.best(solutions, branches, borders)[1]
    except (JointLimitError, SingularityError, BranchError):
        if len(borders) == 2:
            raise
    return _piecewise(search, solutions, tuple(branches), borders, turn_over)


def _piecewise(
    search: _Search,
    solutions: FloatArray,
    allowed: tuple[int, ...],
    borders: list[int],
    turn_over: bool,
) -> FloatArray:
    """One configuration a segment.

    The wrist may flip between segments; the arm keeps its posture where it can, because turning elbow or base
    over in front of a door sweeps the whole cell.
    """
    found: list[tuple[int, float, FloatArray]] = []
    refused: RobotError | None = None
    for arm in range(0, BRANCHES, 2):
        parts: list[FloatArray] = []
        softness, turned, now = 0.0, 0, arm
        try:
            for first, last in itertools.pairwise(borders):
                before = parts[-1][-1] if parts else None
                arms = [now, *(other for other in range(0, BRANCHES, 2) if other != now)]
                flips = [[branch for branch in (one, one + 1) if branch in allowed] for one in arms]
                each = flips if turn_over else flips[:1]
                at, soft, q = search.first_of(each, solutions[first:last], first, before)
                softness, turned, now = max(softness, soft), turned + (at > 0), arms[at]
                parts.append(q)
        except RobotError as error:
            refused = refused or error
            continue
        found.append((turned, softness, np.concatenate(parts)))
    if refused and not found:
        raise refused
    return min(found, key=lambda item: item[:2])[2]


@dataclass(frozen=True, eq=False)
class _Search:
    robot: Robot
    rules: BranchRules
    compliance: Callable[[FloatArray], FloatArray]

    def best(
        self,
        solutions: FloatArray,
        allowed: Iterable[int],
        borders: list[int],
        first: int = 0,
        start: FloatArray | None = None,
    ) -> tuple[float, FloatArray]:
        """Largest compliance and joint angles of the best candidate; `first` numbers its first pose.

        Among equally stiff ones that is the nearest to `start`, shape (6,) [rad], where there is one.
        """
        rejected = Rejected()
        best: tuple[float, float, FloatArray] | None = None
        for branch in allowed:
            if np.isnan(solutions[:, branch]).any():
                continue
            path = _unwrapped(solutions[:, branch])
            candidates, over = _turns(self.robot, path, self.rules, first)
            # Near a singularity of the wrist axes 4 and 6 wind up; then it is to blame, not they.
            if over and over[1] not in _WRIST_ROLLS:
                rejected.limits.append(over)
                continue
            if not self._passable(path, borders, rejected, first):
                continue
            if over:
                rejected.rolls.append(over)
            softness = float(np.max(self.compliance(path)))
            for candidate in candidates:
                merit = _closeness(self.robot, candidate, start)
                if best is None or _better((softness, merit), best[:2], self.rules.equal_compliance):
                    best = (softness, merit, candidate)
        if best is None:
            raise refusal(self.robot, rejected, self.rules, len(solutions), first)
        return best[0], best[2]

    def first_of(
        self, choices: Sequence[list[int]], solutions: FloatArray, first: int, start: FloatArray | None
    ) -> tuple[int, float, FloatArray]:
        """Which of several choices of branches serves a segment first, and what `best` says of it.

        Raises:
            RobotError: What the first choice is refused for, where none serves it.
        """
        refused: RobotError | None = None
        for number, allowed in enumerate(choices):
            try:
                return number, *self.best(solutions, allowed, [0, len(solutions)], first, start)
            except RobotError as error:
                refused = refused or error
        assert refused is not None
        raise refused

    def _passable(self, path: FloatArray, borders: list[int], rejected: Rejected, first: int) -> bool:
        reason = too_close(clearance(self.robot, path), self.rules, first)
        if reason:
            rejected.singular.append(reason)
            return False
        step = np.abs(np.diff(path, axis=0))
        step[np.array(borders[1:-1], dtype=int) - 1] = 0.0  # between segments the robot moves freely
        if step.size and step.max() > self.rules.max_step:
            at, joint = np.unravel_index(step.argmax(), step.shape)
            rejected.steps.append((float(step.max()), first + int(at), int(joint)))
            return False
        return True


def _unwrapped(path: FloatArray) -> FloatArray:
    """Joint angles without whole turns between neighbours; most have none, and to see that is quicker."""
    jumps = np.abs(np.diff(path, axis=0)) > 0.5 * _TURN
    return np.unwrap(path, axis=0, period=_TURN) if jumps.any() else path


def _turns(
    robot: Robot, path: FloatArray, rules: BranchRules, first: int
) -> tuple[list[FloatArray], tuple[float, int, int] | None]:
    """The path shifted by whole turns of its joints so that all poses are within the limits.

    When there is no such shift: the deciding excess [rad], its joint and its pose.
    """
    shifts: list[list[float]] = []
    worst: list[tuple[float, int, int]] = []
    lowest, highest = path.min(axis=0).tolist(), path.max(axis=0).tolist()
    floors = (robot.lower + rules.limit_margin).tolist()
    ceilings = (robot.upper - rules.limit_margin).tolist()
    for joint, (low, high, floor, ceiling) in enumerate(zip(lowest, highest, floors, ceilings, strict=True)):
        turns = range(math.ceil((floor - low) / _TURN), math.floor((ceiling - high) / _TURN) + 1)
        shifts.append([turn * _TURN for turn in turns])
        if not turns:
            over, turn = min(
                (max(floor - low - t * _TURN, high + t * _TURN - ceiling), t) for t in (-1, 0, 1)
            )
            angle = path[:, joint] + turn * _TURN
            beyond = np.maximum(floor - angle, angle - ceiling)
            worst.append((float(over), joint, first + int(beyond.argmax())))
    if not all(shifts):
        # An arm joint that cannot follow decides, however far the rolls of the wrist are out.
        return [], max([over for over in worst if over[1] not in _WRIST_ROLLS] or worst)
    grid = np.stack(np.meshgrid(*shifts, indexing="ij"), axis=-1).reshape(-1, JOINTS)
    return [path + shift for shift in grid], None


def _closeness(robot: Robot, path: FloatArray, start: FloatArray | None) -> float:
    """Smaller is better: time to the first pose [s], or how far joints stray from mid-range [-]."""
    if start is not None:
        return float(np.max(np.abs(path[0] - start) / robot.max_velocity))
    middle, half = (robot.upper + robot.lower) / 2.0, (robot.upper - robot.lower) / 2.0
    return float(np.linalg.norm(np.abs((path - middle) / half).max(axis=0)))


def _better(new: tuple[float, float], old: tuple[float, float], equal: float) -> bool:
    if new[0] * equal < old[0]:
        return True
    return new[0] <= old[0] * equal and new[1] < old[1] - 1e-9


def _flange_compliance(robot: Robot) -> Callable[[FloatArray], FloatArray]:
    """Root mean square translation of the flange per unit force, over all directions [m/N]."""
    kinematics = Kinematics(robot)

    def compliance(q: FloatArray) -> FloatArray:
        J = kinematics.jacobian(q)[..., :3, :]
        C = (J / robot.stiffness) @ np.swapaxes(J, -1, -2)
        length: FloatArray = np.sqrt(np.einsum("...ij,...ij->...", C, C) / 3.0)
        return length

    return compliance
