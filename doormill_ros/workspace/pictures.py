"""Draw the maps and the region of operation."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.pages.charts import png_figure, save_png
from doormill_ros.robot.description import Robot
from doormill_ros.units import n_per_m_to_n_per_um, rad_to_deg
from doormill_ros.workspace.doors import FlangeBox
from doormill_ros.workspace.maps import Maps
from doormill_ros.workspace.posture import posture_figures
from doormill_ros.workspace.region import BoxPlacement, RegionSearch

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_LEVELS = 11
_NAMES = {
    "along_edge": "along the edge (base z)",
    "across_edge": "across the edge (base y)",
    "into_door": "into the door (base x)",
}


def draw_influence(maps: Maps, title: str, path: Path, marks: FloatArray | None = None) -> None:
    """nu_p and nu_r side by side, as figure 4.1 of the thesis.

    Args:
        maps: The maps.
        title: Heading.
        path: PNG to write.
        marks: Joint angles to mark, shape (n, 6) [rad].
    """
    figure = _figure(title, 2)
    axes = figure.axes
    _map(figure, axes[0], maps, maps.position_influence, "nu_p: share of the displacement [-]", marks)
    _map(figure, axes[1], maps, rad_to_deg(maps.rotation_influence), "nu_r: rotation [deg]", marks)
    save_png(figure, path)


def draw_conditioning(maps: Maps, title: str, path: Path, marks: FloatArray | None = None) -> None:
    """Inverse condition number, as figure 4.2 of the thesis; arguments as `draw_influence`."""
    figure = _figure(title, 1)
    _map(figure, figure.axes[0], maps, maps.conditioning, "inverse condition number [-] (at most 1/6)", marks)
    save_png(figure, path)


def draw_stiffness(maps: Maps, title: str, path: Path, marks: FloatArray | None = None) -> None:
    """Stiffness along each milling direction; arguments as `draw_influence`."""
    figure = _figure(title, len(maps.stiffness))
    for axes, (name, values) in zip(figure.axes, maps.stiffness.items(), strict=True):
        # In singular postures a direction turns rigid; the scale ends where the useful range does.
        shown = n_per_m_to_n_per_um(np.minimum(values, np.nanquantile(values, 0.98)))
        _map(figure, axes, maps, shown, f"stiffness {_NAMES[name]} [N/um]", marks, logarithmic=True)
    save_png(figure, path)


def draw_region(robot: Robot, found: RegionSearch, reference: BoxPlacement, path: Path) -> None:
    """Where the search found good places, and the conditioning inside the two boxes."""
    figure = _figure(f"{robot.label}: region of operation", 4, columns=2)
    plan, side, before, after = figure.axes
    x, y, z = found.corners
    worst = np.where(found.allowed, found.worst[found.objective], np.nan)
    middle = y + reference.size[1] / 2.0
    unit = (
        "worst inverse condition number [-]" if found.objective == "conditioning" else "worst stiffness [N/m]"
    )
    _field(figure, plan, x, middle, _best_over(worst, 2).T, unit)
    plan.set(xlabel="flange nearest to axis 1, x [m]", ylabel="box to the side of the robot, y [m]")
    _field(figure, side, x, -z, _best_over(worst, 1).T, unit)
    side.set(xlabel="flange nearest to axis 1, x [m]", ylabel="base above the lowest hinge [m]")
    if found.best is not None:
        plan.plot(found.best.corner[0], found.best.sideways, "r*", markersize=12)
        side.plot(found.best.corner[0], -found.best.corner[2], "r*", markersize=12)
    for axes, placement, name in (
        (before, reference, "region of the thesis"),
        (after, found.best, "best region"),
    ):
        if placement is None:
            axes.set_title("no placement keeps to the rules")
            continue
        box = FlangeBox(placement.corner + placement.size * [0.5, 0, 0], placement.size * [0, 1, 1])
        samples = box.samples(0.02)
        figures = posture_figures(robot, samples.reshape(-1, 3), placement.posture)
        values = figures.conditioning.reshape(samples.shape[:3])[0]
        _field(
            figure,
            axes,
            samples[0, :, 0, 1],
            samples[0, 0, :, 2],
            values.T,
            "inverse condition number [-]",
            top=0.1,
        )
        axes.set(xlabel="flange y [m]", ylabel="flange z [m]", title=name)
    save_png(figure, path)


def _figure(title: str, panels: int, columns: int | None = None) -> Figure:
    columns = columns or panels
    rows = -(-panels // columns)
    figure = png_figure(6.4 * columns, 5.4 * rows)
    figure.suptitle(title)
    figure.subplots(rows, columns)
    return figure


def _map(
    figure: Figure,
    axes: Axes,
    maps: Maps,
    values: FloatArray,
    label: str,
    marks: FloatArray | None,
    logarithmic: bool = False,
) -> None:
    from matplotlib.colors import LogNorm

    q2, q3 = rad_to_deg(maps.grid.q2), rad_to_deg(maps.grid.q3)
    low, high = float(np.nanmin(values)), float(np.nanmax(values))
    spaced = np.geomspace if logarithmic else np.linspace
    levels = spaced(low, high if high > low else low + 1.0, _LEVELS)
    norm = LogNorm(low, high) if logarithmic else None
    values = np.ma.masked_invalid(values)
    filled = axes.contourf(q2, q3, values, levels=levels, cmap="viridis", norm=norm, extend="both")
    lines = axes.contour(q2, q3, values, levels=levels[1:-1:2], colors="white", linewidths=0.5)
    axes.clabel(lines, fontsize=7, fmt="%.3g")
    figure.colorbar(filled, ax=axes, label=label, format="%.3g")
    if marks is not None:
        angles = rad_to_deg(marks)
        axes.plot(angles[:, 1], angles[:, 2], "r^", markersize=7, label="table 4.6")
        axes.legend(loc="lower left")
    axes.set(xlabel="joint 2 [deg]", ylabel="joint 3 [deg]")


def _field(
    figure: Figure,
    axes: Axes,
    x: FloatArray,
    y: FloatArray,
    values: FloatArray,
    label: str,
    top: float | None = None,
) -> None:
    mesh = axes.pcolormesh(
        x, y, values, cmap="viridis", shading="nearest", vmin=None if top is None else 0.0, vmax=top
    )
    figure.colorbar(mesh, ax=axes, label=label)
    filled = np.isfinite(values)
    if filled.any() and not filled.all():
        columns, rows = x[filled.any(axis=0)], y[filled.any(axis=1)]
        axes.set_xlim(columns.min() - 0.2, columns.max() + 0.2)
        axes.set_ylim(rows.min() - 0.2, rows.max() + 0.2)


def _best_over(values: FloatArray, axis: int) -> FloatArray:
    best = np.where(np.isnan(values), -np.inf, values).max(axis=axis)
    return np.where(np.isfinite(best), best, np.nan)
