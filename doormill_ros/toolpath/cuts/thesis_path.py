"""The program of the thesis: two hinges, 14 targets, Path_20 (figures 3.36, 3.40 and 3.41)."""

from __future__ import annotations

from collections.abc import Sequence

from doormill_ros.arrays import FloatArray
from doormill_ros.recipes.features.hinge_pocket import OblongHinge
from doormill_ros.toolpath.curves.curve import Line
from doormill_ros.toolpath.cuts.operation import Operation
from doormill_ros.toolpath.plan import Plan, Step
from doormill_ros.toolpath.program import MotionKind
from doormill_ros.toolpath.settings import PathSettings


def thesis_plan(operations: Sequence[Operation], settings: PathSettings) -> Plan:
    """The 14 targets and the motions between Target_Home and Target_Home2.

    The home positions belong to the RAPID program. `init` stands straight in front of target 11,
    so that the way into the wood follows the tool axis.

    Args:
        operations: Two operations whose features `fits_path_20`.
        settings: Clearance and speeds.
    """
    steps: list[Step] = []
    order: list[str] = []
    for index, operation in enumerate(operations):
        tens = 10 * (index + 1)
        init = "init" if index == 0 else f"init{index + 1}"
        order += [init, *(f"{tens + i}" for i in range(6))]
        steps += _hinge(operation, settings, tens, init, steps[-1].curve.end if steps else None)
    return Plan(tuple(steps), tuple(order))


def _hinge(
    operation: Operation, settings: PathSettings, tens: int, init: str, before: FloatArray | None
) -> list[Step]:
    feature, approach = operation.feature, settings.approach
    if not isinstance(feature, OblongHinge):
        raise TypeError(f"{feature.id} is a {feature.kind}, Path_20 mills oblong hinges")
    depth, R_door_tool = operation.depth, operation.R_door_tool
    pieces = operation.contour(feature.tool.radius, depth)  # top turn, right, bottom turn, left
    start = operation.point(feature.point_positions(feature.tool.radius)[1], depth)
    front = operation.point(feature.point_positions(feature.tool.radius)[1], -approach.clearance)
    feed, spindle = feature.cutting.feed_rate(feature.tool), feature.cutting.spindle(feature.tool)

    def air(
        origin: FloatArray, end: FloatArray, speed: float, name: str, kind: MotionKind = MotionKind.LINEAR
    ) -> Step:
        return Step(
            kind,
            Line(origin, end),
            R_door_tool,
            speed,
            name=name,
            feature=feature.id,
            spindle_speed=spindle,
        )

    first = f"{tens + 1}"
    names = [(f"{tens + 2}", f"{tens}"), (f"{tens + 4}", ""), (f"{tens + 3}", f"{tens + 5}"), (first, "")]
    cut = [
        Step(
            MotionKind.CIRCULAR if curve.is_arc else MotionKind.LINEAR,
            curve,
            R_door_tool,
            feed,
            feature=feature.id,
            cutting=True,
            wall=True,
            wrench_tool=feature.wrench(segment),
            std_tool=feature.wrench_std(segment),
            bounded=not feature.force_origin.measured,
            kind_of_feature=feature.kind,
            spindle_speed=spindle,
            name=name,
            via_name=via,
        )
        for (curve, segment), (name, via) in zip(pieces, names, strict=True)
    ]
    # Path_20 comes in a straight line from its own home; another home may have another configuration.
    if before is None:
        way = air(front, front, approach.rapid_speed, "", MotionKind.ABSOLUTE)
        arrive = [way, air(front, front, approach.rapid_speed, init)]
    else:
        arrive = [air(before, front, approach.plunge_speed, init)]
    return [
        *arrive,
        air(front, start, approach.plunge_speed, first),
        *cut,
        air(start, front, approach.plunge_speed, init),
    ]
