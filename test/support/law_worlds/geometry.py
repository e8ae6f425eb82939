"""Published geometry of the six-axis robot, and hinges in it that turn by small angles.

Own kinematics: Denavit-Hartenberg table 2.1 of the thesis, which config/robots/irb6600_175_255 also follows.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

ROBOT = "irb6600_175_255"
#: Rz(q + offset) Tz(d) Tx(a) Rx(alpha), rows of offset, d, a, alpha [rad, m, m, rad].
TABLE = np.array(
    [
        [0.0, 0.780, 0.320, -np.pi / 2],
        [-np.pi / 2, 0.0, 1.075, 0.0],
        [0.0, 0.0, 0.200, -np.pi / 2],
        [0.0, 1.142, 0.0, np.pi / 2],
        [0.0, 0.0, 0.0, -np.pi / 2],
        [np.pi, 0.200, 0.0, 0.0],
    ]
)
#: Joint springs that the simulation in question states [N m / rad].
SPRINGS = np.array([2.442e6, 2.167e6, 1.683e6, 3.443e5, 1.172e5, 4.567e4])
Z = np.array([0.0, 0.0, 1.0])


def link_frames(q: np.ndarray) -> np.ndarray:
    """Frames 0 to 6, shape (n, 7, 4, 4), at joint angles (n, 6) [rad]."""
    n = len(q)
    frames = np.empty((n, 7, 4, 4))
    frames[:, 0] = np.eye(4)
    for k, (offset, d, a, alpha) in enumerate(TABLE):
        c, s = np.cos(q[:, k] + offset), np.sin(q[:, k] + offset)
        ca, sa = np.cos(alpha), np.sin(alpha)
        step = np.zeros((n, 4, 4))
        step[:, 0] = np.column_stack([c, -s * ca, s * sa, a * c])
        step[:, 1] = np.column_stack([s, c * ca, -c * sa, a * s])
        step[:, 2] = [0.0, sa, ca, d]
        step[:, 3, 3] = 1.0
        frames[:, k + 1] = frames[:, k] @ step
    return frames


@dataclass(frozen=True, eq=False)
class Hinge:
    """A line about which everything beyond it can turn.

    Attributes:
        where: Its name.
        frame: The link frame that axis and point are fixed in.
        axis, point: Unit vector and a point of the line, shape (3,), that frame [m].
        link: First link that turns with it.
        order: Hinges further out have a larger one.
        compliance: Of a sound one, or what is taken for its unit [rad / (N m)].
    """

    where: str
    frame: int
    axis: np.ndarray
    point: np.ndarray
    link: int
    order: float
    compliance: float

    def line(self, frames: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Axes and points, shape (n, 3) each, base frame, for frames (n, 7, 4, 4)."""
        T = frames[:, self.frame]
        return T[:, :3, :3] @ self.axis, T[:, :3, :3] @ self.point + T[:, :3, 3]


def joint(k: int) -> Hinge:
    """Joint k, 1 to 6."""
    return Hinge(f"joint {k}", k - 1, Z, np.zeros(3), k, float(k), 1.0 / SPRINGS[k - 1])


def cracked_link(k: int, angle: float) -> Hinge:
    """Link 2 or 4, the long ones, soft in the middle about one axis across its length.

    Args:
        k: 2 or 4.
        angle: Of that axis about the length [rad]; 0 lies across the neighbouring joints' axes, which a crack
            along them would look like.
    """
    c, s = np.cos(angle), np.sin(angle)
    if k == 2:
        return Hinge("link 2", 2, np.array([0.0, c, s]), np.array([-0.5375, 0.0, 0.0]), 2, 2.5, 4e-7)
    # Link 4 is long along z of frame 3, which is y of its own frame.
    return Hinge("link 4", 4, np.array([c, 0.0, s]), np.array([0.0, -0.571, 0.0]), 4, 4.5, 2e-6)


def base_edge(angle: float, radius: float) -> Hinge:
    """A horizontal edge of the foot, `radius` [m] from axis 1 towards `angle` [rad]; positive lifts the far side.

    The robot falls over it towards `angle`.
    """
    out = np.array([np.cos(angle), np.sin(angle), 0.0])
    return Hinge("base", 0, np.cross(Z, out), radius * out, 1, 0.0, 3e-7)


def tool_seat(angle: float) -> Hinge:
    """The flange's face, about one axis in it, `angle` [rad] from its x."""
    return Hinge("tool", 6, np.array([np.cos(angle), np.sin(angle), 0.0]), np.zeros(3), 6, 6.9, 5e-6)


def turned(axis: np.ndarray, angle: np.ndarray, vector: np.ndarray) -> np.ndarray:
    """Vectors (n, 3) turned about unit axes (n, 3) by angles (n,) [rad]; Rodrigues' formula."""
    c, s = np.cos(angle)[:, None], np.sin(angle)[:, None]
    along = np.sum(axis * vector, axis=1, keepdims=True)
    return vector * c + np.cross(axis, vector) * s + axis * along * (1.0 - c)
