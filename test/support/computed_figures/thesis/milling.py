"""What docs/thesis.md prints of the thesis' milling, computed from its settings and table 4.8."""

from __future__ import annotations

import math

import numpy as np

from doormill_ros.recipes.cutting import Cutting
from doormill_ros.units import GRAVITY, MM, RPM
from support.computed_figures.thesis.facts import FACTS
from support.thesis_milling import (
    INCH,
    SURFACE_FOOT_PER_MINUTE,
    THESIS_CHIP_LOAD,
    THESIS_MILL,
    THESIS_SURFACE_SPEED,
)

_SETTINGS = {
    name: Cutting(
        spindle_speed=FACTS["milling"][name]["rpm"] * RPM, feed=FACTS["milling"][name]["feed_mm_s"] * MM
    )
    for name in ("initial", "final")
}


def _surface(cutting: Cutting) -> float:
    return cutting.spindle(THESIS_MILL) * THESIS_MILL.radius


#: Surface speeds [SFM] and chip loads [inch].
SURFACE = {name: _surface(cutting) / SURFACE_FOOT_PER_MINUTE for name, cutting in _SETTINGS.items()}
CHIP = {name: cutting.chip(THESIS_MILL) / INCH for name, cutting in _SETTINGS.items()}
METRIC = _surface(_SETTINGS["initial"]) * 60.0
#: A round surface speed in metres per minute, and its spindle speed [rpm].
ROUND = 300.0
ROUND_METRIC = Cutting(surface_speed=ROUND / 60.0, chip_load=1e-3).spindle(THESIS_MILL) / RPM
TOO_FAST = _surface(_SETTINGS["initial"]) / THESIS_SURFACE_SPEED[1] - 1.0
TOO_SLOW = 1.0 - _surface(_SETTINGS["final"]) / THESIS_SURFACE_SPEED[0]
TOO_THIN = 1.0 - _SETTINGS["final"].chip(THESIS_MILL) / THESIS_CHIP_LOAD[0]
#: Feeds that make the thinnest allowed chip [m/s].
ENOUGH = {
    name: Cutting(spindle_speed=FACTS["milling"][name]["rpm"] * RPM, chip_load=THESIS_CHIP_LOAD[0]).feed_rate(
        THESIS_MILL
    )
    for name in _SETTINGS
}
SLOWEST, FASTEST = (
    Cutting(surface_speed=speed, chip_load=1e-3).spindle(THESIS_MILL) / RPM for speed in THESIS_SURFACE_SPEED
)
#: The target feed of section 3.9 [m/s]; its spindle speed at the thinnest chip [rpm], and surface speed [SFM].
TARGET_FEED = 70.0 * MM
TARGET = TARGET_FEED / (THESIS_MILL.flutes * THESIS_CHIP_LOAD[0]) * 60.0
TARGET_SURFACE = TARGET * RPM * THESIS_MILL.radius / SURFACE_FOOT_PER_MINUTE
#: Feed per tooth if table 4.9 were in metres per second [m].
BY_METRES = Cutting(
    spindle_speed=FACTS["milling"]["initial"]["rpm"] * RPM, feed=FACTS["milling"]["initial"]["feed_mm_s"]
).chip(THESIS_MILL)

_LEFT, _TOP, _RIGHT, _BOTTOM = (
    np.array(FACTS["milling"]["forces_N_Nm"][name], dtype=float)
    for name in ("left_line", "top_turn", "right_line", "bottom_turn")
)
_ALL = np.array([_LEFT, _TOP, _RIGHT, _BOTTOM])
ARMS = [float(segment[4] / segment[0]) for segment in (_LEFT, _TOP, _RIGHT)]
#: How far the printed digits leave an arm open to either side, at most [m].
OPEN = [
    (abs(segment[4]) + 0.5) / (abs(segment[0]) - 0.5) - abs(segment[4] / segment[0])
    for segment in (_LEFT, _TOP, _RIGHT)
]
OFFSET = _ALL[:, :3].mean(axis=0).tolist()
SQUARE_Z = float(np.sqrt((_ALL[:, 2] ** 2).mean()))
LARGEST_Y = float(_ALL[:, 1].max())
SMALLEST_Y = float(_ALL[:, 1].min())
APART = math.degrees(
    math.acos(_LEFT[:3] @ _BOTTOM[:3] / (np.linalg.norm(_LEFT[:3]) * np.linalg.norm(_BOTTOM[:3])))
)
#: Read off the plots of A.16: forces along y [N], largest moment about x [N m].
PLOTTED_Y, PLOTTED_X = (350.0, 170.0), 75.0
HANGING = sum(PLOTTED_Y) / 2.0 / GRAVITY
HANGING_ARM = PLOTTED_X / PLOTTED_Y[0]
ACROSS, ALONG = abs(float(_LEFT[0])), abs(float(_LEFT[1]))
