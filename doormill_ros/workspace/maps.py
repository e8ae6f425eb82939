"""Maps over joints 2 and 3: influence of K_c, conditioning, stiffness in the milling direction."""

from __future__ import annotations

import io
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.files import write_atomically
from doormill_ros.robot.chain import JOINTS, ChainFrames, chain_frames, dot, jacobian_columns
from doormill_ros.robot.description import Robot
from doormill_ros.robot_model.elastic.batch import complementary, joint_torque, solve_springs, twist
from doormill_ros.units import rad_to_deg
from doormill_ros.workspace.conditioning import characteristic_length, inverse_condition_number
from doormill_ros.workspace.grid import JointGrid

# The thesis prints two wrenches for one study [N, N m].
WRENCH_TEXT = (0.0, 0.0, -2500.0, 250.0, 250.0, 0.0)  #: section 3.4
WRENCH_SCRIPT = (0.0, 0.0, -2000.0, 200.0, 200.0, 0.0)  #: appendix A.14

# A slot is milled along the door's edge (base z) and turns across it (base y).
DIRECTIONS = {"along_edge": 2, "across_edge": 1, "into_door": 0}  #: base axis of each direction

_CHUNK = 3072  # configurations a pass: its arrays stay in the second-level cache


@dataclass(frozen=True, eq=False)
class Maps:
    """Maps over a grid; every map has shape (n3, n2).

    Where pointing the tool along base x would take axis 5 beyond its limits, every map is NaN.

    Attributes:
        grid: The grid.
        wrench: Wrench of the K_c study at the load point, base axes, shape (6,) [N, N m].
        load_point: Load point, flange frame, shape (3,) [m].
        length: Characteristic length of the Jacobian [m].
        position_influence: nu_p of eq. 3.34 [-].
        rotation_influence: nu_r of eq. 3.35 [rad].
        conditioning: Inverse condition number, 0 to 1/6 [-].
        stiffness: Stiffness felt by a force along each direction of `DIRECTIONS` [N/m].
    """

    grid: JointGrid
    wrench: FloatArray
    load_point: FloatArray
    length: float
    position_influence: FloatArray
    rotation_influence: FloatArray
    conditioning: FloatArray
    stiffness: dict[str, FloatArray] = field(default_factory=dict)


def compute_maps(
    robot: Robot,
    grid: JointGrid,
    wrench: FloatArray | tuple[float, ...] = WRENCH_TEXT,
    load_point: FloatArray | tuple[float, ...] = (0.0, 0.0, 0.0),
    length: float | None = None,
    progress: Callable[[float], None] | None = None,
) -> Maps:
    """Compute every map of a grid in one sweep.

    Args:
        robot: The robot.
        grid: The grid.
        wrench: Wrench of the K_c study, base axes, shape (6,) [N, N m].
        load_point: Where it acts, flange frame, shape (3,) [m].
        length: Characteristic length [m]; None for the thesis' (eq. 3.37).
        progress: Called with the finished share, 0 to 1.
    """
    length = characteristic_length(robot) if length is None else length
    rows, columns = grid.shape
    results = {name: np.empty(rows * columns) for name in ("nu_p", "nu_r", "conditioning", *DIRECTIONS)}
    column_wrench = np.asarray(wrench, dtype=float)[:, None]
    point = np.asarray(load_point, dtype=float)
    step = max(1, _CHUNK // columns)
    for first in range(0, rows, step):
        last = min(first + step, rows)
        part = slice(first * columns, last * columns)
        q = grid.joints(first, last)
        frames = chain_frames(robot.dh, q, grid.sin_cos(first, last))
        velocity = jacobian_columns(frames, frames.point(JOINTS, point))
        results["nu_p"][part], results["nu_r"][part] = complementary_influence(
            frames, velocity, robot.stiffness, column_wrench
        )
        results["conditioning"][part] = inverse_condition_number(frames, velocity, length)
        along_axes = axis_stiffness(velocity, robot.stiffness)
        for name, axis in DIRECTIONS.items():
            results[name][part] = along_axes[axis]
        if grid.tool_along_x:
            beyond = (q[4] < robot.lower[4]) | (q[4] > robot.upper[4])
            for values in results.values():
                values[part][beyond] = np.nan
        if progress:
            progress(last / rows)
    shaped = {name: values.reshape(rows, columns) for name, values in results.items()}
    return Maps(
        grid=grid,
        wrench=np.asarray(wrench, dtype=float),
        load_point=point,
        length=length,
        position_influence=shaped.pop("nu_p"),
        rotation_influence=shaped.pop("nu_r"),
        conditioning=shaped.pop("conditioning"),
        stiffness=shaped,
    )


def complementary_influence(
    frames: ChainFrames, velocity: FloatArray, stiffness: FloatArray, wrench: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """nu_p [-] and nu_r [rad], each shape (n,), of thesis eq. 3.34 and 3.35.

    nu_p compares the lengths of the two displacements, as the script of A.14 does.

    Args:
        frames: Frames of n configurations.
        velocity: Translational Jacobian at the load point, shape (6, 3, n).
        stiffness: Joint stiffness, shape (6,) [N m/rad].
        wrench: Wrench, base axes, shape (6, 1) [N, N m].
    """
    torque = joint_torque(frames, velocity, wrench)
    without = twist(frames, velocity, torque / stiffness[:, None])
    K_c = complementary(frames, velocity, wrench)
    with_K_c = twist(frames, velocity, solve_springs(stiffness, K_c, torque))
    length_without = np.sqrt(dot(without[:3], without[:3]))
    length_with = np.sqrt(dot(with_K_c[:3], with_K_c[:3]))
    nu_p = np.abs(length_with - length_without) / np.maximum(length_with, length_without)
    nu_r = np.abs(with_K_c[3:] - without[3:]).max(axis=0)
    return nu_p, nu_r


def axis_stiffness(velocity: FloatArray, stiffness: FloatArray) -> FloatArray:
    """Force along each base axis per displacement along it, shape (3, n) [N/m].

    The tool is free to move sideways: 1 / (u^T J K^-1 J^T u). Next to infinite where no joint can
    move the point along the axis.

    Args:
        velocity: Translational Jacobian, shape (6, 3, n).
        stiffness: Joint stiffness, shape (6,) [N m/rad].
    """
    compliance = np.einsum("jin,jin,j->in", velocity, velocity, 1.0 / stiffness)
    least = float(np.finfo(float).tiny)
    stiff: FloatArray = 1.0 / np.maximum(compliance, least)
    return stiff


def save_arrays(path: Path, **arrays: Any) -> None:
    """Write an npz file in one step.

    Raises:
        OSError: It cannot be written; one that was there stays as it was.
    """
    stream = io.BytesIO()
    np.savez_compressed(stream, **arrays)
    write_atomically(path, stream.getvalue())


def save_maps(maps: Maps, path: Path) -> None:
    """Write the arrays to an npz file, axes in degrees: joint2_deg (n2,), joint3_deg (n3,), maps (n3, n2)."""
    stiffness = {f"stiffness_{name}_N_per_m": v for name, v in maps.stiffness.items()}
    save_arrays(
        path,
        joint2_deg=rad_to_deg(maps.grid.q2),
        joint3_deg=rad_to_deg(maps.grid.q3),
        other_joints_deg=rad_to_deg(np.array(maps.grid.others)),
        tool_along_x=maps.grid.tool_along_x,
        wrench=maps.wrench,
        load_point_m=maps.load_point,
        characteristic_length_m=maps.length,
        nu_p=maps.position_influence,
        nu_r_deg=rad_to_deg(maps.rotation_influence),
        inverse_condition_number=maps.conditioning,
        **stiffness,
    )
