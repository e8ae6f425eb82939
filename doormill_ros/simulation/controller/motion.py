"""The motion side of the simulated controller: motions, their corners, accelerations, stops and time.

The tool follows the programmed path at the programmed speed where drives and accelerations allow it
(yumpu.com/document/view/5679047/136: where a motor is too weak "the velocity will automatically be reduced"). A
zone is left for the next motion only when that one was known in time, else the corner is a stop point (event 50024).
Stops stay on the path; without power the arm runs on until the brakes hold, off the path, and comes back to it
before it goes on (events 10052 and 10053).
"""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.simulation.controller.motions.arm import ControllerArm
from doormill_ros.simulation.controller.motions.coasting import coast
from doormill_ros.simulation.controller.motions.curves import angle_between
from doormill_ros.simulation.controller.motions.limits import ControllerLimits
from doormill_ros.simulation.controller.motions.path import Path, PathBuilder
from doormill_ros.simulation.controller.motions.stretches import Stretch, Stretches
from doormill_ros.simulation.controller.motions.track import PathNode, SpeedRules
from doormill_ros.simulation.controller.moves import MotionContext, PlannedMove
from doormill_ros.simulation.controller.operation.panel import REGAIN_READY, REGAIN_START, Log
from doormill_ros.simulation.controller.records.recording import MotionRecording, Sampling, Surroundings

#: Motions that the program pointer may be ahead.
LOOK_AHEAD = 3
#: Corner path executed as stop point (public event list, SDEBEUL/GADATA: 50024 "Corner path failure").
CORNER_PATH = 50024
#: So much time passes at most before anybody looks at the robot again [s].
LONGEST_STEP = 0.1
#: Joint angles nearer to the path than this are on it [rad].
ON_PATH = 1e-7


class MotionEngine:
    """Executes planned motions as simulated time passes.

    Attributes:
        time: Simulated time [s].
        q: Joint angles, shape (6,) [rad].
        rules: Override, manual speed and the limits of the drives; `update_speed` after a change.
        surroundings: What is recorded beside the motion.
        planned_q: Joint angles at the end of the last motion taken, shape (6,) [rad]; `planned_pose` with the
            tool `planned_tool` likewise, None after a motion was broken off.
    """

    def __init__(
        self,
        arm: ControllerArm,
        q: FloatArray,
        T_flange_tool: FloatArray,
        sampling: Sampling,
        log: Log,
        limits: ControllerLimits | None = None,
    ) -> None:
        """Stand at joint angles q, shape (6,) [rad], with the tool whose path is recorded."""
        self._sampling = sampling
        self._log = log
        self._stretches = Stretches(arm, T_flange_tool, sampling)
        self._limits = limits or ControllerLimits()
        self.rules = SpeedRules(self._limits, arm.max_velocity)
        self._builder = PathBuilder(self.rules, self._stretches, sampling)
        self.time = 0.0
        self.q = np.array(q, dtype=float)
        self.recording = MotionRecording()
        self.surroundings = Surroundings()
        self._path = Path([])
        self._stored: list[tuple[Path, FloatArray, FloatArray | None, FloatArray | None]] = []
        self._serial = self._begun = 0
        self._holds: set[str] = set()
        self._rest: PathNode | None = None
        self._script: Stretch | None = None
        self._script_at, self._script_time, self._driven = 0, 0.0, True
        self.planned_q = self.q.copy()
        self.planned_pose: FloatArray | None = None
        self.planned_tool: FloatArray | None = None

    # What is asked

    @property
    def idle(self) -> bool:
        """True when nothing of the path is left."""
        return self._script is None and self._path.at_end

    @property
    def stopped(self) -> bool:
        """True when the robot stands because it was stopped."""
        return bool(self._holds) and self._rest is None and self._script is None

    @property
    def moving(self) -> bool:
        """True when time moves the robot."""
        return not self.idle and not self.stopped

    @property
    def regaining(self) -> bool:
        """True on the way back to the path."""
        return self._script is not None and self._driven

    @property
    def has_room(self) -> bool:
        """True while the program pointer may take another motion."""
        return self._serial - self._begun < LOOK_AHEAD

    @property
    def context(self) -> MotionContext:
        """What the motion is for in which the robot is, or was last."""
        path = self._path
        return path.row[path.head].context if path.row else MotionContext()

    def off_path(self) -> tuple[float, float]:
        """How far the tool stands from where its path goes on [m], and by what angle it is turned [rad]."""
        path = self._path
        if not path.row:
            return 0.0, 0.0
        here, there = self._stretches.pose(self.q), path.row[path.head].pose
        return float(np.linalg.norm(here[:3, 3] - there[:3, 3])), angle_between(here, there)

    def until_next(self) -> float:
        """Time until the robot is in its next motion, or stands [s]; 0 when it stands."""
        if not self.moving:
            return 0.0
        if self._script is not None:
            return float(self._script.time[-1]) - self._script_time
        return min(self._path.until_next(self.rules, self._rest), LONGEST_STEP)

    # Motions

    def take(self, move: PlannedMove) -> None:
        """Queue a motion that starts where the last one ends."""
        self._serial += 1
        if self.idle:
            start = PathNode(self.q.copy(), self._stretches.pose(self.q), move.context, self._serial - 1)
            start.dwell = self._sampling.planning
            self._path = Path([start])
            self._record(start)
        failed = self._builder.add(self._path, move, self._serial)
        if failed is not None:
            self._corner_failed(failed)
        self.planned_q, self.planned_pose, self.planned_tool = (
            move.q_end,
            move.T_base_tool_end,
            move.T_flange_tool,
        )
        self.update_speed()

    def _corner_failed(self, move: PlannedMove) -> None:
        place = f"{move.move.file}, line {move.move.line}"
        text = f"{place}: executed as a stop point, no next motion was known in time"
        self._log("warning", "corner path", text, CORNER_PATH)

    # Stopping and going on

    def hold(self, who: str, quick: bool = False) -> None:
        """Brake to a stop on the path; time has to pass until the robot is `stopped`."""
        already = bool(self._holds)
        self._holds.add(who)
        path = self._path
        if self._driven:
            self._script = None  # the way back to the path is slow enough to end anywhere
        if self._script is not None or self.idle or (already and self._rest is None):
            return
        self._divide()
        braking = self._limits.acceleration * (self._limits.quick_factor if quick else 1.0)
        self._rest = path.brake(braking)

    def release(self, who: str) -> None:
        """Go on, unless somebody else holds the robot."""
        self._holds.discard(who)
        if not self._holds:
            self._rest = None
            self.update_speed()

    def cut_power(self, who: str) -> None:
        """Stop without power: the arm runs on, each axis until its own brake has stopped it."""
        path, moving = self._path, self.moving
        self._holds.add(who)
        velocity = np.zeros(6)
        if self._script is not None:
            self._script = None
        elif moving and path.stood >= path.row[path.head].dwell:
            self._divide()
            here, there = path.row[path.head], path.row[path.head + 1]
            if here.way > 0.0:
                velocity = (there.q - here.q) / here.way * here.speed
            here.speed = 0.0
        self._rest = None
        if np.any(velocity):
            time, q = coast(self.q, velocity, self.rules.max_velocity, self._limits)
            self._play(self._stretches.samples(time, q), driven=False)

    def regain(self) -> bool:
        """Go back to where the path goes on; False when the robot stands there."""
        path = self._path
        if not path.row or np.abs(self.q - path.row[path.head].q).max() < ON_PATH:
            return False
        target = path.row[path.head].q
        duration = max(self.off_path()[0] / self._limits.regain_speed, self._sampling.planning)
        self._log("information", "Regain start", "the robot goes back to its path", REGAIN_START)
        self._play(self._stretches.joints(self.q, target, duration), driven=True)
        return True

    def clear(self) -> None:
        """Forget what is left of the path."""
        self._path, self._rest, self._script = Path([]), None, None
        self._begun = self._serial
        self.planned_q, self.planned_pose = self.q.copy(), None

    def store(self, who: str) -> None:
        """Put the path away that `who` holds, so that the robot can be moved otherwise; it stands."""
        self._stored.append((self._path, self.planned_q, self.planned_pose, self.planned_tool))
        self._path, self._begun = Path([]), self._serial
        self.planned_q, self.planned_pose = self.q.copy(), None
        self._holds.discard(who)

    def restore(self, who: str) -> None:
        """Take the path up again that was put away; `who` holds it."""
        self._path, self.planned_q, self.planned_pose, self.planned_tool = self._stored.pop()
        self._begun = self._serial
        self._holds.add(who)

    @property
    def has_stored(self) -> bool:
        """True when a path was put away."""
        return bool(self._stored)

    def forget_stored(self) -> None:
        """Forget paths that were put away."""
        self._stored.clear()

    def update_speed(self) -> None:
        """Plan the speeds along the path anew."""
        path = self._path
        if not path.row or self._holds:
            return
        first = path.head + (1 if path.elapsed > 0.0 else 0)
        self.rules.profile(path.row[first:])

    # Time

    def advance(self, seconds: float) -> None:
        """Let time pass."""
        end = self.time + seconds
        while self.time < end and self.moving:
            step = self._play_on(end) if self._script is not None else self._drive_on(end)
            if step <= 0.0 and self.time >= end:
                break
        self.time = max(self.time, end)

    def _drive_on(self, end: float) -> float:
        """Along the path, to the next node at most; gives the time that passed."""
        path = self._path
        node = path.row[path.head]
        if path.stood < node.dwell - 1e-12:
            step = min(end - self.time, node.dwell - path.stood)
            path.stood += step
            self.time += step
            if path.stood >= node.dwell - 1e-12:
                self._record(node)
            return step
        following = path.row[path.head + 1]
        whole = self.rules.time_between(node, following)
        if not np.isfinite(whole):  # the override is 0
            step, self.time = end - self.time, end
            return step
        step = min(end - self.time, whole - path.elapsed)
        self.time += step
        path.elapsed += step
        if path.elapsed >= whole - 1e-12:
            self._pass_node(following)
        return step

    def _pass_node(self, node: PathNode) -> None:
        path = self._path
        path.head, path.elapsed, path.stood = path.head + 1, 0.0, 0.0
        self.q = node.q
        self._begun = max(self._begun, node.serial)
        self._record(node)
        if node is path.leave and path.last is not None:
            self._corner_failed(path.last)
            path.last = path.leave = None
        if node is self._rest:
            self._rest, node.speed = None, 0.0
        if path.head > 500:
            del path.row[: path.head - 1]
            path.head = 1

    def _divide(self) -> None:
        """Put a node where the robot is on the way between two."""
        if self._path.divide(self.rules):
            node = self._path.row[self._path.head]
            self.q = node.q
            self._record(node)

    def _play(self, script: Stretch, driven: bool) -> None:
        self._script, self._script_at, self._script_time, self._driven = script, 0, 0.0, driven

    def _play_on(self, end: float) -> float:
        """Along a motion off the path."""
        script = self._script
        if script is None:
            return 0.0
        step = min(end - self.time, float(script.time[-1]) - self._script_time)
        begin = self.time - self._script_time
        self._script_time += step
        self.time += step
        context = self.context
        done = self._script_time >= script.time[-1] - 1e-12
        while self._script_at < len(script.time) and (
            done or script.time[self._script_at] <= self._script_time
        ):
            i = self._script_at
            self.q = script.q[i]
            moment = begin + float(script.time[i])
            self.recording.add(moment, script.poses[i], self.q, context, self.surroundings, self._driven)
            self._script_at += 1
        if done:
            self._script = None
            if self._driven:
                self._log("information", "Regain ready", "the robot is on its path", REGAIN_READY)
        return step

    def _record(self, node: PathNode) -> None:
        self.recording.add(self.time, node.pose, node.q, node.context, self.surroundings)
