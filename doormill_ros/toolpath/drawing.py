"""Draw a door with its features, the tool path and, exaggerated, the corrections."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.frames import apply, inverse
from doormill_ros.pages import charts
from doormill_ros.recipes.drawing import DoorDrawing
from doormill_ros.recipes.errors import UnreadableFile
from doormill_ros.recipes.recipe import Recipe
from doormill_ros.robot.description import Robot
from doormill_ros.robot.kinematics import Kinematics
from doormill_ros.toolpath.curves.arcs import circles
from doormill_ros.toolpath.curves.curve import arc_about
from doormill_ros.toolpath.program import AT_POINTS, MillingProgram, MotionKind
from doormill_ros.units import m_to_mm

EXAGGERATION = 30.0
AIR, CUT, CORRECTED, WAY = "#7aa6d8", "#1a7f37", "#c8102e", "#b58900"
ARC_POINTS = 24
WAY_POINTS = 13  #: of a way through joint space


def draw_program(
    recipe: Recipe, program: MillingProgram, T_base_door: FloatArray, factor: float = EXAGGERATION
) -> DoorDrawing:
    """The recipe's drawing with the layers `air`, `path` and `corrected` on top.

    Args:
        recipe: The door.
        program: What is milled into it.
        T_base_door: Where the door stands, shape (4, 4).
        factor: By how much the corrections are exaggerated.
    """
    drawing = DoorDrawing(recipe)
    for points, feature, cutting in _ways(program, T_base_door, 0.0):
        known = feature if feature in {f.id for f in recipe.features} else None
        drawing.overlay(
            "path" if cutting else "air", points, known, CUT if cutting else AIR, 1.0, not cutting
        )
    for points, feature, cutting in _ways(program, T_base_door, factor):
        if cutting:
            drawing.overlay("corrected", points, feature, CORRECTED, 1.0)
    drawing.note(
        f"tool centre: green nominal, blue in the air, red corrected; corrections {factor:g} times, "
        f"largest {m_to_mm(program.largest_correction):.3f} mm, {len(program.targets)} targets"
    )
    return drawing


def draw_ways(
    drawing: DoorDrawing,
    program: MillingProgram,
    T_base_door: FloatArray,
    robot: Robot,
    T_flange_tool: FloatArray,
) -> None:
    """Add the tool's ways through joint space as the layer `ways`: from home, between features, and home again.

    With each goes the first motion behind it.

    Args:
        drawing: Of the door.
        program: What is milled into it.
        T_base_door: Where the door stands, shape (4, 4).
        robot: Who mills.
        T_flange_tool: Tool centre point in the flange, shape (4, 4).
    """
    if program.home is None:
        return
    T_door_base, kinematics, q = inverse(T_base_door), Kinematics(robot), program.home
    share = np.linspace(0.0, 1.0, WAY_POINTS)[:, None]
    ends = [(motion.kind, program.q_after(motion)) for motion in program.motions]
    before = MotionKind.ABSOLUTE
    for kind, end in [*ends, (MotionKind.ABSOLUTE, program.home)]:
        if kind in (MotionKind.JOINT, MotionKind.ABSOLUTE) or (before in AT_POINTS and kind not in AT_POINTS):
            tips = (kinematics.forward(q + share * (end - q)) @ T_flange_tool)[:, :3, 3]
            drawing.overlay("ways", apply(T_door_base, tips), None, WAY, 1.0, True)
        q, before = end, kind


def save_png(
    path: str | Path,
    recipe: Recipe,
    program: MillingProgram,
    T_base_door: FloatArray,
    factor: float = EXAGGERATION,
) -> Path:
    """One panel a feature as a PNG: outline, nominal path, exaggerated corrected path; millimetres.

    Args:
        path: File to write.
        recipe: The door.
        program: What is milled into it.
        T_base_door: Where the door stands, shape (4, 4).
        factor: By how much the corrections are exaggerated.

    Raises:
        UnreadableFile: It cannot be written.
    """
    from matplotlib.collections import LineCollection

    features = [f for f in recipe.features if any(m.feature == f.id for m in program.motions)]
    columns = min(3, len(features))
    rows = -(-len(features) // columns)
    figure = charts.png_figure(4.2 * columns, 4.6 * rows)
    axes = figure.subplots(rows, columns, squeeze=False)
    for panel in axes.flat[len(features) :]:
        panel.set_axis_off()
    for panel, feature in zip(axes.flat, features, strict=False):
        T_feature_door = inverse(recipe.T_door_feature(feature))
        outline = feature.outline().points(step=np.inf, chord_error=2e-5)
        panel.fill(*m_to_mm(outline).T, facecolor="#f3e5c8", edgecolor="#3d2b12")
        for factor_, colour in ((0.0, CUT), (factor, CORRECTED)):
            ways = _ways(program, T_base_door, factor_)
            lines = [
                m_to_mm(apply(T_feature_door, p))[:, :2]
                for p, name, cut in ways
                if cut and name == feature.id
            ]
            panel.add_collection(LineCollection(lines, colors=colour, linewidths=1.0))
        panel.set_title(f"{feature.id}, corrections x {factor:g}", fontsize=9)
        panel.set_aspect("equal")
        panel.tick_params(labelsize=7)
    figure.suptitle(
        f"{recipe.door_id}: largest correction {m_to_mm(program.largest_correction):.3f} mm", fontsize=11
    )
    try:
        charts.save_png(figure, Path(path))
    except OSError as error:
        raise UnreadableFile(f"{path}: cannot be written, {error.strerror}") from error
    return Path(path)


def _ways(
    program: MillingProgram, T_base_door: FloatArray, factor: float
) -> list[tuple[FloatArray, str, bool]]:
    """Points of every motion in the door frame, its feature, and whether it cuts.

    A factor of 0 gives the nominal path, 1 the corrected one, more an exaggerated one.
    """
    T_door_base = inverse(T_base_door)
    nominal = np.array([t.T_base_tool_nominal[:3, 3] for t in program.targets])
    corrected = np.array([t.T_base_tool_corrected[:3, 3] for t in program.targets])
    places = apply(T_door_base, nominal + factor * (corrected - nominal))
    ways = []
    for i, motion in enumerate(program.motions):
        if (
            i == 0
            or motion.kind in (MotionKind.JOINT, *AT_POINTS)
            or program.motions[i - 1].kind in AT_POINTS
        ):
            continue  # where it begins is known to the joints alone
        start, end = places[program.motions[i - 1].target], places[motion.target]
        points = np.array([start, end]) if motion.via is None else _arc(start, places[motion.via], end)
        ways.append((points, motion.feature, motion.cutting))
    return ways


def _arc(start: FloatArray, via: FloatArray, end: FloatArray) -> FloatArray:
    """Points on the circle through three points, shape (n, 3)."""
    (length,), (radius,), (begin,), _ = circles(start[None], via[None], end[None])
    if not np.isfinite(radius):
        return np.array([start, via, end])
    normal = np.cross(begin, via - start)
    normal = normal / np.linalg.norm(normal)
    centre = start + radius * np.cross(normal, begin)
    return arc_about(start, centre, normal, length / radius).points(np.linspace(0.0, 1.0, ARC_POINTS))
