"""A joint that gives way under the weight of the arm."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.robot_model.candidate import number
from doormill_ros.robot_model.pose.causes.cause import CLEAR, Coefficient, Columns, PoseCause, Reported
from doormill_ros.robot_model.pose.causes.hints import Hints
from doormill_ros.robot_model.pose.chain import Placement, joint_turn
from doormill_ros.robot_model.pose.view import SetView

#: Torque of gravity below which a joint's sag cannot be asked for [N m].
LEAST_TORQUE = 0.5
#: Share of a weight that turns a joint whose axis is nearly upright, below which it cannot be asked for either.
LEAST_LEVER = 0.1


class JointSag(PoseCause):
    """Turn of a joint in proportion to the torque of gravity about its axis.

    Where nobody states what the links weigh, their moments are fitted as well, and there is no compliance: the
    coefficients are the turns that the weight of the links up to each frame gives, along its axes.

    Attributes:
        frames: How many frames hold unknown moments, from the joint's own on; 0 where masses are known.
        wave: Whether the moment in the joint's own frame turns it by a first wave of its own angle, as where the axis
            lies level in every posture.
    """

    name = "joint_sag"

    def __init__(self, where: str, frames: int = 0, wave: bool = False) -> None:
        """Put it at a joint, with the frames that hold unknown moments."""
        super().__init__(where)
        self.frames, self.wave = frames, wave

    @classmethod
    def candidates(cls, hints: Hints) -> Sequence[PoseCause]:
        """Joints that carry weight in one series at least."""
        if not any(view.links for view in hints.sets):
            own = [_own_levers(hints.sets, k) for k in range(1, len(hints.joints) + 1)]
            return [
                cls(where, len(own) - i, _is_wave(levers, hints.sets, i))
                for i, (where, levers) in enumerate(zip(hints.joints, own, strict=True))
                if np.linalg.norm(levers, axis=1).max() > LEAST_LEVER
            ]
        moment = [view.gravity_moment for view in hints.sets]
        most = np.max([np.abs(m[:, :, 2]).max(axis=0) for m in moment], axis=0)
        return [cls(where) for where, torque in zip(hints.joints, most, strict=True) if torque > LEAST_TORQUE]

    @property
    def settings(self) -> dict[str, Any]:
        """The frames, where masses are not known."""
        return {"frames": self.frames} if self.frames else {}

    @classmethod
    def build(cls, where: str, settings: Mapping[str, Any], dh: FloatArray) -> PoseCause:
        """With the frames stated, or none."""
        return cls(where, int(settings.get("frames", 0)))

    @property
    def coefficients(self) -> tuple[Coefficient, ...]:
        """The compliance, or turns by frame and axis."""
        if not self.frames:
            return (Coefficient("compliance", "rad / (N m)", f"sag {self.where}", 1e-4),)
        first = number(self.where)
        return tuple(
            Coefficient(f"frame_{frame}_{axis}", "rad", f"sag {self.where} frame {frame}", 3e-3)
            for frame in range(first, first + self.frames)
            for axis in "xyz"
        )

    @property
    def imitated(self) -> int:
        """Those of the joint's own frame, where a wave does the same."""
        return 3 if self.wave else 0

    def impossible(self, x: FloatArray) -> bool:
        """What would have to push back against the weight."""
        return not self.frames and bool(x[0] < 0.0)

    def reported(self, x: FloatArray, std: FloatArray, seen: Sequence[tuple[SetView, Placement]]) -> Reported:
        """The compliance, or those turns that are clear of zero: most moments of a real arm are next to nothing."""
        every = super().reported(x, std, seen)
        if not self.frames:
            return every
        return {name: one for name, one in every.items() if abs(one["value"]) > CLEAR * one["std"]}

    def columns(self, view: SetView) -> list[Columns]:
        """Torque of gravity about the joint axis, or levers of the unknown weights."""
        k = number(self.where)
        if self.frames:
            return [Columns(joint_turn(k), 0, view.levers(k))]
        return [Columns(joint_turn(k), 0, view.gravity_moment[:, k - 1, 2:])]

    def pattern(self) -> str:
        """What it leaves."""
        return f"the residual angle of {self.where} follows the torque of gravity about it"


def _own_levers(sets: Sequence[SetView], k: int) -> FloatArray:
    """Levers of the link of joint k in all series, shape (n, 3)."""
    return np.concatenate([view.levers(k)[:, :3] for view in sets])


def _is_wave(levers: FloatArray, sets: Sequence[SetView], joint: int) -> bool:
    """Whether levers (n, 3) are first waves of the angle of a joint, by its index."""
    q = np.concatenate([view.q[:, joint] for view in sets])
    waves = np.column_stack([np.cos(q), np.sin(q)])
    rest = levers - waves @ np.linalg.lstsq(waves, levers, rcond=None)[0]
    return float(np.abs(rest).max()) < LEAST_LEVER
