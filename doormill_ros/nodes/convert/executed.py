"""What the robot did and how the door came out."""

from __future__ import annotations

import numpy as np
from geometry_msgs.msg import Point
from std_msgs.msg import Header

from doormill_interfaces.msg import DoorPlacement, FeatureDeviation, MilledDoor, RunVerdict
from doormill_interfaces.msg import ExecutedPath as ExecutedPathMessage
from doormill_interfaces.msg import Touch as TouchMessage
from doormill_ros.arrays import FloatArray
from doormill_ros.messages.from_message import transform_of, transforms_of, wrenches_of
from doormill_ros.nodes.convert.geometry import pose_messages, wrench_message
from doormill_ros.recipes.recipe import Recipe
from doormill_ros.simulation.controller.records.executed_path import ExecutedPath
from doormill_ros.simulation.errors import RunMessageError
from doormill_ros.simulation.judge.milled_part import MilledPart
from doormill_ros.simulation.judge.verdict import Harm, Touch, Verdict, WoodGone

#: s, m, rad, N, Nm; what a cell does within a day is below, and squares of it stay far from overflow
MOST = 1e5


def executed_message(path: ExecutedPath, header: Header, placement: DoorPlacement) -> ExecutedPathMessage:
    """All samples of an executed path."""
    return ExecutedPathMessage(
        header=header,
        run_id=placement.run_id,
        door_id=placement.door_id,
        time=path.time.tolist(),
        actual=pose_messages(path.T_base_tool),
        commanded=pose_messages(path.T_base_tool_commanded),
        joint_positions=path.q.ravel().tolist(),
        motion=path.motion.tolist(),
        cutting=path.cutting.tolist(),
        wrench=[wrench_message(w) for w in path.wrench],
        feature=path.feature.tolist(),
        tool=[] if path.tool is None else path.tool.tolist(),
    )


def executed_of(message: ExecutedPathMessage) -> ExecutedPath:
    """What a robot did; who watched spindle and guard is not told.

    Raises:
        RunMessageError: Its columns differ in length or hold what is no number, or its time runs backwards.
    """
    try:
        path = ExecutedPath(
            time=np.array(message.time),
            T_base_tool=transforms_of(message.actual),
            T_base_tool_commanded=transforms_of(message.commanded),
            q=np.array(message.joint_positions).reshape(-1, 6),
            motion=np.array(message.motion),
            cutting=np.array(message.cutting),
            feature=np.array(message.feature),
            wrench=wrenches_of(message.wrench),
            tool=np.array(message.tool) if message.tool else None,
        )
        for name in ("time", "T_base_tool", "T_base_tool_commanded", "q", "wrench"):
            if np.any(np.abs(getattr(path, name)) > MOST):
                raise ValueError(f"{name} holds numbers beyond {MOST:g}")
    except ValueError as error:
        raise RunMessageError(
            f"the executed path of run {message.run_id!r} cannot be judged: {error}; see who sends it",
            run_id=message.run_id,
        ) from error
    return path


def placed_at(placement: DoorPlacement) -> FloatArray:
    """Where the door stood, door in the cell's base, shape (4, 4).

    Raises:
        RunMessageError: Nowhere near a cell.
    """
    T_base_door = transform_of(placement.pose)
    if not np.all(np.abs(T_base_door) <= MOST):
        raise RunMessageError(
            f"the door of run {placement.run_id!r} stands {MOST:g} m or more away; see who sends its placement",
            run_id=placement.run_id,
        )
    return T_base_door


def milled_message(
    recipe: Recipe,
    corrected: MilledPart,
    uncorrected: MilledPart,
    tolerance: float,
    header: Header,
    placement: DoorPlacement,
) -> MilledDoor:
    """Deviations of every feature, as milled and without correction."""
    features = []
    for feature in recipe.features:
        with_correction = corrected.feature(feature.id)
        without = uncorrected.feature(feature.id)
        features.append(
            FeatureDeviation(
                feature=feature.id,
                kind=feature.kind,
                corrected_max=with_correction.worst,
                uncorrected_max=without.worst,
                arc_length=np.asarray(with_correction.station).tolist(),
                corrected=np.asarray(with_correction.deviation).tolist(),
                uncorrected=np.asarray(without.deviation).tolist(),
            )
        )
    return MilledDoor(
        header=header,
        run_id=placement.run_id,
        door_id=placement.door_id,
        corrected_max=corrected.worst,
        uncorrected_max=uncorrected.worst,
        tolerance=tolerance,
        features=features,
    )


def verdict_message(verdict: Verdict, header: Header, placement: DoorPlacement) -> RunVerdict:
    """What a run touched, bodies first."""
    error = verdict.error
    return RunVerdict(
        header=header,
        run_id=placement.run_id,
        door_id=placement.door_id,
        success=error is None,
        error_code=0 if error is None else error.code,
        message=verdict.sentence,
        judged=verdict.judged,
        touched=verdict.touched_samples,
        volume=verdict.volume,
        touches=[_touch_message(touch) for touch in verdict.harm],
    )


def _touch_message(touch: Harm) -> TouchMessage:
    x, y, z = touch.place.tolist()
    return TouchMessage(
        body=touch.body if isinstance(touch, Touch) else "mill",
        obstacle=touch.obstacle if isinstance(touch, Touch) else "door",
        motion=touch.motion,
        feature=touch.feature,
        time=touch.time,
        depth=touch.depth,
        place=Point(x=x, y=y, z=z),
        volume=touch.volume if isinstance(touch, WoodGone) else 0.0,
        samples=len(touch.samples),
    )
