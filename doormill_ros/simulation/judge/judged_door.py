"""What the simulated cell knows of a door once it is milled: what was touched, and how it came out."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from doormill_ros.arrays import BoolArray, FloatArray
from doormill_ros.frames import inverse
from doormill_ros.recipes.recipe import Recipe
from doormill_ros.simulation.controller.records.executed_path import ExecutedPath
from doormill_ros.simulation.judge.bodies import JudgedCell
from doormill_ros.simulation.judge.judge import judge
from doormill_ros.simulation.judge.milled_part import MilledPart, inspect
from doormill_ros.simulation.judge.pair import Milled, judge_pair
from doormill_ros.simulation.judge.verdict import Verdict


@dataclass(frozen=True, eq=False)
class JudgedDoor:
    """A milled door.

    Attributes:
        verdict: What was touched beside the wood to be cut.
        corrected: How it came out.
        uncorrected: How it would have without correction.
    """

    verdict: Verdict
    corrected: MilledPart
    uncorrected: MilledPart


def judge_door(
    recipe: Recipe,
    T_base_door: FloatArray,
    executed: ExecutedPath,
    uncorrected: ExecutedPath,
    cell: JudgedCell,
    turning: BoolArray,
) -> JudgedDoor:
    """A door that one robot milled.

    Args:
        recipe: The door and its features.
        T_base_door: Where it really stood, shape (4, 4).
        executed: Everything the robot did.
        uncorrected: What it would have done without correction.
        cell: Robot, spindle and obstacles.
        turning: Whether the spindle turned at each sample of `executed`, shape (n,).
    """
    return JudgedDoor(
        judge(recipe, T_base_door, executed, cell, turning),
        inspect(recipe, T_base_door, executed),
        inspect(recipe, T_base_door, uncorrected),
    )


def judge_shared_door(
    recipe: Recipe,
    T_cell_door: FloatArray,
    milled: Sequence[Milled],
    uncorrected: Mapping[str, ExecutedPath],
    cell: JudgedCell,
) -> JudgedDoor:
    """A door of which two robots milled a share each.

    Args:
        recipe: The door and all its features.
        T_cell_door: Where it really stood, shape (4, 4).
        milled: All robots, as of `judge_pair`; one at least moved.
        uncorrected: By robot, what it would have done without correction; what it did where that is missing.
        cell: As of `judge_pair`.
    """
    moved = [own for own in milled if own.executed is not None]
    without = [replace(own, executed=uncorrected.get(own.robot, own.executed)) for own in moved]
    return JudgedDoor(
        judge_pair(recipe, T_cell_door, milled, cell),
        _left_by(recipe, T_cell_door, moved),
        _left_by(recipe, T_cell_door, without),
    )


def _left_by(recipe: Recipe, T_cell_door: FloatArray, milled: Sequence[Milled]) -> MilledPart:
    """The door as all of them left it."""
    seen = [(inverse(own.T_cell_robot) @ T_cell_door, own.executed) for own in milled if own.executed]
    (T_first, executed), *others = seen
    return inspect(recipe, T_first, executed, others=others)
