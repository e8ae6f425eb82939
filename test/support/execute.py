"""Run a milling program on a robot that bends: an ideal controller for tests."""

import numpy as np
from scipy.spatial.transform import Rotation, Slerp

from doormill_ros.frames import apply_twist
from doormill_ros.simulation.controller.records.executed_path import ExecutedPath
from doormill_ros.toolpath.program import MotionKind


def execute(program, robot, kinematics, T_flange_tool, model=None, corrected=True, step=2e-4):
    """Interpolate targets as MoveL and MoveC do, then bend the robot under each motion's wrench.

    Written apart from doormill_ros.toolpath: arcs come from the three points alone.
    """
    pose = "T_base_tool_corrected" if corrected else "T_base_tool_nominal"
    frames = [np.array(getattr(t, pose)) for t in program.targets]
    q_at = program.q_after(program.motions[0])
    at = kinematics.forward(q_at) @ T_flange_tool
    time, T, motion = [np.zeros(1)], [at[None]], [np.zeros(1, dtype=int)]
    shares = [np.zeros(1)]
    seeds = [q_at[None]]
    for index, m in enumerate(program.motions):
        q_end = program.q_after(m)
        if m.kind in (MotionKind.ABSOLUTE, MotionKind.JOINT):
            share = np.linspace(0, 1, 21)
            q = q_at + share[:, None] * (q_end - q_at)
            T.append(kinematics.forward(q) @ T_flange_tool)
            time.append(time[-1][-1] + share)
            motion.append(np.full(len(q), index))
            shares.append(share)
            seeds.append(q)
            at, q_at = T[-1][-1], q_end
            continue
        end = frames[m.target]
        if m.kind is MotionKind.CIRCULAR:
            points, length = arc_points(at[:3, 3], frames[m.via][:3, 3], end[:3, 3], step)
        else:
            length = np.linalg.norm(end[:3, 3] - at[:3, 3])
            fine = step * (50 if not m.cutting and length > 0.05 else 25 if m.cutting else 5)
            n = max(1, int(np.ceil(length / fine)))
            points = at[:3, 3] + np.linspace(0, 1, n + 1)[:, None] * (end - at)[:3, 3]
        n = len(points) - 1
        share = np.linspace(0, 1, n + 1)
        turn = Slerp([0, 1], Rotation.from_matrix(np.stack([at[:3, :3], end[:3, :3]])))(share)
        pieces = np.tile(np.eye(4), (n + 1, 1, 1))
        pieces[:, :3, :3], pieces[:, :3, 3] = turn.as_matrix(), points
        T.append(pieces)  # both ends: the load may jump from motion to motion
        time.append(time[-1][-1] + share * length / m.speed)
        motion.append(np.full(n + 1, index))
        shares.append(share)
        seeds.append(q_at + share[:, None] * (q_end - q_at))
        at, q_at = end, q_end
    T, time, motion, q, share = map(np.concatenate, (T, time, motion, seeds, shares))
    first = np.array([m.wrench for m in program.motions])
    last = np.array([m.wrench if m.wrench_end is None else m.wrench_end for m in program.motions])
    wrench = first[motion] + share[:, None] * (last - first)[motion]
    q = solve(kinematics, T_flange_tool, T, q)
    actual = T
    if model is not None:
        direction = moving(q, motion)
        actual = apply_twist(T, model.deflection(q, wrench, T_flange_tool[:3, 3], direction))
    cutting = np.array([m.cutting for m in program.motions])[motion]
    feature = np.array([m.feature for m in program.motions])[motion]
    return ExecutedPath(time, actual, T, q, motion, cutting, feature, wrench)


def arc_points(start, via, end, step):
    """Points on the circle through three points, and the arc's length."""
    a, b = via - start, end - start
    normal = np.cross(a, b)
    centre = start + np.cross(normal, a) * (b @ b) / (2 * normal @ normal)
    centre = centre + np.cross(b, normal) * (a @ a) / (2 * normal @ normal)
    radius = np.linalg.norm(start - centre)
    u = (start - centre) / radius
    v = np.cross(normal / np.linalg.norm(normal), u)
    sweep = np.arctan2((end - centre) @ v, (end - centre) @ u) % (2 * np.pi)
    n = max(2, int(np.ceil(radius * sweep / min(step, np.sqrt(8 * radius * 2e-7)))))
    angle = np.linspace(0, sweep, n + 1)[:, None]
    return centre + radius * (np.cos(angle) * u + np.sin(angle) * v), radius * sweep


def solve(kinematics, T_flange_tool, T_base_tool, q):
    """Joint angles of the commanded poses, by Newton's method from the targets' angles."""
    for _ in range(8):
        found = kinematics.forward(q) @ T_flange_tool
        error = np.concatenate(
            [
                T_base_tool[:, :3, 3] - found[:, :3, 3],
                Rotation.from_matrix(
                    T_base_tool[:, :3, :3] @ np.swapaxes(found[:, :3, :3], 1, 2)
                ).as_rotvec(),
            ],
            axis=1,
        )
        if np.abs(error).max() < 1e-10:
            break
        J = kinematics.jacobian(q, T_flange_tool[:3, 3])
        q = q + np.linalg.solve(J, error[..., None])[..., 0]
    return q


def moving(q, motion):
    """Direction in which each joint last moved; at the start of a motion the one it begins with."""
    change = np.sign(np.where(np.abs(d := np.diff(q, axis=0)) > 1e-9, d, 0.0))
    direction = np.zeros_like(q)
    direction[1:] = change
    begins = np.nonzero(np.diff(motion))[0] + 1
    direction[begins] = np.concatenate([change, change[-1:]])[begins]
    for i in range(1, len(q)):
        direction[i] = np.where(direction[i] == 0, direction[i - 1], direction[i])
    return direction
