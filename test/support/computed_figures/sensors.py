"""What docs/sensors.md prints of probe, beams and the comparison of two sensors."""

from __future__ import annotations

import math

from doormill_ros.localization.sensors.agreement import CHANCE
from doormill_ros.localization.sensors.touch_probe import load_touch_probe
from support.page_figures import number_of

ONE_IN = 1.0 / CHANCE
_PROBE = load_touch_probe()
LEAST_POINTS, MOST_POINTS = 6, len(_PROBE.points)
SEARCH = _PROBE.motion.search(_PROBE.motion.clearance)


def apart_on_the_narrowest() -> float:
    """Between the probe's points on the face of a door of the least width [m]."""
    narrowest = number_of("doormill_ros.recipes.door:WIDTH_MM.0 / 1000")
    return narrowest - sum(number_of(f"config/sensors/touch_probe.yaml#points.{k}.y") for k in (0, 2))


def range_beside_the_stand_off() -> float:
    """What the distance sensors' range leaves before and behind the stand-off [m]."""
    return number_of("config/sensors/photoelectric.yaml#sensor.range.1") - number_of(
        "config/sensors/photoelectric.yaml#stand_off"
    )


def farthest_beams() -> float:
    """Distance of two beams on the hinge edge at which the clamp's range uses that up [m]."""
    shift, turn = (number_of(f"config/cell.yaml#placement_limits.{name}") for name in ("y", "rotation"))
    return (range_beside_the_stand_off() - shift) / math.tan(turn)


def span() -> float:
    """Of the distance sensors' range [m]."""
    first, last = (number_of(f"config/sensors/photoelectric.yaml#sensor.range.{k}") for k in (0, 1))
    return last - first


def linearity() -> float:
    """Largest error of a characteristic as a share of the span."""
    return number_of("config/sensors/photoelectric.yaml#sensor.linearity") / span()
