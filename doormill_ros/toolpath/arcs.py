"""Can a MoveC follow three points."""

from __future__ import annotations

import math

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.frames import cross
from doormill_ros.toolpath.errors import ArcError
from doormill_ros.toolpath.program import MillingProgram
from doormill_ros.units import deg_to_rad, m_to_mm, rad_to_deg

SMALLEST_CHORD = 1e-4  #: start to circle point, and start to end [m]
SMALLEST_ANGLE = deg_to_rad(1.0)  #: between circle point and end, seen from the start [rad]
LARGEST_ARC = deg_to_rad(240.0)
STRAIGHT = 1e-6  #: an arc that turns by less is a line [rad]


def unfollowable(program: MillingProgram) -> dict[int, str]:
    """Motions that the controller would stop at, with the reason.

    The limits are those of the controller's circular movement: three points apart, and no arc
    beyond about 240 degrees. They are checked on the corrected targets, which is what it gets.
    """
    circular = {i: motion.via for i, motion in enumerate(program.motions) if motion.via is not None}
    if not circular:
        return {}
    arcs = list(circular)
    places = np.array([t.T_base_tool_corrected[:3, 3] for t in program.targets])
    # Before an arc the tool is in the wood, at a target.
    start = places[[program.motions[i - 1].target for i in arcs]]  # (n, 3)
    via = places[list(circular.values())] - start
    end = places[[program.motions[i].target for i in arcs]] - start
    near = np.minimum(np.linalg.norm(via, axis=1), np.linalg.norm(end, axis=1))
    seen = _angle(via, end)
    # The angle at the circle point stands over what the arc leaves of a full circle.
    turned = 2.0 * (math.pi - _angle(-via, end - via))
    found: dict[int, str] = {}
    for k, i in enumerate(arcs):
        if near[k] < SMALLEST_CHORD:
            found[i] = f"its points are {m_to_mm(near[k]):.3f} mm apart, allowed is at least 0.1 mm"
        elif seen[k] < SMALLEST_ANGLE:
            found[i] = f"it bends by {rad_to_deg(seen[k]):.2f} deg, allowed is at least 1 deg"
        elif turned[k] > LARGEST_ARC:
            found[i] = f"it turns by {rad_to_deg(turned[k]):.0f} deg, allowed are 240 deg"
    return found


def circle(
    start: FloatArray, via: FloatArray, end: FloatArray
) -> tuple[float, float, FloatArray, FloatArray]:
    """What a MoveC through three points is, each of shape (3,) [m].

    Returns:
        Length and radius [m], and the unit directions of travel at begin and end, shape (3,).
    """
    # Plain numbers: three of them cost an array as much as a thousand do, and a door has hundreds of arcs.
    a, b, chord = (via - start).tolist(), (end - via).tolist(), (end - start).tolist()
    # The angle at the circle point stands over half of the arc that lies opposite.
    normal = _cross(a, b)
    across, before, behind, straight = (math.hypot(*vector) for vector in (normal, a, b, chord))
    turned = 2.0 * math.atan2(across, _dot(a, b))
    if turned < STRAIGHT:
        direction = np.array(chord) / max(straight, 1e-12)
        return before + behind, math.inf, direction, direction
    radius = straight / (2.0 * abs(math.sin(0.5 * turned)))
    # Between a chord and the tangent lies half the angle that the chord spans, asin of half of it over the radius.
    first = math.asin(min(1.0, before / (2.0 * radius)))
    last = math.asin(min(1.0, behind / (2.0 * radius)))
    begin = _turned(a, _cross(normal, a), -first, before, across)
    finish = _turned(b, _cross(normal, b), last, behind, across)
    return radius * turned, radius, begin, finish


def turn_between(a: FloatArray, b: FloatArray) -> float:
    """Angle between two vectors of shape (3,) [rad]."""
    first, second = a.tolist(), b.tolist()
    return math.atan2(math.hypot(*_cross(first, second)), _dot(first, second))


def _turned(along: list[float], aside: list[float], angle: float, length: float, across: float) -> FloatArray:
    """Unit direction of a vector turned towards another one at right angles, `across` times as long as itself."""
    c, s = math.cos(angle) / length, math.sin(angle) / (length * across)
    return np.array([c * u + s * v for u, v in zip(along, aside, strict=True)])


def _dot(a: list[float], b: list[float]) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def _cross(a: list[float], b: list[float]) -> list[float]:
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def _angle(a: FloatArray, b: FloatArray) -> FloatArray:
    """Angles between vectors, shapes (n, 3) -> (n,) [rad]."""
    angle: FloatArray = np.arctan2(np.linalg.norm(cross(a, b), axis=1), np.einsum("ni,ni->n", a, b))
    return angle


def check_arcs(program: MillingProgram) -> None:
    """Refuse a program with a MoveC that the controller would stop at.

    Raises:
        ArcError: Names the motion and the limit.
    """
    for i, reason in unfollowable(program).items():
        motion = program.motions[i]
        name = program.targets[motion.target].name
        raise ArcError(
            f"{motion.feature}, target {name}: the arc cannot be followed, {reason}; check radius and tool",
            feature=motion.feature,
            target=name,
            motion=i + 1,
        )
