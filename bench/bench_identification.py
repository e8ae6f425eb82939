"""Stiffness correction of a whole standard door against the thesis' second and against plain numpy."""

from __future__ import annotations

import numpy as np

from doormill_ros.cell.places.layout import load_layout
from doormill_ros.correction.compensate import compensate
from doormill_ros.robot.branch import choose_branch
from doormill_ros.robot.description import load_robot
from doormill_ros.robot.kinematics import Kinematics
from doormill_ros.robot_model.elastic.joint_springs import JointSpringModel
from harness import Entry, compare, entry
from support.thesis_milling import THESIS_FORCES

TARGETS = 200
TOLERANCE = 1e-6
#: Section 3.8: the correction of two fillets takes more than one second.
THESIS_SECONDS = 1.0
# Flange axes of table 4.6 in base axes: z along the spindle into the door.
R_BASE_FLANGE = np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])


def door_targets() -> tuple[np.ndarray, np.ndarray]:
    """Three hinges, a lock case and two handle holes on the edge of a 2.1 m door.

    Returns:
        T_base_tool, shape (200, 4, 4), and the wrench at each, base axes, shape (200, 6).
    """
    features = [
        (0.05, 0.10, 0.03),
        (0.95, 0.10, 0.03),
        (1.85, 0.10, 0.03),
        (1.0, 0.22, 0.02),
        (1.05, 0.02, 0.02),
    ]
    count = TARGETS // len(features)
    forces = np.array(list(THESIS_FORCES.values()))
    poses, wrenches = [], []
    for bottom, height, width in features:
        for i in range(count):
            side, along = divmod(4.0 * i / count, 1.0)
            corner = [(0, along), (along, 1), (1, 1 - along), (1 - along, 0)][int(side)]
            T = np.eye(4)
            T[:3, :3] = R_BASE_FLANGE
            T[:3, 3] = [1.60, -0.25 + width * corner[0], bottom + height * corner[1]]
            poses.append(T)
            force = forces[int(side)]
            wrenches.append(np.concatenate([R_BASE_FLANGE @ force[:3], R_BASE_FLANGE @ force[3:]]))
    return np.array(poses), np.array(wrenches)


def plain_correction(robot, T_base_tool, q0, wrench, T_flange_tool) -> np.ndarray:
    """The same correction as one would write it down: target by target, 4 x 4 matrix by matrix."""
    result = []
    for i in range(len(q0)):
        q = q0[i].copy()
        inverse = np.linalg.inv(plain_jacobian(robot.dh, q, T_flange_tool)[0])
        for _ in range(25):
            J, T = plain_jacobian(robot.dh, q, T_flange_tool)
            deflection = J @ (J.T @ wrench[i] / robot.stiffness)
            turn = plain_rotation(deflection[3:]) @ T[:3, :3]
            missing_turn = T_base_tool[i, :3, :3] @ turn.T
            angle = np.arccos(np.clip((np.trace(missing_turn) - 1) / 2, -1, 1))
            axis = np.array(
                [
                    missing_turn[2, 1] - missing_turn[1, 2],
                    missing_turn[0, 2] - missing_turn[2, 0],
                    missing_turn[1, 0] - missing_turn[0, 1],
                ]
            )
            rotvec = axis / 2 if angle < 1e-6 else axis * angle / (2 * np.sin(angle))
            missing = np.concatenate([T_base_tool[i, :3, 3] - T[:3, 3] - deflection[:3], rotvec])
            if max(np.linalg.norm(missing[:3]), np.linalg.norm(missing[3:])) <= TOLERANCE:
                break
            q = q + inverse @ missing
        result.append(T)
    return np.array(result)


def plain_rotation(vector: np.ndarray) -> np.ndarray:
    """Rodrigues' formula."""
    angle = np.linalg.norm(vector)
    if angle == 0.0:
        return np.eye(3)
    x, y, z = vector / angle
    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * K + (1 - np.cos(angle)) * K @ K


def plain_jacobian(dh: np.ndarray, q: np.ndarray, T_flange_tool: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Thesis eq. 2.1 and 2.29, link by link: Jacobian (6, 6) and T_base_tool."""
    T = np.eye(4)
    axes, origins = [], []
    for (offset, d, a, alpha), angle in zip(dh, q, strict=True):
        axes.append(T[:3, 2])
        origins.append(T[:3, 3])
        c, s, ca, sa = np.cos(angle + offset), np.sin(angle + offset), np.cos(alpha), np.sin(alpha)
        T = T @ np.array(
            [[c, -s * ca, s * sa, a * c], [s, c * ca, -c * sa, a * s], [0, sa, ca, d], [0, 0, 0, 1]]
        )
    T = T @ T_flange_tool
    J = np.array(
        [np.concatenate([np.cross(z, T[:3, 3] - o), z]) for z, o in zip(axes, origins, strict=True)]
    ).T
    return J, T


def run() -> list[Entry]:
    robot = load_robot("irb6600_175_255")
    layout = load_layout()
    T_flange_tool = np.eye(4)
    T_flange_tool[:3, 3] = layout.T_flange_tool[:3, 3]
    T_base_tool, wrench = door_targets()
    q = choose_branch(robot, T_base_tool @ np.linalg.inv(T_flange_tool))
    kinematics, model = Kinematics(robot), JointSpringModel(robot)
    point = T_flange_tool[:3, 3]

    def ours():
        return compensate(
            T_base_tool,
            q,
            lambda angles: model.deflection(angles, wrench, point),
            kinematics,
            T_flange_tool,
            TOLERANCE,
        )

    def plain():
        return plain_correction(robot, T_base_tool, q, wrench, T_flange_tool)

    done = ours()
    off = float(np.abs(done.T_base_tool - plain()).max())
    if off > 1e-9 or done.residual.max() > TOLERANCE or done.translation.max() < 1e-5:
        raise RuntimeError(f"the two corrections differ by {off:.1e}, residual {done.residual.max():.1e} m")
    name = f"stiffness correction of a whole door, {len(q)} targets, residual below 1 um"
    against_plain = compare(name, ours, "plain numpy, target by target", plain, n=21)
    return [
        entry(
            name,
            against_plain.median,
            "s",
            "the thesis, two fillets (section 3.8)",
            THESIS_SECONDS,
            against_plain.n,
        ),
        against_plain,
    ]
