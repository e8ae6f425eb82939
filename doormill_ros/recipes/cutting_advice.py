"""What a carpenter says to the speeds of a recipe: nothing that forbids milling, figures and warnings."""

from __future__ import annotations

from collections.abc import Sequence

from doormill_ros.recipes.features.base import Feature
from doormill_ros.units import RPM, m_to_mm, rad_s_to_rpm, rad_to_deg

#: Spindle speeds at which wood is milled, as far as the tool allows them [rad/s].
WOOD = (12_000.0 * RPM, 18_000.0 * RPM)
SAME = 1e-9  #: share by which a speed on the limit may be off


def cutting_table(features: Sequence[Feature]) -> str:
    """Speeds, chips and ways down of features, with warnings below; lines for an operator."""
    lines = ["feature                  rpm  chip.mm   m/min  way round     way down"]
    for feature in features:
        tool, cutting = feature.tool, feature.cutting
        spindle = cutting.spindle(tool)
        down = "straight" if tool.centre_cutting else f"ramp, {rad_to_deg(tool.max_ramp):.0f} deg at most"
        lines.append(
            f"{feature.id:20.20s} {rad_s_to_rpm(spindle):7.0f} {m_to_mm(cutting.chip(tool)):8.3f} "
            f"{60.0 * spindle * tool.radius:7.0f}  {feature.direction.value:12s}  {down}"
        )
    return "\n".join([*lines, *(f"warning: {said}" for feature in features for said in warnings(feature))])


def warnings(feature: Feature) -> list[str]:
    """One sentence for each figure of a feature's cutting that is beside what suits wood or the tool."""
    tool, cutting = feature.tool, feature.cutting
    spindle, chip = cutting.spindle(tool), cutting.chip(tool)
    speed = spindle * tool.radius
    said = []
    low, high = WOOD[0], min(WOOD[1], tool.max_spindle_speed)
    if low <= high and not low * (1.0 - SAME) <= spindle <= high * (1.0 + SAME):
        said.append(
            f"{feature.id}: the spindle turns at {rad_s_to_rpm(spindle):.0f} rpm, wood is milled at "
            f"{rad_s_to_rpm(low):.0f} to {rad_s_to_rpm(high):.0f} rpm with {tool.name}: slower takes thick chips out "
            "of the grain and bends the robot, faster burns"
        )
    if tool.min_chip_load is not None and chip < tool.min_chip_load * (1.0 - SAME):
        least = m_to_mm(tool.min_chip_load)
        said.append(
            f"{feature.id}: chips are {m_to_mm(chip):.3f} mm thick, {tool.name} is for {least:.3f} mm and more: "
            "thinner ones are rubbed off and the edge wears"
        )
    bounds = (tool.min_surface_speed, tool.max_surface_speed)
    if (bounds[0] is not None and speed < bounds[0] * (1.0 - SAME)) or (
        bounds[1] is not None and speed > bounds[1] * (1.0 + SAME)
    ):
        allowed = " to ".join(f"{60.0 * bound:.0f}" for bound in bounds if bound is not None)
        said.append(
            f"{feature.id}: the edge moves at {60.0 * speed:.0f} m/min, {tool.name} is for {allowed} m/min"
        )
    return said
