"""The only place where millimetres, micrometres, degrees, revolutions per minute and nanoseconds become SI and back."""

from __future__ import annotations

import math
from typing import TypeVar

from doormill_ros.arrays import FloatArray

Number = TypeVar("Number", float, FloatArray)

MM = 1e-3  #: metres in a millimetre
UM = 1e-6  #: metres in a micrometre; also radians in a microradian
DEG = math.pi / 180.0  #: radians in a degree
RPM = 2.0 * math.pi / 60.0  #: radians per second in a revolution per minute
#: Standard acceleration of free fall [m/s^2] (3rd CGPM 1901), along base -z; what weighs a load here takes it.
GRAVITY = 9.80665


def mm_to_m(value: Number) -> Number:
    """Millimetres to metres."""
    return value * MM


def m_to_mm(value: Number) -> Number:
    """Metres to millimetres, radians to milliradians."""
    return value / MM


def m_to_um(value: Number) -> Number:
    """Metres to micrometres, radians to microradians."""
    return value * 1e6


def share_to_ppm(value: Number) -> Number:
    """A share to parts in a million."""
    return value * 1e6


def s_to_ms(value: Number) -> Number:
    """Seconds to milliseconds."""
    return value * 1e3


def s_to_us(value: float) -> float:
    """Seconds to microseconds."""
    return value * 1e6


def us_to_s(value: float) -> float:
    """Microseconds to seconds."""
    return value / 1e6


def ns_to_s(value: float) -> float:
    """Nanoseconds to seconds."""
    return value / 1e9


def s_to_ns(value: float) -> int:
    """Seconds to whole nanoseconds, towards zero."""
    return int(value * 1e9)


def hours_to_s(value: float) -> float:
    """Hours to seconds."""
    return value * 3600.0


def days_to_s(value: float) -> float:
    """Days to seconds."""
    return value * 86_400.0


def gigabytes_to_bytes(value: float) -> float:
    """Gigabytes of 10^9 bytes to bytes."""
    return value * 1e9


def bytes_to_gigabytes(value: float) -> float:
    """Bytes to gigabytes of 10^9 bytes."""
    return value / 1e9


def n_per_m_to_n_per_um(value: Number) -> Number:
    """Newtons per metre to newtons per micrometre."""
    return value / 1e6


def rad_s_to_rpm(value: Number) -> Number:
    """Radians per second to revolutions per minute."""
    return value / RPM


def deg_to_rad(value: Number) -> Number:
    """Degrees to radians."""
    return value * DEG


def rad_to_deg(value: Number) -> Number:
    """Radians to degrees."""
    return value / DEG


def rad_to_mrad(value: Number) -> Number:
    """Radians to milliradians."""
    return value * 1e3
