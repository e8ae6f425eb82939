"""Can a MoveC follow three points."""

from __future__ import annotations

import math

import numpy as np

from doormill_ros.toolpath.errors import ArcError
from doormill_ros.toolpath.program import MillingProgram
from doormill_ros.units import m_to_mm, rad_to_deg

SMALLEST_CHORD = 1e-4  #: start to circle point, and start to end [m]
SMALLEST_ANGLE = math.radians(1.0)  #: between circle point and end, seen from the start [rad]
LARGEST_ARC = math.radians(240.0)


def unfollowable(program: MillingProgram) -> dict[int, str]:
    """Motions that the controller would stop at, with the reason.

    The limits are those of the controller's circular movement: three points apart, and no arc
    beyond about 240 degrees. They are checked on the corrected targets, which is what it gets.
    """
    places = np.array([t.T_base_tool_corrected[:3, 3] for t in program.targets])
    found: dict[int, str] = {}
    for i, motion in enumerate(program.motions):
        if motion.via is None:
            continue
        start = places[program.motions[i - 1].target]
        via, end = places[motion.via] - start, places[motion.target] - start
        near = min(float(np.linalg.norm(via)), float(np.linalg.norm(end)))
        seen = math.atan2(float(np.linalg.norm(np.cross(via, end))), float(via @ end))
        # The angle at the circle point stands over what the arc leaves of a full circle.
        back, on = -via, end - via
        corner = math.atan2(float(np.linalg.norm(np.cross(back, on))), float(back @ on))
        arc = 2.0 * (math.pi - corner)
        if near < SMALLEST_CHORD:
            found[i] = f"its points are {m_to_mm(near):.3f} mm apart, allowed is at least 0.1 mm"
        elif seen < SMALLEST_ANGLE:
            found[i] = f"it bends by {rad_to_deg(seen):.2f} deg, allowed is at least 1 deg"
        elif arc > LARGEST_ARC:
            found[i] = f"it turns by {rad_to_deg(arc):.0f} deg, allowed are 240 deg"
    return found


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
