"""Arithmetic and geometry; angles in degrees, lengths in millimetres, as RAPID has them."""

from __future__ import annotations

import math
from collections.abc import Callable

from doormill_ros.simulation.controller.rapid.context import Context
from doormill_ros.simulation.controller.rapid.faults import RapidFault
from doormill_ros.simulation.controller.rapid.library.predefined import predefined
from doormill_ros.simulation.controller.rapid.operators import num
from doormill_ros.simulation.controller.rapid.scope import Reference
from doormill_ros.simulation.controller.rapid.types import Value, is_integer
from doormill_ros.units import deg_to_rad, rad_to_deg

#: NOrient takes what is this close to a unit quaternion.
ORIENT_LIMIT = 0.1


def _function(head: str, function: Callable[..., float]) -> None:
    """Register a function of numbers; what it cannot take is ERR_ARGVALERR."""

    def run(_context: Context, *values: float) -> float:
        try:
            return num(function(*values))
        except (ValueError, ZeroDivisionError):
            given = ", ".join(f"{v:g}" for v in values)
            raise RapidFault(
                "ERR_ARGVALERR", f"{head.split('(')[0].split()[-1]}({given}) is not defined"
            ) from None
        except OverflowError:
            raise RapidFault("ERR_NUM_LIMIT", "the result is beyond the range of num") from None

    predefined(head)(run)


_function("FUNC num Abs(num Input)", abs)
_function("FUNC num Sqrt(num Value)", math.sqrt)
_function("FUNC num Pow(num Base, num Exponent)", math.pow)
_function("FUNC num Exp(num Exponent)", math.exp)
_function("FUNC num Sin(num Angle)", lambda a: math.sin(deg_to_rad(a)))
_function("FUNC num Cos(num Angle)", lambda a: math.cos(deg_to_rad(a)))
_function("FUNC num Tan(num Angle)", lambda a: math.tan(deg_to_rad(a)))
_function("FUNC num ASin(num Value)", lambda v: rad_to_deg(math.asin(v)))
_function("FUNC num ACos(num Value)", lambda v: rad_to_deg(math.acos(v)))
_function("FUNC num ATan(num Value)", lambda v: rad_to_deg(math.atan(v)))
_function("FUNC num ATan2(num Y, num X)", lambda y, x: rad_to_deg(math.atan2(y, x)))
_function("FUNC num DotProd(pos V1, pos V2)", lambda a, b: sum(x * y for x, y in zip(a, b, strict=True)))
_function("FUNC num VectMagn(pos Vector)", lambda v: math.hypot(*v))
_function("FUNC num Distance(pos P1, pos P2)", math.dist)


@predefined("FUNC num Round(num Val \\num Dec)")
def round_(_context: Context, value: float, decimals: float | None) -> float:
    """Round half away from zero."""
    scale = 10.0 ** int(decimals or 0)
    return num(math.copysign(math.floor(abs(value) * scale + 0.5) / scale, value))


@predefined("FUNC num Trunc(num Val \\num Dec)")
def trunc(_context: Context, value: float, decimals: float | None) -> float:
    """Cut decimals off."""
    scale = 10.0 ** int(decimals or 0)
    return num(math.trunc(value * scale) / scale)


@predefined("PROC Incr(INOUT num Name)")
def incr(_context: Context, place: Reference) -> None:
    """Add one."""
    place[0][place[1]] = num(place[0][place[1]] + 1.0)


@predefined("PROC Decr(INOUT num Name)")
def decr(_context: Context, place: Reference) -> None:
    """Take one away."""
    place[0][place[1]] = num(place[0][place[1]] - 1.0)


@predefined("PROC Add(INOUT num Name, num AddValue)")
def add(_context: Context, place: Reference, value: float) -> None:
    """Add a value."""
    place[0][place[1]] = num(place[0][place[1]] + value)


@predefined("PROC Clear(INOUT num Name)")
def clear(_context: Context, place: Reference) -> None:
    """Set to zero."""
    place[0][place[1]] = 0.0


@predefined("FUNC orient NOrient(orient Rotation)")
def n_orient(_context: Context, rotation: list[float]) -> list[float]:
    """A quaternion made unit; one far from unit is an error."""
    norm = math.sqrt(sum(q * q for q in rotation))
    if abs(norm - 1.0) > ORIENT_LIMIT:
        raise RapidFault("ERR_ILLQUAT", f"NOrient: the quaternion has length {norm:g}")
    return [num(q / norm) for q in rotation]


@predefined("FUNC robtarget Offs(robtarget Point, num XOffset, num YOffset, num ZOffset)")
def offs(_context: Context, point: Value, x: float, y: float, z: float) -> Value:
    """A target moved along the axes of the work object."""
    trans, *rest = point
    return [[num(a + b) for a, b in zip(trans, (x, y, z), strict=True)], *[list(item) for item in rest]]


@predefined("FUNC robtarget RelTool(robtarget Point, num Dx, num Dy, num Dz)")
def rel_tool(_context: Context, point: Value, x: float, y: float, z: float) -> Value:
    """A target moved along the axes of the tool."""
    trans, rotation, *rest = point
    moved = _rotate(rotation, (x, y, z))
    return [
        [num(a + b) for a, b in zip(trans, moved, strict=True)],
        list(rotation),
        *[list(item) for item in rest],
    ]


def _rotate(quaternion: list[float], vector: tuple[float, float, float]) -> list[float]:
    w, x, y, z = quaternion
    a, b, c = vector
    # t = 2 u x v; v' = v + w t + u x t
    tx, ty, tz = 2.0 * (y * c - z * b), 2.0 * (z * a - x * c), 2.0 * (x * b - y * a)
    return [
        a + w * tx + y * tz - z * ty,
        b + w * ty + z * tx - x * tz,
        c + w * tz + x * ty - y * tx,
    ]


@predefined("FUNC num BitAnd(byte BitData1, byte BitData2)")
def bit_and(_context: Context, a: float, b: float) -> float:
    """Bitwise AND of two bytes."""
    return _bits(a, b, lambda x, y: x & y)


@predefined("FUNC num BitXOr(byte BitData1, byte BitData2)")
def bit_xor(_context: Context, a: float, b: float) -> float:
    """Bitwise XOR of two bytes."""
    return _bits(a, b, lambda x, y: x ^ y)


def _bits(a: float, b: float, operation: Callable[[int, int], int]) -> float:
    for value in (a, b):
        if not is_integer(value) or not 0 <= value <= 255:
            raise RapidFault("ERR_ARGVALERR", f"{value:g} is no byte, allowed is 0 to 255")
    return float(operation(int(a), int(b)))
