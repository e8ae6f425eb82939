"""Where the robot's foot may stand: the figures of docs/workspace.md, by the functions of `workspace`.

For both robots the box of the thesis and the best boxes by conditioning and by stiffness, with the elbow anywhere
behind the flange; for the thesis' robot also what K_c changes, and where its box has axis 5 nearly straight.
"""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import numpy as np

from doormill_ros.robot.description import Robot, load_robot
from doormill_ros.units import m_to_mm, n_per_m_to_n_per_um, rad_to_deg
from doormill_ros.workspace.doors import DoorRange, FlangeBox, thesis_box
from doormill_ros.workspace.grid import THESIS_STEP, thesis_grid
from doormill_ros.workspace.maps import WRENCH_TEXT, compute_maps
from doormill_ros.workspace.posture import posture_figures
from doormill_ros.workspace.region import BoxPlacement, RegionRules, assess, survey

ROBOTS = {"IRB 6600": "irb6600_175_255", "IRB 6700": "irb6700_235_265"}
SPACING = 0.01  #: of the places at which axis 5 is looked at [m]


def main() -> None:
    """Print a line for each."""
    robots = {name: load_robot(folder) for name, folder in ROBOTS.items()}
    of_the_thesis = robots["IRB 6600"]
    show("IRB 6600, thesis", assess(of_the_thesis, thesis_box()))
    for name, robot in robots.items():
        everywhere = survey(robot, DoorRange())
        for objective in ("conditioning", "stiffness"):
            best = everywhere.best(objective).best
            assert best is not None
            show(f"{name}, {objective}", best)
    singular(of_the_thesis, thesis_box())
    maps = compute_maps(of_the_thesis, thesis_grid(of_the_thesis, THESIS_STEP, False), WRENCH_TEXT)
    print(
        f"K_c: displacement by {100.0 * np.nanmax(maps.position_influence):.2f} % at most, "
        f"rotation by {rad_to_deg(np.nanmax(maps.rotation_influence)):.4f} deg at most"
    )


def show(name: str, place: BoxPlacement) -> None:
    """A placement and the worst in it."""
    low, high = place.corner, place.corner + place.size
    ranges = ", ".join(f"{axis} {a:.3f} to {b:.3f}" for axis, a, b in zip("xyz", low, high, strict=True))
    print(
        f"{name}: {ranges}; conditioning {place.conditioning:.3f}, "
        f"stiffness {n_per_m_to_n_per_um(place.stiffness):.3f}, axis 5 {rad_to_deg(place.wrist):.1f}, "
        f"joints {rad_to_deg(place.margin):.1f}, elbow {m_to_mm(place.clearance):.0f}"
    )


def singular(robot: Robot, box: FlangeBox) -> None:
    """Where in a box axis 5 is nearer to straight than a placement may have it."""
    places = box.samples(SPACING).reshape(-1, 3)
    wrist = posture_figures(robot, places, 0).wrist
    within = places[wrist < RegionRules().wrist]
    aside = float(np.abs(within[:, 1]).max())
    low, high = within[:, 2].min(), within[:, 2].max()
    straight = places[np.argmin(wrist)]
    print(
        f"axis 5 below {rad_to_deg(RegionRules().wrist):.0f} deg where |y| < {aside:.2f}, z = {low:.2f} to {high:.2f}; "
        f"straight at y = {straight[1]:.2f}, z = {straight[2]:.2f}"
    )


if __name__ == "__main__":
    main()
