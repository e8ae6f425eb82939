"""Samples of what the simulated controller commanded, and of what went on around it."""

from __future__ import annotations

from dataclasses import dataclass, field

from doormill_ros.arrays import FloatArray
from doormill_ros.simulation.controller.moves import MotionContext


@dataclass(frozen=True)
class Sampling:
    """How finely the executed path is sampled.

    Attributes:
        interval: Longest time between samples at the programmed speed [s].
        cutting_step: Longest way between samples while cutting [m].
        settling: Time that coming to rest at a stop point takes [s].
        planning: Time that setting off from rest takes, in which the program pointer gets ahead [s].
    """

    interval: float = 0.01
    cutting_step: float = 0.5e-3
    settling: float = 0.02
    planning: float = 0.05


@dataclass(frozen=True)
class Surroundings:
    """What matters of the cell while a sample is taken.

    Attributes:
        spindle_on: The spindle is told to turn.
        at_speed: It says that it is at speed.
        guard_closed: The door circuit is closed.
        tool: The tool in the spindle, empty for none, or where nobody knows.
        tool_longer: How much further it stands out than it should [m].
    """

    spindle_on: bool = False
    at_speed: bool = False
    guard_closed: bool = True
    tool: str = ""
    tool_longer: float = 0.0


@dataclass(eq=False)
class MotionRecording:
    """Samples of the commanded motion in the order of time.

    Attributes:
        time: Simulated time of each [s].
        poses: T_base_tool commanded, shape (4, 4) each.
        q: Joint angles commanded, shape (6,) each [rad].
        context: What the motion is for.
        surroundings: Spindle and guard.
        driven: False while the arm runs on without power.
    """

    time: list[float] = field(default_factory=list)
    poses: list[FloatArray] = field(default_factory=list)
    q: list[FloatArray] = field(default_factory=list)
    context: list[MotionContext] = field(default_factory=list)
    surroundings: list[Surroundings] = field(default_factory=list)
    driven: list[bool] = field(default_factory=list)

    def add(
        self,
        time: float,
        pose: FloatArray,
        q: FloatArray,
        context: MotionContext,
        surroundings: Surroundings,
        driven: bool = True,
    ) -> None:
        """Append one sample: time [s], T_base_tool (4, 4), joint angles (6,) [rad] and what goes on."""
        self.time.append(time)
        self.poses.append(pose)
        self.q.append(q)
        self.context.append(context)
        self.surroundings.append(surroundings)
        self.driven.append(driven)

    def forget(self) -> None:
        """Drop all samples, for who lets a robot work through many doors."""
        for samples in (self.time, self.poses, self.q, self.context, self.surroundings, self.driven):
            samples.clear()
