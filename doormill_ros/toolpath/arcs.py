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
    a, b = via - start, end - via
    chord = end - start
    # The angle at the circle point stands over half of the arc that lies opposite.
    normal = cross(a, b)
    across = float(np.linalg.norm(normal))
    turned = 2.0 * math.atan2(across, float(a @ b))
    if turned < STRAIGHT:
        direction = chord / max(float(np.linalg.norm(chord)), 1e-12)
        return float(np.linalg.norm(a) + np.linalg.norm(b)), math.inf, direction, direction
    radius = float(np.linalg.norm(chord)) / (2.0 * abs(math.sin(0.5 * turned)))
    normal = normal / across
    before, behind = float(np.linalg.norm(a)), float(np.linalg.norm(b))
    along = a / before
    # Between a chord and the tangent lies half the angle that the chord spans, asin of half of it over the radius.
    first = math.asin(min(1.0, before / (2.0 * radius)))
    last = math.asin(min(1.0, behind / (2.0 * radius)))
    onward = b / behind
    begin = math.cos(first) * along - math.sin(first) * cross(normal, along)
    finish = math.cos(last) * onward + math.sin(last) * cross(normal, onward)
    return radius * turned, radius, begin, finish


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
