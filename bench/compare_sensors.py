"""Compare the door sensors from simulation: writes the table in docs/sensors.md and docs/images/sensors.svg.

Usage: python bench/compare_sensors.py [TRIALS]; 12 trials take about two minutes on one core.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass, field
from pathlib import Path

import cv2
import numpy as np

ROOT = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT), str(ROOT / "test")]

from page_part import put  # noqa: E402

from doormill_ros.cell.places.layout import CellLayout, DoorOffset, load_layout  # noqa: E402
from doormill_ros.frames import apply, apply_twist, twist_between  # noqa: E402
from doormill_ros.localization.errors import LocalizationError  # noqa: E402
from doormill_ros.localization.sensors.registry import SENSORS  # noqa: E402
from doormill_ros.localization.sensors.sensor import DoorPoseEstimate  # noqa: E402
from doormill_ros.recipes.door import DoorSize  # noqa: E402
from doormill_ros.simulation.picture.picture import render_picture  # noqa: E402
from doormill_ros.simulation.picture.scene import Edges, PictureScene  # noqa: E402
from doormill_ros.simulation.sensors.axis_vision import AxisVisionRig  # noqa: E402
from doormill_ros.simulation.sensors.photoelectric import PhotoelectricRig  # noqa: E402
from doormill_ros.simulation.sensors.touch_probe import TouchProbeRig  # noqa: E402
from doormill_ros.units import DEG, MM  # noqa: E402
from support.sensors.pose_errors import SIZES as DOORS  # noqa: E402

PAGE = ROOT / "docs" / "sensors.md"
FIGURE = ROOT / "docs" / "images" / "sensors.svg"
CHEAP_TRIALS = 20  # trials of a sensor without pictures for each one with
# What is milled: a hinge low, a hinge at 1.0 m, on the hinge edge.
HINGES = np.array([[0.0, 0.0, 0.15], [0.0, 0.0, 1.0]])


@dataclass
class Row:
    """One line of the table; errors are collected trial by trial."""

    label: str
    price: str = ""
    errors: list = field(default_factory=list)  # twists (6,) from the estimate to the truth [m, rad]
    hinges: list = field(default_factory=list)  # where a hinge lands beside where it should [m]
    seconds: list = field(default_factory=list)
    squares: list = field(default_factory=list)
    refused: int = 0
    sees: tuple = ()
    cannot_see: str = ""

    def add(
        self, estimate: DoorPoseEstimate, T_base_door: np.ndarray, robot: TouchProbeRig, seed: int
    ) -> None:
        """Take one estimate; the robot mills with the error it would also have probed with."""
        miss = twist_between(estimate.T_base_door, T_base_door)
        self.errors.append(miss)
        self.seconds.append(estimate.seconds)
        self.sees = estimate.sees
        seen = np.flatnonzero(self.sees)
        part = estimate.covariance[np.ix_(seen, seen)]
        self.squares.append(float(miss[seen] @ np.linalg.solve(part, miss[seen])) / seen.size)
        aimed = apply(estimate.T_base_door, HINGES)
        landed = aimed + robot.robot_error(aimed, seed)
        off = (landed - apply(T_base_door, HINGES)) @ T_base_door[:3, :3]
        self.hinges.append(off)


def true_pose(layout: CellLayout, door: DoorSize, rng: np.random.Generator) -> tuple[np.ndarray, DoorOffset]:
    """Anywhere in the clamp's range; x and the tilts as the clamp holds them."""
    offset = DoorOffset(*(rng.uniform(-0.9, 0.9, 3) * [10 * MM, 10 * MM, 2 * DEG]))
    held = rng.normal(0.0, [0.3 * MM, 0.0, 0.0, 0.0, 0.5e-3, 0.5e-3])
    return apply_twist(layout.T_base_door(door.width, door.thickness, offset), held), offset


def run(trials: int) -> list[Row]:
    """Every sensor on its own simulated readings of the same kind of doors."""
    layout = load_layout()
    axis, photo, probe = AxisVisionRig.load(), PhotoelectricRig.load(), TouchProbeRig.load()
    straight = PhotoelectricRig.load(linearity=False)
    sensors = {name: load() for name, load in SENSORS.items()}
    rows = {
        "one_camera": Row("one camera", "one camera, slider"),
        "off": Row("- the same, doors and mounting as they come"),
        "axis_vision": Row("three cameras", "three cameras, sliders"),
        "photoelectric": Row("six distance sensors", "6 x $629, sliders"),
        "straight": Row("- the same, straight characteristic"),
        "touch6": Row("touch probe, 6 points", "one probe"),
        "touch12": Row("touch probe, 12 points", "one probe"),
    }
    for name, sensor in sensors.items():
        rows[name if name in rows else "touch6"].cannot_see = sensor.cannot_see
    rng = np.random.default_rng(0)
    for trial in range(trials * CHEAP_TRIALS):
        door = DOORS[trial % 3]
        T_base_door, offset = true_pose(layout, door, rng)
        size = (door.width, door.height, door.thickness)
        readings = {
            "photoelectric": ("photoelectric", photo.read(T_base_door, *size, seed=trial)),
            "straight": ("photoelectric", straight.read(T_base_door, *size, seed=trial)),
            "touch6": ("touch_probe", probe.touch(T_base_door, *size, seed=trial, count=6)),
            "touch12": ("touch_probe", probe.touch(T_base_door, *size, seed=trial, count=12)),
        }
        if trial < trials:
            right = PictureScene(door.width, door.thickness, offset, edges=Edges(roughness=0.02 * MM))
            pictures = axis.take(T_base_door, *size, seed=trial)
            readings["one_camera"] = ("one_camera", render_picture(right, trial))
            readings["off"] = ("one_camera", pictures["1"])
            readings["axis_vision"] = ("axis_vision", pictures)
        for key, (name, reading) in readings.items():
            true = T_base_door
            if key == "one_camera":
                true = layout.T_base_door(door.width, door.thickness, offset)
            try:
                estimate = sensors[name].locate(reading, door)
            except LocalizationError as error:
                rows[key].refused += 1
                print(key, error.message)
            else:
                rows[key].add(estimate, true, probe, trial)
    return list(rows.values())


def table(rows: list[Row]) -> str:
    """The measured table in Markdown."""
    lines = [
        "| sensor | y, z [mm] | x [mm] | rotation x [deg] | rotations y, z [deg] | hinge [mm] | time [s] | "
        "chi-square | n | price |",
        "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |",
    ]
    for row in rows:
        miss, hinge = np.abs(row.errors), np.abs(np.array(row.hinges)[:, :, 1:])
        p95 = np.percentile(miss, 95, axis=0) / [MM, MM, MM, DEG, DEG, DEG]
        blind = not all(row.sees)
        lines.append(
            f"| {row.label} | {max(p95[1:3]):.3f} | {'-' if blind else f'{p95[0]:.3f}'} | {p95[3]:.4f} | "
            f"{'-' if blind else f'{max(p95[4:]):.4f}'} | {np.percentile(hinge, 95) / MM:.2f} | "
            f"{np.median(row.seconds):.2f} | {np.mean(row.squares):.2f} | {len(row.errors)} | {row.price} |"
        )
    return "\n".join(lines)


def draw(rows: list[Row]) -> None:
    """Error against time, one point a sensor."""
    from matplotlib.backends.backend_svg import FigureCanvasSVG
    from matplotlib.figure import Figure

    figure = Figure(figsize=(8.0, 4.5), layout="constrained")
    FigureCanvasSVG(figure)
    axes = figure.subplots()
    for row in rows:
        at = float(np.median(row.seconds))
        own = np.percentile(np.abs(row.errors)[:, 1:3], 95) / MM
        milled = np.percentile(np.abs(np.array(row.hinges)[:, :, 1:]), 95) / MM
        (line,) = axes.plot([at, at], [own, milled], "-", linewidth=0.8)
        axes.plot(at, own, "o", color=line.get_color(), label=row.label.lstrip("- "))
        axes.plot(at, milled, "x", color=line.get_color())
    axes.axhline(0.5, color="grey", linestyle="--", linewidth=0.8)
    axes.text(1.0, 0.53, "asked for: 0.5 mm", fontsize=8, color="grey")
    axes.axvline(80.0, color="grey", linestyle=":", linewidth=0.8)
    axes.text(76.0, 0.006, "cycle: 80 s", fontsize=8, color="grey", rotation=90, ha="right")
    axes.set(
        xscale="log",
        yscale="log",
        xlim=(0.02, 100),
        xlabel="time from the order to the pose [s]",
        ylabel="95th percentile of the error along y and z [mm]",
        title="dot: pose of the door, cross: hinge milled there by the robot",
    )
    axes.legend(fontsize=8, loc="center", bbox_to_anchor=(0.6, 0.4))
    FIGURE.parent.mkdir(exist_ok=True)
    figure.savefig(FIGURE, format="svg", metadata={"Date": None})


def main() -> int:
    """Run the comparison and put its table into the page."""
    cv2.setNumThreads(1)
    rows = run(int(sys.argv[1]) if len(sys.argv) > 1 else 12)
    blind = "\n".join(
        f"- *{r.label.split(',')[0].capitalize()}*: {r.cannot_see}." for r in rows if r.cannot_see
    )
    found = f"{table(rows)}\n\nWhat each cannot see:\n\n{blind}"
    put(PAGE, "bench/compare_sensors.py", found)
    draw(rows)
    print(found)
    print("refused:", {row.label: row.refused for row in rows})
    return 0


if __name__ == "__main__":
    sys.exit(main())
