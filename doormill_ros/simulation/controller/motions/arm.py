"""The robot as the simulated controller believes it to be: rigid, with the nominal geometry.

Written apart from the robot package: the controller that judges a path must not share a mistake
with the code that made it.
"""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import BoolArray, FloatArray
from doormill_ros.simulation.truth.chain import chain

#: Axes whose quarter turns are in confdata.
CONF_AXES = (0, 3, 5)
QUARTER = np.pi / 2.0
#: Steps between poses of a path that is sampled finely enough to be followed at once [rad].
SMOOTH = 0.3


class ControllerArm:
    """Closed-form kinematics of an arm with three parallel-or-orthogonal axes and a spherical wrist.

    Attributes:
        dh: Table [theta_offset, d, a, alpha], shape (6, 4).
        lower: Joint limits, shape (6,) [rad].
        upper: Joint limits, shape (6,) [rad].
        max_velocity: Joint speeds the drives reach, shape (6,) [rad/s].
    """

    def __init__(
        self, dh: FloatArray, lower: FloatArray, upper: FloatArray, max_velocity: FloatArray | None = None
    ) -> None:
        """Take the nominal geometry.

        Args:
            dh: Table, shape (6, 4), of the form of the thesis' table 2.1.
            lower: Lower joint limits, shape (6,) [rad].
            upper: Upper joint limits, shape (6,) [rad].
            max_velocity: Largest joint speeds, shape (6,) [rad/s]; None for no limit.

        Raises:
            ValueError: The table is not of that form.
        """
        self.dh = np.array(dh, dtype=float)
        self.lower, self.upper = np.array(lower, dtype=float), np.array(upper, dtype=float)
        self.max_velocity = (
            np.full(6, np.inf) if max_velocity is None else np.array(max_velocity, dtype=float)
        )
        theta, d, a, alpha = self.dh.T
        form = (
            np.allclose(theta, [0.0, -QUARTER, 0.0, 0.0, 0.0, np.pi])
            and np.allclose(alpha, [-QUARTER, 0.0, -QUARTER, QUARTER, -QUARTER, 0.0])
            and np.allclose(d[[1, 2, 4]], 0.0)
            and np.allclose(a[3:], 0.0)
        )
        if not form:
            raise ValueError(
                "the DH table is not that of an elbow arm with a spherical wrist (thesis table 2.1)"
            )
        self._shoulder = np.array([a[0], d[0]])
        self._upper_arm = a[1]
        self._forearm = float(np.hypot(a[2], d[3]))
        self._bend = float(np.arctan2(a[2], d[3]))
        self._flange = d[5]

    def forward(self, q: FloatArray) -> FloatArray:
        """T_base_flange, shape (n, 4, 4), at q (n, 6) [rad]."""
        return chain(self.dh, np.atleast_2d(q))[:, 6]

    def branches(self, T_base_flange: FloatArray) -> FloatArray:
        """All eight ways to stand at poses, without regard to limits.

        Args:
            T_base_flange: Shape (n, 4, 4).

        Returns:
            Joint angles, shape (n, 8, 6) [rad], NaN where out of reach. The branch number is cfx
            (front or behind of axis 1, of the lower arm, sign of axis 5); angles are in (-pi, pi].
        """
        rotation, flange = T_base_flange[:, :3, :3], T_base_flange[:, :3, 3]
        wrist = flange - self._flange * rotation[:, :, 2]
        distance = np.hypot(wrist[:, 0], wrist[:, 1])
        height = wrist[:, 2] - self._shoulder[1]
        heading = np.arctan2(wrist[:, 1], wrist[:, 0])
        # Axis by axis for all branches at once: rows are in front of and behind axis 1, (2, n).
        q1 = np.stack([heading, heading + np.pi])
        reach = np.stack([distance, -distance]) - self._shoulder[0]
        sine = (reach**2 + height**2 - self._upper_arm**2 - self._forearm**2) / (
            2.0 * self._upper_arm * self._forearm
        )
        with np.errstate(invalid="ignore"):
            angle = np.arcsin(np.where(np.abs(sine) <= 1.0, sine, np.nan))
        # Then for either bend of the arm, (2, 2, n) and in one row of four, (4, n).
        gamma = np.stack([angle, np.pi - angle], axis=1)
        along, across = self._upper_arm + self._forearm * np.sin(gamma), self._forearm * np.cos(gamma)
        ahead = reach[:, None]
        q2 = np.arctan2(along * ahead - across * height, along * height + across * ahead).reshape(4, -1)
        q3 = (self._bend - gamma).reshape(4, -1)
        q1 = np.repeat(q1, 2, axis=0)
        R_3_6 = _seen_from_third(q1.ravel(), (q2 + q3).ravel(), np.tile(rotation, (4, 1, 1)))
        # R_3_6 = Rz(q4) Ry(-q5) Rz(q6 + pi); the two wrists differ in the sign of axis 5.
        bent = np.hypot(R_3_6[:, 0, 2], R_3_6[:, 1, 2])
        result = np.empty((4, 2, len(wrist), 6))
        for number, sign in enumerate((1.0, -1.0)):
            q5 = np.arctan2(sign * bent, R_3_6[:, 2, 2])
            q4 = np.arctan2(-sign * R_3_6[:, 1, 2], -sign * R_3_6[:, 0, 2])
            q6 = np.arctan2(-sign * R_3_6[:, 2, 1], sign * R_3_6[:, 2, 0]) - np.pi
            for axis, q in enumerate((q1, q2, q3, q4, q5, q6)):
                result[:, number, :, axis] = q.reshape(4, -1)
        result = _wrapped(result)
        result[np.isnan(q2)[:, None].repeat(2, axis=1)] = np.nan
        return np.ascontiguousarray(result.reshape(8, len(wrist), 6).swapaxes(0, 1))

    def within_limits(self, q: FloatArray) -> BoolArray:
        """Whether joint angles q (n, 6) [rad] are within the limits, shape (n,)."""
        tolerance = 1e-9
        inside = (q >= self.lower - tolerance) & (q <= self.upper + tolerance)  # (n, 6)
        return np.asarray(inside.all(axis=1))

    def in_configuration(
        self, T_base_flange: FloatArray, quarters: tuple[int, int, int], cfx: int, tolerance: float = 1e-3
    ) -> FloatArray | None:
        """Joint angles at one pose in one configuration, or None when it does not exist.

        Args:
            T_base_flange: Shape (4, 4).
            quarters: Quarter turns of axes 1, 4 and 6.
            cfx: Branch 0..7.
            tolerance: How far outside its quarter an axis may be [rad]: on the border both count.

        Returns:
            Shape (6,) [rad].
        """
        q = self.branches(T_base_flange[None])[0, cfx].copy()
        if np.isnan(q[1]):
            return None
        for axis, quarter in zip(CONF_AXES, quarters, strict=True):
            low = quarter * QUARTER
            turns = [q[axis] + 2.0 * np.pi * k for k in (-2, -1, 0, 1, 2)]
            fitting = [t for t in turns if low - tolerance <= t <= low + QUARTER + tolerance]
            if not fitting:
                return None
            q[axis] = fitting[0]
        return q if bool(self.within_limits(q[None])[0]) else None

    def nearest(self, T_base_flange: FloatArray, start: FloatArray) -> FloatArray:
        """Follow a path of poses from joint angles on, each pose in the branch nearest to the last.

        Args:
            T_base_flange: Shape (n, 4, 4).
            start: Joint angles before the first pose, shape (6,) [rad].

        Returns:
            Shape (n, 6) [rad], NaN from the first pose on that has no solution.
        """
        branches = self.branches(T_base_flange)  # (n, 8, 6)
        last = np.asarray(start, dtype=float)
        # Away from singularities the whole path stays in one branch.
        first = _near(branches[0], last)
        distance = np.abs(first - last).max(axis=1)
        if not np.all(np.isnan(distance)):
            number = int(np.nanargmin(distance))
            path = np.unwrap(np.concatenate([first[number][None], branches[1:, number]]), axis=0)
            if not np.isnan(path).any() and np.abs(np.diff(path, axis=0)).max(initial=0.0) < SMOOTH:
                return path
        result = np.full((len(branches), 6), np.nan)
        for i, candidates in enumerate(branches):
            near = _near(candidates, last)
            distance = np.abs(near - last).max(axis=1)
            if np.all(np.isnan(distance)):
                break
            result[i] = last = near[int(np.nanargmin(distance))]
        return result

    def conf_of(self, q: FloatArray) -> tuple[int, int, int, int]:
        """cf1, cf4, cf6, cfx of joint angles (6,) [rad]."""
        cf1, cf4, cf6 = (int(np.floor(q[axis] / QUARTER)) for axis in CONF_AXES)
        frames = chain(self.dh, np.atleast_2d(q))[0]
        # The wrist centre in the frame of axis 1, and beside the line of the lower arm.
        wrist = frames[5, :3, 3]
        forward = np.array([np.cos(q[0]), np.sin(q[0]), 0.0])
        gamma = self._bend - q[2]
        cfx = 4 * int(wrist @ forward < 0.0) + 2 * int(np.cos(gamma) < 0.0) + int(q[4] < 0.0)
        return cf1, cf4, cf6, cfx


def _wrapped(q: FloatArray) -> FloatArray:
    """Angles in (-pi, pi] [rad], same shape."""
    return np.pi - np.mod(np.pi - q, 2.0 * np.pi)


def _near(candidates: FloatArray, last: FloatArray) -> FloatArray:
    """The turn of each angle that is nearest to where the axis is; shapes (k, 6) and (6,)."""
    return candidates + 2.0 * np.pi * np.round((last - candidates) / (2.0 * np.pi))


def _seen_from_third(q1: FloatArray, tilt: FloatArray, R_base_flange: FloatArray) -> FloatArray:
    """R_3_6, shape (n, 3, 3), from axis 1 (n,), the sum of axes 2 and 3 (n,) [rad] and R_0_6 (n, 3, 3).

    R_0_3 = Rz(q1) Ry(q2 + q3 - pi/2) Rx(pi) for the table's twists.
    """
    c1, s1, c, s = np.cos(q1), np.sin(q1), np.sin(tilt), -np.cos(tilt)
    zero = np.zeros_like(c1)
    R_0_3 = np.stack([c1 * c, s1, -c1 * s, s1 * c, -c1, -s1 * s, -s, zero, -c], axis=1).reshape(-1, 3, 3)
    return np.swapaxes(R_0_3, 1, 2) @ R_base_flange
