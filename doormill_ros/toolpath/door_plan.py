"""The nominal path of a whole door: every feature of a robot's share, and the air between them."""

from __future__ import annotations

import functools
import itertools
import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace

import numpy as np
from scipy.spatial.transform import Rotation, Slerp

from doormill_ros.arrays import FloatArray
from doormill_ros.recipes.door import R_DOOR_FEATURE, R_FEATURE_TOOL, Material, Side
from doormill_ros.recipes.features.base import Feature
from doormill_ros.recipes.program import Program, fits_path_20
from doormill_ros.recipes.recipe import Recipe
from doormill_ros.toolpath.curves.curve import Line
from doormill_ros.toolpath.cuts.engagement import with_forces
from doormill_ros.toolpath.cuts.operation import Operation, operation
from doormill_ros.toolpath.cuts.pocket import pocket_steps
from doormill_ros.toolpath.cuts.thesis_path import thesis_plan
from doormill_ros.toolpath.errors import NothingToMillError
from doormill_ros.toolpath.plan import Plan, Step
from doormill_ros.toolpath.program import MotionKind
from doormill_ros.toolpath.settings import PathSettings

#: The three targets of an arc of Path_20 are corrected apart, by up to 0.2 mm differently. On a circle not much larger
#: than that the arc through them is another one altogether [m].
SMALLEST_TURN = 0.002
#: Path_20 clears a pocket by its contour alone: the cuts of the two sides overlap in the middle by twice this at least,
#: more than the deflections of the two that 14 targets leave uncorrected [m].
OVERLAP = 0.0005
SWING_PARTS = 4  #: motions in which the tool turns round an edge of the door


def whole_door(recipe: Recipe) -> list[Operation]:
    """Every feature of the recipe in its order, through holes in one go: one robot mills all."""
    return [operation(feature, recipe.size) for feature in recipe.features]


def door_plan(
    recipe: Recipe,
    operations: Sequence[Operation],
    settings: PathSettings,
    retreats: Mapping[int, float] | None = None,
    free: Collection[int] = (),
) -> Plan:
    """Nominal path on the door.

    A door of the program Path_20 gets exactly the thesis' targets and motions, if one robot mills
    it with a mill that may go straight down, its turns are wide enough for arcs through three targets and its pockets
    narrow enough to be cleared by them. Any other is milled feature by feature: with a MoveAbsJ to the first one
    and wherever the spindle has to swing, in straight lines in front of the face otherwise.

    Args:
        recipe: The door.
        operations: What this robot mills, in order.
        settings: Clearances and speeds.
        retreats: Operations before which the robot draws back this far [m] and changes joint by
            joint, free to take another configuration. It goes straight and close to the others,
            and round an edge of the door it always draws back.
        free: Operations to which the robot goes joint by joint all the way, by postures that are to be found.

    Raises:
        NothingToMillError: There is no operation.
        ToolFitError: A tool is too wide for its feature.
    """
    if not operations:
        raise NothingToMillError(
            f"door {recipe.door_id} leaves this robot 0 features, allowed is at least 1; "
            "check the recipe or the split of the work"
        )
    drawn_back = tuple(sorted((retreats or {}).items()))
    return _planned(recipe.program, recipe.material, tuple(operations), settings, drawn_back, frozenset(free))


@functools.lru_cache(maxsize=64)  # nothing of it hangs on where the door stands
def _planned(
    program: Program,
    material: Material,
    operations: tuple[Operation, ...],
    settings: PathSettings,
    retreats: tuple[tuple[int, float], ...],
    free: frozenset[int],
) -> Plan:
    """As `door_plan`; `retreats` are numbers of operations with the distances [m]."""
    if (
        program is Program.PATH_20
        and fits_path_20([item.feature for item in operations])
        and all(
            item.feature.tool.centre_cutting
            and SMALLEST_TURN <= turn_radius(item.feature) <= item.feature.tool.radius - OVERLAP
            for item in operations
        )
    ):
        return thesis_plan(operations, settings)
    steps: list[Step] = []
    before: Operation | None = None
    distances = dict(retreats)
    for number, item in enumerate(operations):
        cuts = list(_cuts(item, material, settings))
        if steps:
            cuts = _at_one_speed(cuts, steps[-1].spindle_speed, item, settings)
        if before is not None and number in free:
            at, goal = steps[-1].curve.end, cuts[0].curve.end
            steps.append(_air(cuts[0], at, goal, MotionKind.ABSOLUTE))
        else:
            steps += _way(before, item, steps, cuts[0], settings, distances.get(number))
        steps += cuts[1:]
        before = item
    ways = settings.approach.way_speed
    return Plan(tuple(step if step.feature else step.changed(speed=ways) for step in steps))


def _at_one_speed(cuts: list[Step], before: float, item: Operation, settings: PathSettings) -> list[Step]:
    """The steps at the spindle speed of the feature before [rad/s] if it is hardly another one: no stop for that."""
    own, tool = cuts[0].spindle_speed, item.feature.tool
    chip = item.feature.cutting.chip(tool) * own / before  # the feed stays
    allowed = before <= tool.max_spindle_speed and chip <= (tool.max_chip_load or math.inf)
    if not allowed or abs(own - before) >= settings.cycle.same_spindle * before:
        return cuts
    return [step.changed(spindle_speed=before) for step in cuts]


@functools.lru_cache(maxsize=128)  # a plan is made anew for every way between features that is tried
def _cuts(item: Operation, material: Material, settings: PathSettings) -> tuple[Step, ...]:
    steps = pocket_steps(item, settings)
    return tuple(
        with_forces(steps, item, material, settings.correction.blend)
        if item.feature.computes_force
        else steps
    )


def turn_radius(feature: Feature) -> float:
    """Radius of the tool's path round the ends of an oblong pocket [m]."""
    return feature.shape.width / 2.0 - feature.tool.radius


def _way(
    before: Operation | None,
    after: Operation,
    steps: Sequence[Step],
    first: Step,
    settings: PathSettings,
    far: float | None,
) -> list[Step]:
    """Motions from where the last feature ended to the front of the next one."""
    goal = first.curve.end
    if before is None:
        return [_air(first, goal, goal, MotionKind.ABSOLUTE)]
    last = steps[-1]
    at = last.curve.end
    if before.side is after.side and far is None:
        return [_air(first, at, goal, MotionKind.LINEAR)]
    distance = settings.approach.edge_clearance if far is None or before.side is not after.side else far
    out = distance - settings.approach.clearance
    back, wait = at - out * last.R_door_tool[:, 2], goal - out * first.R_door_tool[:, 2]
    way = [_air(last, at, back, MotionKind.LINEAR)]
    if before.side is after.side:
        way.append(_air(first, back, wait, MotionKind.ABSOLUTE))
    else:
        way += _round_the_edge(before, after, last, first, back, wait, settings.approach.edge_clearance)
    return [*way, _air(first, wait, goal, MotionKind.LINEAR)]


def _round_the_edge(
    before: Operation,
    after: Operation,
    last: Step,
    first: Step,
    back: FloatArray,
    wait: FloatArray,
    distance: float,
) -> list[Step]:
    """From one side of the door to another, off the edge between them.

    The robot stands before the front, so the corner is always passed with the spindle facing the
    front: facing an edge there it would have to reach round itself.
    """
    if before.side.is_edge and after.side.is_edge:
        facing = replace(first, R_door_tool=R_DOOR_FEATURE[Side.FRONT] @ R_FEATURE_TOOL)
        near, far = (np.array([-distance, *place[1:]]) for place in (back, wait))
        across = _air(facing, near, far, MotionKind.LINEAR)
        return [*_swing(last, facing, back, near), across, *_swing(facing, first, far, wait)]
    corner = _beyond_both(back, wait, last.R_door_tool[:, 2], first.R_door_tool[:, 2])
    if before.side.is_edge:
        return [*_swing(last, first, back, corner), _air(first, corner, wait, MotionKind.LINEAR)]
    return [_air(last, back, corner, MotionKind.LINEAR), *_swing(last, first, corner, wait)]


def _swing(last: Step, first: Step, start: FloatArray, end: FloatArray) -> list[Step]:
    """Turn the spindle on the way, in parts so small that a MoveAbsJ goes almost straight."""
    share = np.arange(1, SWING_PARTS + 1) / SWING_PARTS
    ends = Rotation.from_matrix(np.stack([last.R_door_tool, first.R_door_tool]))
    turned = Slerp([0.0, 1.0], ends)(share).as_matrix()
    turned[-1] = first.R_door_tool
    places = [start, *(start + share[:, None] * (end - start))]
    return [
        replace(_air(first, a, b, MotionKind.ABSOLUTE), R_door_tool=R)
        for (a, b), R in zip(itertools.pairwise(places), turned, strict=True)
    ]


def _beyond_both(back: FloatArray, wait: FloatArray, first: FloatArray, second: FloatArray) -> FloatArray:
    """The point in front of both sides, at the height of the next feature, shape (3,) [m].

    Args:
        back: In front of the side just milled.
        wait: In front of the side to come.
        first: Unit direction of the tool at the former, into the wood.
        second: The same at the latter.
    """
    corner = wait.copy()
    corner += first * ((back - corner) @ first)
    return corner + second * ((wait - corner) @ second)


def _air(pattern: Step, start: FloatArray, end: FloatArray, kind: MotionKind) -> Step:
    return Step(
        kind,
        Line(start, end),
        pattern.R_door_tool,
        pattern.speed,
        zone="fine",
        spindle_speed=pattern.spindle_speed,
    )
