"""What causes look at in one series: angles, last motions, gravity torques, the course of the recording."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from doormill_ros.arrays import FloatArray, IntArray
from doormill_ros.frames import cross
from doormill_ros.robot_model.pose.chain import frames, link_transforms
from doormill_ros.robot_model.pose.link_masses import LinkMass, gravity_moment
from doormill_ros.robot_model.pose.stance import UPRIGHT, Stance

#: Motion that turns a play from one flank to the other [rad]: shorter moves are taken in proportion.
CROSSING = 2e-3


@dataclass(frozen=True, eq=False)
class SetView:
    """Postures of one robot, in the order in which it took them.

    Attributes:
        name: Name of the series; empty for postures that nobody measured.
        dh: Nominal table, shape (J, 4): theta_offset, d, a, alpha.
        links: Masses of the links, empty where not known.
        q: Joint angles, shape (n, J) [rad].
        row: Row numbers in the order of recording, shape (n,).
        motion: Last motion of every joint, -1 ... +1, where it is known better than from the rows, shape (n, J).
        time: Since the start of the series, shape (n,) [s], NaN where not recorded; None for postures that
            nobody measured.
        temperature: Likewise [deg C].
        stance: How the robot stands to gravity, and what it carries.
    """

    name: str
    dh: FloatArray
    links: tuple[LinkMass, ...]
    q: FloatArray
    row: IntArray
    motion: FloatArray | None = None
    time: FloatArray | None = None
    temperature: FloatArray | None = None
    stance: Stance = UPRIGHT

    def __len__(self) -> int:
        return len(self.q)

    def every(self, step: int) -> SetView:
        """Every so many-th posture, with the motion that brought the robot there."""
        some = slice(None, None, step)
        time, temperature = (None if one is None else one[some] for one in (self.time, self.temperature))
        return replace(
            self,
            q=self.q[some],
            row=self.row[some],
            motion=self.last_motion[some],
            time=time,
            temperature=temperature,
        )

    def at(self, stance: Stance) -> SetView:
        """The same postures of a robot that stands or carries otherwise."""
        return self if stance is self.stance else replace(self, stance=stance)

    @property
    def joints(self) -> int:
        """Number of joints J."""
        return len(self.dh)

    @cached_property
    def order(self) -> FloatArray:
        """Place of every row in the recording, 0 at its start and 1 at its end, shape (n,)."""
        result: FloatArray = (self.row - self.row[0]) / max(float(self.row[-1] - self.row[0]), 1.0)
        return result

    @cached_property
    def elapsed(self) -> FloatArray:
        """Time since the first row as a share of the series, by rows where no time was recorded, shape (n,)."""
        if self.time is None or not self._timed:
            return self.order
        result: FloatArray = (self.time - self.time[0]) / (self.time[-1] - self.time[0])
        return result

    @property
    def span(self) -> tuple[float, str]:
        """What elapsed from the first row to the last, and its unit: seconds, or rows as '-'."""
        if self.time is None or not self._timed:
            return float(self.row[-1] - self.row[0]), "-"
        return float(self.time[-1] - self.time[0]), "s"

    @cached_property
    def _timed(self) -> bool:
        """Whether every row has a time and none goes back."""
        return self.time is not None and bool(
            np.all(np.isfinite(self.time))
            and np.all(np.diff(self.time) >= 0.0)
            and self.time[-1] > self.time[0]
        )

    @cached_property
    def transforms(self) -> FloatArray:
        """Nominal A_1 ... A_J, shape (n, J, 4, 4)."""
        return link_transforms(self.dh, self.q)

    @cached_property
    def last_motion(self) -> FloatArray:
        """Flank on which every joint arrived, -1 ... +1, 0 where the row before is missing, shape (n, J)."""
        return last_motion(self.q, self.row) if self.motion is None else self.motion

    @cached_property
    def T_base_frames(self) -> FloatArray:
        """Nominal frames 0 to J, shape (n, J + 1, 4, 4)."""
        return frames(self.transforms)

    def levers(self, k: int) -> FloatArray:
        """Torque about joint k of a unit weight that hangs at a unit from the axis, along x, y, z of frames k to J.

        Whatever the links weigh, the torque of their weight is a sum of these: where one carries the next is fixed in
        its own frame.

        Returns:
            Of shape (n, m), three for each of the frames.
        """
        T = self.T_base_frames
        axis = T[:, k - 1, :3, 2]
        turning = cross(self.stance.down, axis)
        levers: FloatArray = np.einsum("nkji,nj->nki", T[:, k:, :3, :3], turning).reshape(len(axis), -1)
        return levers

    @cached_property
    def gravity_moment(self) -> FloatArray:
        """Moment of the weight of all links beyond frame k about its origin, frame axes, (n, J, 3) [N m]."""
        return gravity_moment(self.T_base_frames, self.stance.carried(self.links), self.stance.down)


def last_motion(q: FloatArray, row: IntArray, crossing: float = CROSSING) -> FloatArray:
    """State of a play in every joint: follows the motion between rows and stops at the flanks.

    Args:
        q: Joint angles in the order of recording, shape (n, J) [rad].
        row: Row numbers; after a gap nothing is known until the joint has moved enough.
        crossing: Motion from one flank to the other [rad].
    """
    state = np.zeros(q.shape)
    step = np.zeros(q.shape)
    step[1:] = np.diff(q, axis=0) * (2.0 / crossing)
    step[1:][np.diff(row) != 1] = 0.0
    gap = np.zeros(len(q), dtype=bool)
    gap[1:] = np.diff(row) != 1
    now = np.zeros(q.shape[1])
    for i in range(len(q)):
        if gap[i]:
            now = np.zeros(q.shape[1])
        now = np.clip(now + step[i], -1.0, 1.0)
        state[i] = now
    return state
