"""The motion side of the simulated controller: a queue of motions, their corners, and time.

The tool moves at the programmed speed; accelerations are left out, so cycle times are lower
bounds. Where a joint would exceed its speed the motion is slowed down there, as the controller
does.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.frames import inverse
from doormill_ros.simulation.controller.arm import ControllerArm
from doormill_ros.simulation.controller.curves import Corner, corner_joints
from doormill_ros.simulation.controller.moves import MotionContext, PlannedMove

#: Motions that the program pointer may be ahead.
LOOK_AHEAD = 3


@dataclass(frozen=True)
class Sampling:
    """How finely the executed path is sampled.

    Attributes:
        interval: Longest time between samples [s].
        cutting_step: Longest way between samples while cutting [m].
        settling: Time that coming to rest at a stop point takes [s].
        planning: Time that setting off from rest takes, in which the program pointer gets ahead [s].
    """

    interval: float = 0.01
    cutting_step: float = 0.5e-3
    settling: float = 0.02
    planning: float = 0.05


@dataclass(eq=False)
class _Phase:
    """A stretch of motion whose samples are known; emitted as time passes."""

    time: FloatArray  # (n,) since the start of the phase [s], rising from 0
    poses: FloatArray  # (n, 4, 4) T_base_tool commanded, of the recorded tool
    q: FloatArray  # (n, 6)
    context: list[MotionContext]
    elapsed: float = 0.0
    emitted: int = 0


@dataclass(eq=False)
class MotionRecording:
    """Samples of the commanded motion in the order of time.

    Attributes:
        time: Simulated time of each [s].
        poses: T_base_tool commanded, shape (4, 4) each.
        q: Joint angles commanded, shape (6,) each [rad].
        context: What the motion is for.
    """

    time: list[float] = field(default_factory=list)
    poses: list[FloatArray] = field(default_factory=list)
    q: list[FloatArray] = field(default_factory=list)
    context: list[MotionContext] = field(default_factory=list)

    def add(self, time: float, pose: FloatArray, q: FloatArray, context: MotionContext) -> None:
        """Append one sample: time [s], T_base_tool (4, 4), joint angles (6,) [rad] and what the motion is for."""
        self.time.append(time)
        self.poses.append(pose)
        self.q.append(q)
        self.context.append(context)


class MotionEngine:
    """Executes planned motions as simulated time passes."""

    def __init__(
        self,
        arm: ControllerArm,
        q: FloatArray,
        T_flange_tool: FloatArray,
        sampling: Sampling,
        log: Callable[..., None],
    ) -> None:
        """Stand at joint angles q, shape (6,) [rad], with the tool whose path is recorded."""
        self._arm = arm
        self._T_flange_tool = T_flange_tool
        self._sampling = sampling
        self._log = log
        self.time = 0.0
        self.q = np.array(q, dtype=float)
        self.paused = False
        self.recording = MotionRecording()
        self._queue: list[PlannedMove] = []
        self._current: PlannedMove | None = None
        self._u = 0.0
        self._resting = True
        self._phase: _Phase | None = None
        #: Programmed end of the last motion that was taken.
        self.planned_q = self.q.copy()
        self.planned_pose: FloatArray | None = None
        self.planned_tool: FloatArray | None = None

    @property
    def idle(self) -> bool:
        """True when the robot stands and nothing is left to do."""
        return self._phase is None and self._current is None and not self._queue

    @property
    def moving(self) -> bool:
        """True when time moves the robot."""
        return not self.paused and not self.idle

    @property
    def has_room(self) -> bool:
        """True while the program pointer may take another motion."""
        return len(self._queue) < LOOK_AHEAD

    def take(self, move: PlannedMove) -> None:
        """Queue a motion that starts where the last one ends."""
        self._queue.append(move)
        self.planned_q = move.q_end
        self.planned_pose = move.T_base_tool_end
        self.planned_tool = move.T_flange_tool

    def stop(self, clear: bool) -> None:
        """Stop where the robot is; `clear` forgets what is left."""
        self.paused = True
        if clear:
            self._queue.clear()
            self._current, self._phase, self._u, self._resting = None, None, 0.0, True
            self.planned_q, self.planned_pose = self.q.copy(), None

    def restart(self) -> None:
        """Go on."""
        self.paused = False

    def advance(self, seconds: float) -> None:
        """Let time pass."""
        end = self.time + seconds
        while not self.paused and self.time < end:
            if self._phase is None:
                self._phase = self._next_phase()
                if self._phase is None:
                    break
            self._emit(self._phase, min(end - self.time, self._phase.time[-1] - self._phase.elapsed))
        self.time = max(self.time, end)

    def until_next(self) -> float:
        """Time to the end of the present stretch of motion [s]."""
        if self._phase is None:
            self._phase = self._next_phase()
        return 0.0 if self._phase is None else float(self._phase.time[-1] - self._phase.elapsed)

    def _emit(self, phase: _Phase, step: float) -> None:
        """Let a phase go on for a while and record what it passes."""
        start = self.time - phase.elapsed
        phase.elapsed += step
        # The last sample belongs to the phase even when sums of floats fall short of it.
        done = phase.elapsed >= phase.time[-1] - 1e-12
        while phase.emitted < len(phase.time) and (done or phase.time[phase.emitted] <= phase.elapsed):
            i = phase.emitted
            self.recording.add(start + float(phase.time[i]), phase.poses[i], phase.q[i], phase.context[i])
            self.q = phase.q[i]
            phase.emitted += 1
        self.time += step
        if done:
            self._phase = None

    def _next_phase(self) -> _Phase | None:
        """The next stretch: along the present motion, round its corner, or into the next one."""
        if self._current is None:
            if not self._queue:
                self._resting = True
                return None
            if self._resting:
                self._resting = False
                return self._set_off(self._queue[0])
            self._current, self._u = self._queue.pop(0), 0.0
        move = self._current
        if move.zone == 0.0 or move.length == 0.0:
            return self._finish(move)
        leave = 1.0 - _share(move.zone, move)
        if self._u < leave - 1e-12:
            return self._along(move, leave)
        if not self._queue:
            # Nothing to round the corner to: the robot stops at the point instead.
            place = f"{move.move.file}, line {move.move.line}"
            self._log(
                "warning", "corner path", f"{place}: executed as a stop point, no next motion was known"
            )
            return self._finish(move)
        following = self._queue[0]
        if following.length == 0.0:
            return self._finish(move)
        radius = min(_share(move.zone, move) * move.length, 0.5 * following.length)
        leave = 1.0 - radius / move.length
        if self._u < leave - 1e-12:
            return self._along(move, leave)
        return self._round(move, self._queue.pop(0), leave, radius)

    def _set_off(self, move: PlannedMove) -> _Phase:
        """Stand while the path is prepared."""
        pose = self._arm.forward(self.q)[0] @ self._T_flange_tool
        count = 2
        time = np.array([0.0, self._sampling.planning])
        return _Phase(time, np.array([pose] * count), np.array([self.q] * count), [move.context] * count)

    def _finish(self, move: PlannedMove) -> _Phase:
        """To the target, and stand there."""
        phase = self._along(move, 1.0)
        self._current, self._resting = None, move.zone == 0.0
        phase.time[-1] += self._sampling.settling if move.zone == 0.0 else 0.0
        return phase

    def _along(self, move: PlannedMove, end: float) -> _Phase:
        """From where the motion is to parameter `end`."""
        start, self._u = self._u, end
        span = end - start
        count = self._count(move, span)
        u = np.linspace(start, end, count)
        if move.curve is None:
            q = move.q_start + u[:, None] * (move.q_end - move.q_start)
            flange = self._arm.forward(q)
        else:
            flange = move.curve.poses(u) @ inverse(move.T_flange_tool)
            q = self._arm.nearest(flange, self.q)
        time = np.linspace(0.0, span * move.duration, count)
        return _Phase(self._slowed(time, q), flange @ self._T_flange_tool, q, [move.context] * count)

    def _round(self, move: PlannedMove, following: PlannedMove, leave: float, radius: float) -> _Phase:
        """Round the corner between two motions on a parabola."""
        enter = radius / following.length
        self._current, self._u = following, enter
        count = max(5, self._count(move, 1.0 - leave) + self._count(following, enter))
        count += 1 - count % 2
        u = np.linspace(0.0, 1.0, count)
        if move.curve is None or following.curve is None:
            before = self.q
            after = self._joints_at(following, enter)
            q = corner_joints(before, move.q_end, after, u)
            flange = self._arm.forward(q)
        else:
            corner = Corner(
                move.curve.poses(np.array([leave]))[0],
                move.T_base_tool_end,
                following.curve.poses(np.array([enter]))[0],
            )
            flange = corner.poses(u) @ inverse(following.T_flange_tool)
            q = self._arm.nearest(flange, self.q)
        half = count // 2
        first = np.linspace(0.0, (1.0 - leave) * move.duration, half + 1)
        second = first[-1] + np.linspace(0.0, enter * following.duration, half + 1)[1:]
        # The first half of the corner belongs to the motion before it, the second to the one after.
        contexts = [move.context] * (half + 1) + [following.context] * half
        time = self._slowed(np.concatenate([first, second]), q)
        return _Phase(time, flange @ self._T_flange_tool, q, contexts)

    def _joints_at(self, move: PlannedMove, u: float) -> FloatArray:
        """Joint angles at parameter u of a motion, shape (6,) [rad]."""
        if move.curve is None:
            return move.q_start + u * (move.q_end - move.q_start)
        poses = move.curve.poses(np.linspace(0.0, u, 11)) @ inverse(move.T_flange_tool)
        q: FloatArray = self._arm.nearest(poses, move.q_start)[-1]
        return q

    def _count(self, move: PlannedMove, span: float) -> int:
        """Samples for a share of a motion, ends included."""
        by_time = span * move.duration / self._sampling.interval
        by_way = span * move.length / self._sampling.cutting_step if move.context.cutting else 0.0
        return int(np.ceil(max(by_time, by_way))) + 2

    def _slowed(self, time: FloatArray, q: FloatArray) -> FloatArray:
        """Times (n,) [s] that no joint is too slow for, from times (n,) [s] and joint angles (n, 6) [rad]."""
        needed = (np.abs(np.diff(q, axis=0)) / self._arm.max_velocity).max(axis=1)
        return np.concatenate([[0.0], np.cumsum(np.maximum(np.diff(time), needed))])


def _share(zone: float, move: PlannedMove) -> float:
    """Share of a motion that lies in its zone; at most half of the motion."""
    return min(zone / move.length, 0.5)
