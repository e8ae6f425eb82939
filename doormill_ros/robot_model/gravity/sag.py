"""How far an arm stands from where it was taught to stand, because it sags.

The convention, here and nowhere else. Each joint turns by the torque of gravity over its spring. The springs of a
loading test are differences under added loads, so nothing of this is in them; and a controller without an option for
absolute accuracy holds its motors, which are before the springs, where the commanded angles put them. What has taken
up a part of it is the teaching of the cell: the tool tip was taken to known points, and where the robot then believed
to be is where camera and door have their places. Teaching fits a rigid displacement, by least squares over its points,
to the sag at its postures, and takes it up wholly. What matters at a cut is the rest:

    sag(q) - (v + w x (p(q) - c), w),   v, w = arg min sum_t |sag(q_t) - v - w x (p_t - c)|^2,

with c the mean of the p_t and, of all minima, the one with the least turn w. With no taught posture nothing is taken
up: the places were measured without the robot. Gravity itself knows no doubt; the masses and springs have theirs.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.frames import cross
from doormill_ros.robot.kinematics import Kinematics
from doormill_ros.robot_model.elastic.compliance import StandingSpread
from doormill_ros.robot_model.gravity.weights import Weight, torque_by_mass

#: Turns are fitted to taught points this share of their number apart and more [m]; closer ones tell none.
APART = 0.01


#: Turns of the joints in c parts, shape (n, c, 6) [rad], of postures, shape (n, 6) [rad].
_Turns = Callable[[FloatArray], FloatArray]


class GravitySag:
    """The sag of an arm against the places that it was taught.

    Attributes:
        kinematics: Of the arm.
        stiffness: Springs of its joints, shape (6,) [N m / rad].
        weights: Whose weight counts.
        taught: Postures of the teaching, shape (t, 6) [rad].
    """

    def __init__(
        self, kinematics: Kinematics, stiffness: FloatArray, weights: Sequence[Weight], taught: FloatArray
    ) -> None:
        """Keep them; shapes (6,) and (t, 6)."""
        self.kinematics = kinematics
        self.stiffness = np.asarray(stiffness, dtype=float)
        self.weights = tuple(weights)
        self.taught = np.asarray(taught, dtype=float).reshape(-1, 6)

    def twist(self, q: FloatArray, point: FloatArray) -> FloatArray:
        """Of the tool, beyond what teaching took up.

        Args:
            q: Joint angles, shape (n, 6) [rad].
            point: The tool tip, flange frame, shape (3,) [m].

        Returns:
            Shape (n, 6) [m, rad], base axes.
        """
        found: FloatArray = self._beyond(q, point, lambda a: self._turns(a)[:, None])[:, 0]
        return found

    def spread(self, q: FloatArray, point: FloatArray, relative: FloatArray) -> StandingSpread:
        """First-order spread of the displacement of the tool tip.

        Args:
            q: Joint angles, shape (n, 6) [rad].
            point: The tool tip, flange frame, shape (3,) [m].
            relative: Standard deviation of each spring as a share of it, shape (6,).
        """
        each = self._beyond(q, point, lambda a: self._turns(a)[:, None] * np.eye(6))[..., :3]  # (n, 6, 3)
        rest = self._beyond(q, point, self._doubts)[..., :3]
        return StandingSpread(each * relative[:, None], np.sqrt(np.sum(rest**2, axis=(1, 2))))

    def _turns(self, q: FloatArray) -> FloatArray:
        """Turn of each joint, shape (n, 6) [rad]."""
        by_mass = torque_by_mass(self.kinematics, q, self.weights)
        loads = np.array([w.mass * w.carried for w in self.weights]).reshape(-1, 6)
        turns: FloatArray = np.einsum("nwj,wj->nj", by_mass, loads) / self.stiffness
        return turns

    def _doubts(self, q: FloatArray) -> FloatArray:
        """Turns of the joints by one standard deviation of each mass and each balance, shape (n, c, 6) [rad]."""
        by_mass = torque_by_mass(self.kinematics, q, self.weights) / self.stiffness
        masses = by_mass * np.array([w.std * w.carried for w in self.weights]).reshape(-1, 6)
        balances = np.array([w.mass * w.carried_std for w in self.weights]).reshape(-1, 6)
        # One cylinder for all links: what it carries is off for all of them alike, joint by joint.
        balance = np.einsum("nwj,wj->nj", by_mass, balances)[:, None] * np.eye(6)
        return np.concatenate([masses, balance], axis=1)

    def _beyond(self, q: FloatArray, point: FloatArray, turns: _Turns) -> FloatArray:
        """Twists of c parts of the sag beyond what teaching took up of each, shape (n, c, 6)."""
        J = self.kinematics.jacobian(q, point)
        moved: FloatArray = np.einsum("nij,ncj->nci", J, turns(q))
        if not len(self.taught):
            return moved
        J_taught = self.kinematics.jacobian(self.taught, point)
        places = self._places(self.taught, point)
        shift, turn, centre = rigid_part(
            places, np.einsum("tij,tcj->tci", J_taught[:, :3], turns(self.taught))
        )
        arm = self._places(q, point) - centre
        moved[..., :3] -= shift + cross(turn, arm[:, None])
        moved[..., 3:] -= turn
        return moved

    def _places(self, q: FloatArray, point: FloatArray) -> FloatArray:
        T = self.kinematics.forward(q)
        places: FloatArray = T[:, :3, :3] @ point + T[:, :3, 3]
        return places


def rigid_part(places: FloatArray, moved: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """The rigid displacement that fits c sets of displacements of t points best.

    Args:
        places: The points, shape (t, 3) [m].
        moved: Their displacements, shape (t, c, 3) [m].

    Returns:
        Displacement of the centre of the points, shape (c, 3) [m]; turn, shape (c, 3) [rad]; centre, shape (3,) [m].
    """
    centre = places.mean(axis=0)
    shift = moved.mean(axis=0)
    x, y, z = (places - centre).T
    zero = np.zeros_like(x)
    # w x p as a matrix on w, point by point.
    cross = np.stack(
        [np.stack(row, axis=-1) for row in ((zero, z, -y), (-z, zero, x), (y, -x, zero))], axis=-2
    )
    A = cross.reshape(-1, 3)
    largest = np.linalg.norm(A, 2)
    cut = APART * np.sqrt(len(places)) / largest if largest > 0.0 else 1.0
    turn = np.linalg.pinv(A, rcond=min(cut, 1.0)) @ (moved - shift).transpose(0, 2, 1).reshape(len(A), -1)
    return shift, turn.T, centre
