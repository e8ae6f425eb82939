"""Maps against a loop of pinocchio calls; all inverse solutions against two libraries.

Everything runs on one core: the process is bound to one CPU for the time of the measurement.
"""

from __future__ import annotations

import logging
import os
import statistics
import time
from collections.abc import Callable
from contextlib import contextmanager
from dataclasses import asdict

import numpy as np
import pinocchio
import py_opw_kinematics as opw
from eaik.IK_URDF import UrdfRobot

from doormill_ros.robot.description import Robot, load_robot
from doormill_ros.robot.inverse import inverse_branches
from doormill_ros.robot.kinematics import Kinematics
from doormill_ros.robot.ortho_parallel import ortho_parallel
from doormill_ros.workspace.conditioning import characteristic_length
from doormill_ros.workspace.grid import thesis_grid
from doormill_ros.workspace.maps import WRENCH_TEXT, compute_maps
from harness import Entry, compare, entry
from support.inverse_kinematics import inverse_all

SAMPLE = 2000  #: configurations of the pinocchio loop; the full grid follows by proportion
POSES = 10_000


def run() -> list[Entry]:
    logging.getLogger("doormill_ros").setLevel(logging.ERROR)
    robot = load_robot("irb6600_175_255")
    with one_core():
        return [*maps(robot), *inverse_solutions(robot)]


@contextmanager
def one_core():
    allowed = os.sched_getaffinity(0)
    os.sched_setaffinity(0, {min(allowed)})
    try:
        yield
    finally:
        os.sched_setaffinity(0, allowed)


def maps(robot: Robot) -> list[Entry]:
    """All maps at the thesis' 0.007 rad, the loop extrapolated from an evenly spread sample."""
    grid = thesis_grid(robot)
    n = grid.shape[0] * grid.shape[1]
    sample = np.ascontiguousarray(grid.joints(0, grid.shape[0])[:, :: n // SAMPLE][:, :SAMPLE].T)
    loop = pinocchio_loop(robot)
    ours: list[float] = []
    peer: list[float] = []
    result = compute_maps(robot, grid)
    check = np.array([loop(q) for q in sample])
    layers = (result.position_influence, result.rotation_influence, result.conditioning)
    picked = np.array([layer.ravel()[:: n // SAMPLE][:SAMPLE] for layer in layers]).T
    if not np.allclose(picked, check[:, :3], rtol=1e-8, atol=1e-12):
        raise RuntimeError("the loop and the maps disagree; the comparison means nothing")
    for _ in range(5):
        ours.append(timed(lambda: compute_maps(robot, grid)))
        peer.append(timed(lambda: [loop(q) for q in sample]) * n / len(sample))
    return [
        entry(
            f"all maps over joints 2 and 3, {n} configurations, one core",
            statistics.median(ours),
            "s",
            f"loop of pinocchio calls, extrapolated from {len(sample)} configurations",
            statistics.median(peer),
            len(ours),
        )
    ]


def pinocchio_loop(robot: Robot) -> Callable[[np.ndarray], tuple[float, ...]]:
    """What one writes first: pinocchio and numpy, one configuration, the same six figures."""
    model = pinocchio.buildModelFromUrdf(str(robot.urdf))
    data = model.createData()
    frame = model.getFrameId(robot.flange_link)
    aligned = pinocchio.ReferenceFrame.LOCAL_WORLD_ALIGNED
    K, wrench = np.diag(robot.stiffness), np.array(WRENCH_TEXT)
    per_stiffness = 1.0 / robot.stiffness
    scale = np.array([1.0 / characteristic_length(robot)] * 3 + [1.0] * 3)[:, None]

    def one(q: np.ndarray) -> tuple[float, ...]:
        pinocchio.computeJointKinematicHessians(model, data, q)
        pinocchio.updateFramePlacement(model, data, frame)
        J = pinocchio.getFrameJacobian(model, data, frame, aligned)
        H = pinocchio.getFrameKinematicHessian(model, data, frame, aligned)  # indices reversed
        K_c = np.tensordot(H, wrench, axes=(2, 0)).T
        torque = J.T @ wrench
        without = J @ (per_stiffness * torque)
        loaded = J @ np.linalg.solve(K - K_c, torque)
        a, b = np.linalg.norm(loaded[:3]), np.linalg.norm(without[:3])
        J_n = scale * J
        along = 1.0 / (J[:3] ** 2 @ per_stiffness)
        return (
            abs(a - b) / max(a, b),
            np.abs(loaded[3:] - without[3:]).max(),
            1.0 / (np.linalg.norm(J_n) * np.linalg.norm(np.linalg.inv(J_n))),
            *along,
        )

    return one


def inverse_solutions(robot: Robot) -> list[Entry]:
    """Ours gives every solution within the limits, extra turns included; the others eight a pose."""
    q = np.random.default_rng(1).uniform(robot.lower, robot.upper, (POSES, 6))
    kinematics = Kinematics(robot)
    T = kinematics.forward(q)
    library = opw.Robot(opw.KinematicModel(**asdict(ortho_parallel(robot.dh))), degrees=False)
    eaik = UrdfRobot(str(robot.urdf))
    # EAIK ends its chain at link 6: hand it that link's pose for the same joint angles.
    T_flange_link = np.linalg.inv(kinematics.forward(np.zeros(6))) @ eaik.fwdKin(np.zeros(6))
    T_eaik = T @ T_flange_link
    check_eaik(eaik.IK_batched(T_eaik[:200], num_worker_threads=1), inverse_branches(robot, T[:200]))
    found = len(inverse_all(robot, T).q)
    name = f"inverse, {POSES} poses, {found} solutions within the limits with all turns"

    def library_batch() -> object:
        return library.reach(opw.RigidTransform.from_matrix(T)).joints

    def library_loop() -> object:
        return [library.inverse(pose) for pose in opw.RigidTransform.from_matrix(T)]

    def eaik_batch() -> object:
        return eaik.IK_batched(T_eaik, num_worker_threads=1)

    return [
        compare(name, lambda: inverse_all(robot, T), "py-opw-kinematics, reach()", library_batch, 5),
        compare(name, lambda: inverse_all(robot, T), "py-opw-kinematics, inverse() a pose", library_loop, 3),
        compare(name, lambda: inverse_all(robot, T), "EAIK, IK_batched, one thread", eaik_batch, 3),
        compare(
            f"inverse, {POSES} poses, eight branches without turns",
            lambda: inverse_branches(robot, T),
            "EAIK, IK_batched, one thread",
            eaik_batch,
            3,
        ),
    ]


def check_eaik(theirs: list, ours: np.ndarray) -> None:
    """Every branch of ours is among EAIK's exact solutions, and there are as many."""
    for solution, branches in zip(theirs, ours, strict=True):
        exact = np.array(solution.Q)[~np.array(solution.is_LS)]
        mine = branches[np.isfinite(branches[:, 0])]
        turned = np.abs(np.angle(np.exp(1j * (exact[None] - mine[:, None])))).max(axis=2)
        if len(exact) != len(mine) or turned.min(axis=1).max() > 1e-6:
            raise RuntimeError("EAIK and ours disagree; the comparison means nothing")


def timed(call: Callable[[], object]) -> float:
    start = time.perf_counter()
    call()
    return time.perf_counter() - start
