"""Spindle speed and feed from surface speed and chip load, and back.

Equation 3.51 of the thesis relates the surface speed to the spindle speed, equation 3.52 the
feed to the feed per tooth (`MMPM = FPT * T * RPM`). In SI they read

    v_c = pi * d * n          n = spindle / (2 pi) revolutions per second      (3.51)
    v_f = f_z * z * n                                                          (3.52)

with the surface speed v_c [m/s], the cutter diameter d [m], the feed v_f [m/s], the feed per
tooth f_z [m] (the chip load) and z teeth. Spindle speeds are angular velocities [rad/s];
`doormill_ros.units.RPM` turns revolutions per minute into them.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from doormill_ros.milling.errors import CuttingParameterError
from doormill_ros.units import FOOT, INCH, MM, RPM

SURFACE_FOOT_PER_MINUTE = FOOT / 60.0  #: metres per second in a surface foot per minute (SFM)
SURFACE_METRE_PER_MINUTE = 1.0 / 60.0  #: metres per second in a surface metre per minute (SMM)


@dataclass(frozen=True)
class Cutter:
    """A milling tool and the range it is rated for.

    Attributes:
        name: What to call it in a warning.
        diameter: Cutter diameter [m].
        flutes: Number of teeth.
        max_spindle: Highest spindle speed [rad/s].
        chip_load: Lowest and highest feed per tooth [m].
        surface_speed: Lowest and highest surface speed in the material [m/s].
    """

    name: str
    diameter: float
    flutes: int
    max_spindle: float
    chip_load: tuple[float, float]
    surface_speed: tuple[float, float]

    def __post_init__(self) -> None:
        """Refuse a tool that cannot exist.

        Raises:
            CuttingParameterError: A figure is not positive and finite, or a range is upside down.
        """
        _positive("diameter", self.diameter, "m")
        _positive("max_spindle", self.max_spindle, "rad/s")
        _teeth(self.flutes)
        for name, (low, high), unit in (
            ("chip_load", self.chip_load, "m"),
            ("surface_speed", self.surface_speed, "m/s"),
        ):
            _positive(f"lower bound of {name}", low, unit)
            _positive(f"upper bound of {name}", high, unit)
            if low > high:
                raise CuttingParameterError(
                    f"{name} of {self.name} runs from {low:g} to {high:g} {unit}; give the lower bound first"
                )


@dataclass(frozen=True)
class CuttingData:
    """One setting of spindle and feed, seen from both sides of equations 3.51 and 3.52.

    Attributes:
        spindle: Spindle speed [rad/s].
        feed: Feed [m/s].
        surface_speed: Speed of the cutting edge [m/s].
        chip_load: Feed per tooth [m].
        warnings: One sentence for each figure outside the cutter's range.
    """

    spindle: float
    feed: float
    surface_speed: float
    chip_load: float
    warnings: tuple[str, ...]


def _positive(name: str, value: float, unit: str) -> float:
    if not (isinstance(value, int | float) and math.isfinite(value) and value > 0.0):
        raise CuttingParameterError(
            f"{name} is {value!r}, allowed is a finite number above 0 {unit}; correct it", **{"value": value}
        )
    return float(value)


def _teeth(flutes: int) -> int:
    if isinstance(flutes, bool) or not isinstance(flutes, int) or flutes < 1:
        raise CuttingParameterError(
            f"number of flutes is {flutes!r}, allowed is a whole number from 1", value=flutes
        )
    return flutes


def spindle_speed(surface_speed: float, diameter: float) -> float:
    """Spindle speed [rad/s] that gives a surface speed [m/s] on a diameter [m] (3.51).

    Raises:
        CuttingParameterError: An argument is not positive and finite.
    """
    return 2.0 * _positive("surface speed", surface_speed, "m/s") / _positive("diameter", diameter, "m")


def surface_speed(spindle: float, diameter: float) -> float:
    """Surface speed [m/s] of a diameter [m] at a spindle speed [rad/s] (3.51 solved for v_c).

    Raises:
        CuttingParameterError: An argument is not positive and finite.
    """
    return _positive("spindle speed", spindle, "rad/s") * _positive("diameter", diameter, "m") / 2.0


def feed(chip_load: float, flutes: int, spindle: float) -> float:
    """Feed [m/s] of `flutes` teeth that each take `chip_load` [m] at a spindle speed [rad/s] (3.52).

    Raises:
        CuttingParameterError: An argument is not positive and finite.
    """
    turns = _positive("spindle speed", spindle, "rad/s") / (2.0 * math.pi)
    return _positive("chip load", chip_load, "m") * _teeth(flutes) * turns


def chip_load(feed: float, flutes: int, spindle: float) -> float:
    """Feed per tooth [m] at a feed [m/s] and a spindle speed [rad/s] (3.52 solved for f_z).

    Raises:
        CuttingParameterError: An argument is not positive and finite.
    """
    turns = _positive("spindle speed", spindle, "rad/s") / (2.0 * math.pi)
    return _positive("feed", feed, "m/s") / (_teeth(flutes) * turns)


def from_machine(spindle: float, feed: float, cutter: Cutter) -> CuttingData:
    """What a spindle speed [rad/s] and a feed [m/s] mean to the cutter.

    Raises:
        CuttingParameterError: An argument is not positive and finite.
    """
    return _data(spindle, feed, cutter)


def from_cutting(surface_speed: float, chip_load: float, cutter: Cutter) -> CuttingData:
    """Spindle speed and feed that give a surface speed [m/s] and a chip load [m].

    Raises:
        CuttingParameterError: An argument is not positive and finite.
    """
    spindle = spindle_speed(surface_speed, cutter.diameter)
    return _data(spindle, feed(chip_load, cutter.flutes, spindle), cutter)


def allowed_spindle(cutter: Cutter) -> tuple[float, float]:
    """Lowest and highest spindle speed [rad/s] within surface speed and rating of the cutter.

    Raises:
        CuttingParameterError: The lowest surface speed already needs more than the rating.
    """
    low = spindle_speed(cutter.surface_speed[0], cutter.diameter)
    high = min(spindle_speed(cutter.surface_speed[1], cutter.diameter), cutter.max_spindle)
    if low > high:
        raise CuttingParameterError(
            f"{cutter.name} needs {low / RPM:.0f} rpm for its lowest surface speed, its rating is "
            f"{high / RPM:.0f} rpm; take a larger cutter"
        )
    return low, high


def _data(spindle: float, feed_rate: float, cutter: Cutter) -> CuttingData:
    speed = surface_speed(spindle, cutter.diameter)
    load = chip_load(feed_rate, cutter.flutes, spindle)
    warnings = []
    # A figure set exactly to a bound must not warn because of its last bit.
    slack = 1e-9
    if spindle > cutter.max_spindle * (1.0 + slack):
        warnings.append(
            f"spindle speed {spindle / RPM:.0f} rpm is above the {cutter.max_spindle / RPM:.0f} rpm "
            f"{cutter.name} is rated for; slow the spindle down"
        )
    for what, value, (low, high), unit, scale in (
        ("surface speed", speed, cutter.surface_speed, "SFM", SURFACE_FOOT_PER_MINUTE),
        ("chip load", load, cutter.chip_load, "mm", MM),
    ):
        if not low * (1.0 - slack) <= value <= high * (1.0 + slack):
            side = "below" if value < low else "above"
            warnings.append(
                f"{what} {value / scale:.4g} {unit} is {side} the range {low / scale:.4g} to "
                f"{high / scale:.4g} {unit} of {cutter.name}"
            )
    return CuttingData(spindle, feed_rate, speed, load, tuple(warnings))


#: The cutter of section 3.9: 19 mm, two flutes, 18000 rpm; chip load of similar tools, softwood.
THESIS_CUTTER = Cutter(
    name="19 mm two-flute straight wood mill",
    diameter=19.0 * MM,
    flutes=2,
    max_spindle=18000.0 * RPM,
    chip_load=(0.019 * INCH, 0.025 * INCH),
    surface_speed=(700.0 * SURFACE_FOOT_PER_MINUTE, 900.0 * SURFACE_FOOT_PER_MINUTE),
)
