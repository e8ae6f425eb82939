"""Where a rigid arm goes that runs a target file: straight lines and circles between its targets, no fly-by.

Much faster than the simulated controller, which is needed where zones, speeds or stops count. Kinematics are those of
the simulated truth; nothing of the planner is used.
"""

import numpy as np
from scipy.spatial.transform import Rotation, Slerp

from doormill_ros.simulation.controller.records.executed_path import ExecutedPath
from support.execute import arc_points

LINE_STEP = 0.004  # m between samples of a straight cut
ARC_STEP = 0.002  # m between samples of an arc, or less for its curvature
WAY_PARTS = 8  # parts of a way through the air, over which the joints are followed


def run_file_ideally(program, robot, T_flange_tool, line_step=LINE_STEP):
    """The executed path of a file that `file_run.read_file` has read, by a rigid `TruthRobot`; steps in metres."""
    frames = [_frame(target) for target in program.targets]
    q = np.radians(program.home)
    at = robot.forward(q)[0] @ T_flange_tool
    T, joints, motion = [], [], []
    for number, m in enumerate(program.motions):
        if m.kind == "A":
            q = np.radians(program.points[m.target - 1] if m.target else program.home)
            poses, way = (robot.forward(q) @ T_flange_tool), q[None]
        else:
            end = frames[m.target - 1]
            if m.kind == "C":
                points, _ = arc_points(at[:3, 3], frames[m.via - 1][:3, 3], end[:3, 3], ARC_STEP)
            else:
                length = np.linalg.norm(end[:3, 3] - at[:3, 3])
                parts = max(1, int(np.ceil(length / line_step))) if m.cutting else WAY_PARTS
                points = at[:3, 3] + np.linspace(0, 1, parts + 1)[:, None] * (end - at)[:3, 3]
            turn = Slerp([0, 1], Rotation.from_matrix(np.stack([at[:3, :3], end[:3, :3]])))
            poses = np.tile(np.eye(4), (len(points), 1, 1))
            poses[:, :3, :3] = turn(np.linspace(0, 1, len(points))).as_matrix()
            poses[:, :3, 3] = points
            way = _follow(robot, T_flange_tool, poses, q)
            q = way[-1]
        at = poses[-1]
        T.append(poses)
        joints.append(way)
        motion.append(np.full(len(poses), number))
    T, joints, motion = map(np.concatenate, (T, joints, motion))
    joints = _newton(robot, T_flange_tool, T, joints)
    cutting = np.array([m.cutting for m in program.motions])[motion]
    feature = np.array([m.feature for m in program.motions])[motion]
    n = len(T)
    return ExecutedPath(np.arange(n, dtype=float), T, T, joints, motion, cutting, feature, np.zeros((n, 6)))


def _frame(target):
    position, (w, x, y, z), *_ = target
    T = np.eye(4)
    T[:3, :3] = Rotation.from_quat([x, y, z, w]).as_matrix()
    T[:3, 3] = np.array(position) / 1e3
    return T


def _follow(robot, T_flange_tool, poses, q):
    """Joint angles near those of poses that begin at q: exact at the end, and along a long way."""
    short = np.linalg.norm(poses[-1, :3, 3] - poses[0, :3, 3]) < 0.02
    knots = np.array([0, len(poses) - 1]) if short else np.arange(0, len(poses))
    found = [q]
    for k in knots[1:]:
        found.append(_newton(robot, T_flange_tool, poses[k : k + 1], found[-1][None])[0])
    found = np.array(found)
    return np.array([np.interp(np.arange(len(poses)), knots, column) for column in found.T]).T


def _newton(robot, T_flange_tool, poses, q):
    for _ in range(30):
        frames = robot.link_frames(q)
        tool = frames[:, 6] @ T_flange_tool
        turn = Rotation.from_matrix(poses[:, :3, :3] @ np.swapaxes(tool[:, :3, :3], 1, 2)).as_rotvec()
        missing = np.concatenate([poses[:, :3, 3] - tool[:, :3, 3], turn], axis=1)
        if np.abs(missing).max() < 1e-9:
            return q
        axes = frames[:, :6, :3, 2]
        lever = tool[:, None, :3, 3] - frames[:, :6, :3, 3]
        J = np.concatenate([np.cross(axes, lever), axes], axis=2)  # (n, 6 joints, 6)
        q = q + np.linalg.solve(np.swapaxes(J, 1, 2), missing[..., None])[..., 0]
    raise AssertionError(
        f"no joint angles near {np.degrees(q[0])} deg reach the pose, {missing[0]} is missing"
    )
