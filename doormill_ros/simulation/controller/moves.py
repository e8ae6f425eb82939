"""From a RAPID motion instruction to a planned motion, with the checks of the motion supervision."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from doormill_ros.abb.errors import AbbError
from doormill_ros.arrays import FloatArray
from doormill_ros.frames import from_wxyz, inverse
from doormill_ros.simulation.controller.motions.arm import QUARTER, ControllerArm
from doormill_ros.simulation.controller.motions.curves import TcpArc, TcpCurve, TcpLine
from doormill_ros.simulation.controller.motions.limits import ControllerLimits
from doormill_ros.simulation.controller.operation.panel import Log
from doormill_ros.simulation.controller.rapid.errors import RapidMotionError
from doormill_ros.simulation.controller.rapid.machine import Move
from doormill_ros.simulation.controller.rapid.types import Value
from doormill_ros.units import deg_to_rad, mm_to_m, rad_to_deg, s_to_ms

#: Deviations of |q.q| from 1: above the first a warning, above the second an error.
UNIT_WARNING, UNIT_ERROR = 1e-5, 0.1
#: How far outside its quarter an axis may end before its configuration counts as another [rad].
BORDER = 1e-3
#: Events: close to singularity (industrialmonitordirect.com), too many closely spaced positions
#: (ros-industrial/abb#185), configuration [?].
SINGULARITY, CLOSELY_SPACED, CONFIGURATION = 50026, 50078, 50080
#: Poses at which a Cartesian motion is tried out before it starts.
TRIALS = 41


@dataclass(frozen=True)
class MotionContext:
    """What a motion is for, as far as the simulated process needs to know.

    Attributes:
        index: Index in the milling program, -1 for a motion that is not in it.
        feature: Feature it mills, empty between features.
        cutting: Whether the tool is in the wood.
    """

    index: int = -1
    feature: str = ""
    cutting: bool = False


@dataclass(frozen=True, eq=False)
class PlannedMove:
    """A motion that passed all checks.

    Attributes:
        curve: Tool path; None for a joint motion.
        q_start: Joint angles before it, shape (6,) [rad].
        q_end: Joint angles at its target, shape (6,) [rad].
        T_base_tool_end: Pose at its target, shape (4, 4).
        T_flange_tool: Tool of the instruction, shape (4, 4).
        length: Path of the tool centre point [m].
        duration: At the programmed speed, and no less than a motion must take [s].
        zone: Radius in which it may be left for the next one [m]; 0 stops at the target.
        context: What it is for.
        move: The instruction.
    """

    curve: TcpCurve | None
    q_start: FloatArray
    q_end: FloatArray
    T_base_tool_end: FloatArray
    T_flange_tool: FloatArray
    length: float
    duration: float
    zone: float
    context: MotionContext
    move: Move


class MovePlanner:
    """Plans motions one after the other, each from the target of the one before."""

    def __init__(self, arm: ControllerArm, log: Log, limits: ControllerLimits | None = None) -> None:
        """Plan for an arm; `log` takes warnings, None for `limits` is the strict ones."""
        self._arm = arm
        self._log = log
        self._limits = limits or ControllerLimits()
        self._short_in_row = 0
        self.linear_supervision = True
        self.joint_configuration = True

    def plan(
        self, move: Move, q: FloatArray, T_base_tool: FloatArray | None, context: MotionContext
    ) -> PlannedMove:
        """Check and plan one instruction.

        Args:
            move: The instruction.
            q: Joint angles at the end of the motion before, shape (6,) [rad].
            T_base_tool: Programmed pose there with the same tool, None to take it from `q`.
            context: What the motion is for.

        Raises:
            RapidMotionError: What the supervision objects to, with file and line.
        """
        T_flange_tool = self._frame(move, move.tool[1], "the tool frame")
        wobj = self._frame(move, move.wobj[3], "the user frame") @ self._frame(
            move, move.wobj[4], "the object frame"
        )
        self._check_tool(move)
        speed = mm_to_m(move.speed[0])
        turning = deg_to_rad(move.speed[1])
        if speed <= 0.0 or turning <= 0.0:
            raise self._error(
                move, f"speed is {move.speed[0]:g} mm/s and {move.speed[1]:g} deg/s", "more than 0"
            )
        zone = 0.0 if move.zone[0] else mm_to_m(move.zone[1])
        if zone < 0.0:
            raise self._error(move, f"the zone is {move.zone[1]:g} mm", "0 and more")
        if move.kind in ("MoveJ", "MoveAbsJ"):
            q_end = self._joint_target(move, wobj, T_flange_tool, q)
            samples = self._arm.forward(np.linspace(q, q_end, 21)) @ T_flange_tool
            length = float(np.linalg.norm(np.diff(samples[:, :3, 3], axis=0), axis=1).sum())
            end, turn = samples[-1], TcpLine(samples[0], samples[-1]).turn
            curve: TcpCurve | None = None
            if move.kind == "MoveJ":
                end = wobj @ self._pose(move, move.target, "the target")
        else:
            start = self._arm.forward(q)[0] @ T_flange_tool if T_base_tool is None else T_base_tool
            curve = self._curve(move, wobj, start)
            length, turn, end = curve.length, curve.turn, curve.end
            q_end = self._try(move, curve, T_flange_tool, q)
            self._check_configuration(move, q_end)
        duration = max(length / speed, turn / turning)
        if move.duration is not None:
            duration = move.duration
        duration = self._spaced(move, duration)
        return PlannedMove(curve, q, q_end, end, T_flange_tool, length, duration, zone, context, move)

    def _spaced(self, move: Move, duration: float) -> float:
        """Time that the motion takes [s]: no less than the path planner needs for one; few such in a row."""
        if duration >= self._limits.segment_time:
            self._short_in_row = 0
            return duration
        self._short_in_row += 1
        allowed = self._limits.short_in_row
        if allowed is not None and self._short_in_row > allowed:
            self._short_in_row = 0
            shortest = s_to_ms(self._limits.segment_time)
            raise self._error(
                move,
                f"{allowed + 1} motions in a row below {shortest:g} ms, this one takes {s_to_ms(duration):.1f} ms",
                f"{allowed} in a row: too many closely spaced positions",
                CLOSELY_SPACED,
            )
        return self._limits.segment_time

    def _curve(self, move: Move, wobj: FloatArray, start: FloatArray) -> TcpCurve:
        """The tool path of a Cartesian motion from the pose `start` (4, 4) on; `wobj` is T_base_wobj (4, 4)."""
        end = wobj @ self._pose(move, move.target, "the target")
        if move.via is None:
            return TcpLine(start, end)
        via = wobj @ self._pose(move, move.via, "the circle point")
        try:
            return TcpArc(start, via, end)
        except ValueError as error:
            raise self._error(move, str(error), "an arc within the limits of MoveC") from None

    def _joint_target(
        self, move: Move, wobj: FloatArray, T_flange_tool: FloatArray, q: FloatArray
    ) -> FloatArray:
        """Joint angles at the end of a joint motion, shape (6,) [rad]; `wobj` is T_base_wobj (4, 4)."""
        if move.kind == "MoveAbsJ":
            q_end: FloatArray = deg_to_rad(np.array(move.target[0]))
            if not self._arm.within_limits(q_end[None])[0]:
                raise self._error(
                    move, f"joint angles {move.target[0]} deg are beyond the limits", "the robot's range"
                )
            return q_end
        T_base_flange = wobj @ self._pose(move, move.target, "the target") @ inverse(T_flange_tool)
        if not self.joint_configuration:
            q_end = self._arm.nearest(T_base_flange[None], q)[0]
            reached = not np.isnan(q_end[0]) and bool(self._arm.within_limits(q_end[None])[0])
            found = q_end if reached else None
        else:
            cf1, cf4, cf6, cfx = self._conf(move, move.target)
            found = self._arm.in_configuration(T_base_flange, (cf1, cf4, cf6), cfx, BORDER)
        if found is None:
            raise self._error(
                move,
                f"target {_point(move.target)} cannot be reached in configuration {_numbers(move.target[2])}",
                "a target and configuration within the robot's range",
            )
        if self.joint_configuration:
            self._check_quadrants(move, found)
        return found

    def _try(self, move: Move, curve: TcpCurve, T_flange_tool: FloatArray, q: FloatArray) -> FloatArray:
        """Follow a Cartesian motion once and give the joint angles at its end, shape (6,) [rad]."""
        poses = curve.poses(np.linspace(0.0, 1.0, TRIALS)) @ inverse(T_flange_tool)
        path = self._arm.nearest(poses, q)
        if np.isnan(path).any():
            share = np.flatnonzero(np.isnan(path).any(axis=1))[0] / (TRIALS - 1)
            raise self._error(
                move, f"the path leaves the robot's reach after {share:.0%}", "a path within reach"
            )
        if not self._arm.within_limits(path).all():
            bad = path[~self._arm.within_limits(path)][0]
            axis = int(np.argmax(np.maximum(bad - self._arm.upper, self._arm.lower - bad)))
            raise self._error(
                move,
                f"axis {axis + 1} would be at {rad_to_deg(bad[axis]):.1f} deg",
                f"{rad_to_deg(self._arm.lower[axis]):.1f} to {rad_to_deg(self._arm.upper[axis]):.1f} deg",
            )
        jump = np.abs(np.diff(path, axis=0, prepend=q[None])).max()
        nearest = self._limits.wrist_singularity
        if np.abs(path[:, 4]).min() < nearest or jump > np.pi / 2.0:
            raise self._error(
                move,
                f"the path passes a singularity (axis 5 at {rad_to_deg(np.abs(path[:, 4]).min()):.2f} deg)",
                f"axis 5 at least {rad_to_deg(nearest):.1f} deg from straight",
                SINGULARITY,
            )
        q_end: FloatArray = path[-1]
        return q_end

    def _check_configuration(self, move: Move, q_end: FloatArray) -> None:
        """ConfL: a Cartesian motion must end in the configuration that its target names."""
        if not self.linear_supervision:
            return
        self._check_quadrants(move, q_end)
        wanted, found = self._conf(move, move.target), self._arm.conf_of(q_end)
        near_border = abs(q_end[4]) < BORDER
        if found[3] != wanted[3] and not (near_border and found[3] // 2 == wanted[3] // 2):
            raise self._error(
                move,
                f"the motion ends in cfx {found[3]}, the target says {wanted[3]}",
                "the same cfx",
                CONFIGURATION,
            )

    def _check_quadrants(self, move: Move, q_end: FloatArray) -> None:
        """Axes 1, 4 and 6 in the quadrants that the target names, and so far within that a calibrated arm's are."""
        wanted, found = self._conf(move, move.target), self._arm.conf_of(q_end)
        for axis, quarter, name in zip((0, 3, 5), wanted[:3], ("cf1", "cf4", "cf6"), strict=True):
            low = quarter * QUARTER
            margin = self._limits.quadrant_margin or -BORDER
            if not low + margin <= q_end[axis] <= low + QUARTER - margin:
                raise self._error(
                    move,
                    f"the motion ends with axis {axis + 1} at {rad_to_deg(q_end[axis]):.1f} deg, {name} = {quarter}",
                    f"configuration {_numbers(found)}, {rad_to_deg(margin):.1f} deg within its quadrant",
                    CONFIGURATION,
                )

    def _conf(self, move: Move, target: Value) -> tuple[int, int, int, int]:
        conf = target[2]
        if any(value != int(value) for value in conf) or not 0 <= conf[3] <= 7:
            raise self._error(move, f"confdata is {_numbers(conf)}", "integers, cfx 0 to 7")
        cf1, cf4, cf6, cfx = (int(value) for value in conf)
        return cf1, cf4, cf6, cfx

    def _pose(self, move: Move, target: Value, what: str) -> FloatArray:
        if any(value not in (9e9, float(np.float32(9e9))) for value in target[3]):
            self._log("warning", "external axes", f"{what} names external axes, the robot has none")
        return self._frame(move, target, what)

    @staticmethod
    def frame(pose: Value) -> FloatArray:
        """T_parent_child, shape (4, 4), of a RAPID pose."""
        return from_wxyz(mm_to_m(np.array(pose[0])), np.array(pose[1]))

    def _frame(self, move: Move, pose: Value, what: str) -> FloatArray:
        """T_parent_child of a RAPID pose, or of the first two parts of a robtarget."""
        quaternion = np.array(pose[1])
        defect = abs(float(quaternion @ quaternion) - 1.0)
        if defect > UNIT_ERROR:
            raise self._error(move, f"the quaternion of {what} is {_numbers(pose[1])}", "a unit quaternion")
        if defect > UNIT_WARNING:
            self._log(
                "warning", "quaternion", f"{move.file}, line {move.line}: {what} is off unit by {defect:.1e}"
            )
        return self.frame(pose)

    def _check_tool(self, move: Move) -> None:
        mass, centre = move.tool[2][0], move.tool[2][1]
        if mass < 0.001 - 1e-9 or not any(centre):
            raise self._error(
                move,
                f"the tool load is {mass:g} kg at {_numbers(centre)}",
                "a mass of 0.001 kg and more off the flange",
            )

    def _error(self, move: Move, found: str, allowed: str, number: int = 0) -> AbbError:
        text = f"{move.file}, line {move.line}: {move.kind}: {found}, allowed is {allowed}: correct path or recipe"
        self._log("error", "motion supervision", text, number)
        return RapidMotionError(text, file=move.file, line=move.line, kind=move.kind)


def _numbers(values: Iterable[float]) -> str:
    return "[" + ", ".join(f"{value:g}" for value in values) + "]"


def _point(target: Value) -> str:
    return f"{_numbers(target[0])} mm"
