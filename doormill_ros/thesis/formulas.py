"""The thesis' own formulas, one function an equation or group of equations (section 3.1).

Equations 3.8 and 3.33 print tau = J W; a torque needs the transpose, as in equation 2.34 and in the
thesis' own scripts (A.10, A.13), and the vectors of equations 3.7 and 3.32 need a sixth element.
"""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import FloatArray

_NOTHING = np.zeros(3)


def displacement_length(x: FloatArray, x0: FloatArray, known: FloatArray = _NOTHING) -> float:
    """L of equations 3.2 and 3.4; with a known joint's displacement taken off, 3.6 and 3.31.

    Args:
        x: Loaded reflector position, shape (3,) [m].
        x0: Unloaded reflector position, shape (3,) [m].
        known: Displacement by a joint already identified, shape (3,) [m].

    Returns:
        Length [m].
    """
    return float(np.linalg.norm(np.asarray(x) - np.asarray(x0) - np.asarray(known)))


def stiffness_from_length(load: float, load_arm: float, lever: float, length: float) -> float:
    """K = F L_1 L_2 / L [N m/rad] (2.45, 3.1, 3.3, 3.5, 3.30).

    Args:
        load: F [N].
        load_arm: L_1, lever of the load [m].
        lever: L_2, distance of the reflector from the joint axis [m].
        length: L, reflector displacement due to this joint [m].
    """
    return abs(load * load_arm * lever) / length


def stiffness_from_rotation(load: float, load_arm: float, rotation: float) -> float:
    """K = F L_1 / theta [N m/rad] (2.41, 3.17, 3.29) of a load [N], its lever [m] and a rotation [rad]."""
    return load * load_arm / rotation


def joint_displacement(J: FloatArray, wrench: FloatArray, joint: int, stiffness: float) -> FloatArray:
    """What one identified joint contributes (3.7 with 3.8, 3.32 with 3.33).

    Args:
        J: Jacobian at the load point, shape (6, 6).
        wrench: Load there, in the axes of J, shape (6,) [N, N m].
        joint: Its number, 1..6.
        stiffness: Its stiffness [N m/rad].

    Returns:
        Displacement of the load point, shape (3,) [m].
    """
    torque = J[:, joint - 1] @ wrench
    return J[:3, joint - 1] * torque / stiffness


def joint4_rotation(
    unloaded: tuple[FloatArray, FloatArray],
    loaded: tuple[FloatArray, FloatArray],
    lever_L2: float,
    radius_R4: float,
) -> float:
    """Rotation of joint 4 [rad] from two reflectors, A before and B behind the joint (3.9 to 3.16).

    Args:
        unloaded: Positions of A and B without load, shape (3,) each [m].
        loaded: The same with load.
        lever_L2: Distance from joint 3 to A [m].
        radius_R4: Distance of B from the axis of joint 4 [m].
    """
    AB_u = unloaded[1] - unloaded[0]  # (3.9)
    AB_l = loaded[1] - loaded[0]  # (3.10)
    phi = _angle(AB_u, AB_l)  # (3.11) to (3.13)
    alpha = abs(np.arctan(np.linalg.norm(loaded[0] - unloaded[0]) / lever_L2))  # (3.14)
    c = np.linalg.norm(AB_u) * np.tan(phi - alpha)  # (3.15)
    return float(np.arctan(c / radius_R4))  # (3.16)


def joint5_rotation(
    unloaded: tuple[FloatArray, FloatArray, FloatArray], loaded: tuple[FloatArray, FloatArray, FloatArray]
) -> float:
    """Rotation of joint 5 [rad] from reflectors A, B and C along the arm, shape (3,) each [m] (3.18 to 3.28)."""
    before = _angle(unloaded[1] - unloaded[0], unloaded[2] - unloaded[1])  # (3.26)
    after = _angle(loaded[1] - loaded[0], loaded[2] - loaded[1])  # (3.27)
    return after - before  # (3.28)


def _angle(a: FloatArray, b: FloatArray) -> float:
    """Angle between two vectors; the arc tangent keeps the digits that arccos of almost 1 loses."""
    return float(np.arctan2(np.linalg.norm(np.cross(a, b)), a @ b))
