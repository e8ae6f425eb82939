"""The only place where millimetres, degrees and revolutions per minute become SI and back."""

from __future__ import annotations

import math
from typing import TypeVar

import numpy as np

Number = TypeVar("Number", float, np.ndarray)

MM = 1e-3  #: metres in a millimetre
DEG = math.pi / 180.0  #: radians in a degree
RPM = 2.0 * math.pi / 60.0  #: radians per second in a revolution per minute
INCH = 25.4e-3  #: metres in an inch
FOOT = 12.0 * INCH  #: metres in a foot


def mm_to_m(value: Number) -> Number:
    """Millimetres to metres."""
    return value * MM


def m_to_mm(value: Number) -> Number:
    """Metres to millimetres."""
    return value / MM


def deg_to_rad(value: Number) -> Number:
    """Degrees to radians."""
    return value * DEG


def rad_to_deg(value: Number) -> Number:
    """Radians to degrees."""
    return value / DEG
