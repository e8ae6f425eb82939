"""Mill a pocket or hole of any kind: plunge, clear in rings from the inside out, finish the wall."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.frames import cross
from doormill_ros.recipes.features.base import CLEARING
from doormill_ros.toolpath.curves.arcs import SMALLEST_CHORD
from doormill_ros.toolpath.curves.curve import Arc, Curve, Line, arc_about
from doormill_ros.toolpath.cuts.cut_writer import ABOVE_FLOOR, NEAR, CutWriter
from doormill_ros.toolpath.cuts.entry import centred, descent, head_room, straight_descent
from doormill_ros.toolpath.cuts.operation import Operation, from_line_near, from_longest_line
from doormill_ros.toolpath.cuts.rings import levels, rings
from doormill_ros.toolpath.errors import ToolFitError
from doormill_ros.toolpath.pacing.pace import ZONES, eased, zone_of
from doormill_ros.toolpath.plan import Step
from doormill_ros.toolpath.settings import PathSettings
from doormill_ros.units import deg_to_rad, m_to_mm

#: Of the tool radius: corners of clearing contours. With the stepover s no wood is left between two of them up to
#: (1 + sqrt(2) / 2 - 2 s) / (1 - sqrt(2) / 2) = 0.365.
CORNER = 0.35
LEAD_RADIUS = 0.5  #: of the tool radius
LEAD_ROOM = 0.5  #: of the width inside the path; in a round hole half of it ends farthest from the wall
SHORTEST_LEAD = 2e-4  #: below this radius there is no room to lead in on an arc [m]
AHEAD = 4.0  #: of the lead radius: where a wall pass begins behind another contour
LIFT = ABOVE_FLOOR  #: above the surface where a ramp begins [m]
CLOSING = 0.005  #: how far the wall pass runs past its start, so that no mark stays [m]
LARGEST_PIECE = deg_to_rad(180.0)  #: longer arcs are divided, long before MoveC refuses them
AROUND = 0.8  #: of the room beside the mill: how far from the middle it goes down before a wall pass


def pocket_steps(operation: Operation, settings: PathSettings) -> list[Step]:
    """From in front of the feature, through the wood, and back in front of it.

    Args:
        operation: What to mill.
        settings: Clearance and speeds.

    Returns:
        Steps; the first one starts and the last one ends at the clearance in front of the surface.

    Raises:
        ToolFitError: The tool is wider than the outline.
    """
    return _Pocket(operation, settings).steps()


class _Pocket(CutWriter):
    """Builds the steps of one operation."""

    def __init__(self, operation: Operation, settings: PathSettings) -> None:
        super().__init__(operation, settings)
        self.radius = self.feature.tool.radius
        self.half = min(self.feature.shape.width, self.feature.shape.length) / 2.0
        if self.radius > self.half + 1e-9:
            raise ToolFitError(
                f"{self.feature.id}: the tool {self.feature.tool.name} is {m_to_mm(2 * self.radius):g} mm "
                f"wide, allowed are {m_to_mm(2 * self.half):g} mm, the width of the outline; "
                "choose another tool",
                feature=self.feature.id,
            )
        self.slope = self.feature.tool.max_ramp  # of ramps down to contours

    def steps(self) -> list[Step]:
        """See `pocket_steps`."""
        passes, depth = self.feature.passes, self.operation.depth
        # The outermost roughing contour leaves the allowance, as far as there is room for it.
        rough = min(self.radius + passes.finish_allowance, max(self.radius, self.half - SMALLEST_CHORD))
        finish = rough > self.radius
        floor = 0.0
        for level in [depth] if self._helical(rough) else levels(depth, passes.depth_step):
            contours = rings(rough, self.half, self.radius)
            for number, inset in enumerate(contours):
                last = number == len(contours) - 1
                self._contour(inset, level, floor, wall=last and not finish, more=not last)
            floor = level
        if finish:
            self._contour(self.radius, depth, floor, wall=True)
        self._retract(depth)
        return eased(self.result, self.radius, self.settings)

    def _helical(self, inset: float) -> bool:
        """True where one helix leads down to the floor of a round hole, no turn of it deeper than the depth step."""
        shape, tool = self.feature.shape.inset(inset), self.feature.tool
        pitch = 2.0 * shape.width * math.tan(tool.max_ramp)
        return (
            not tool.centre_cutting
            and max(shape.width, shape.length) - 2.0 * shape.radius < NEAR
            and len(rings(inset, self.half, self.radius)) == 1
            and pitch <= self.feature.passes.depth_step
        )

    def _contour(self, inset: float, depth: float, floor: float, wall: bool, more: bool = False) -> None:
        corner = 0.0 if wall else CORNER * self.radius
        # Behind another contour the way in lies ahead: the tool need not turn back for it.
        ahead = AHEAD * (self._lead_radius(inset) or 0.0) if wall and self.result else 0.0
        pieces = self._pieces(inset, depth, corner, wall, ahead)
        # Above the surface the corner into the ramp is flown by.
        down = float((pieces[0][0].start - self.at) @ self.inward) if self.result else depth + LIFT
        entering = down > NEAR and not self.feature.tool.centre_cutting
        if entering and not wall:
            pieces = self._down_along(pieces, down, more)
        start, tangent = pieces[0][0].start, pieces[0][0].tangent(0.0)
        lead = self._lead(start, tangent, inset) if wall else None
        begin = start if lead is None else lead.start
        if entering and wall:
            room = 0.0 if pieces[-1][0].is_arc else pieces[-1][0].length - (self._lead_radius(inset) or 0.0)
            self._down_to(begin, tangent, down, room)
        self._go(begin, depth, floor)
        if lead is not None:
            self._cut(lead, pieces[0][1], wall)
        for curve, name in pieces:
            self._cut(curve, name if wall else CLEARING, wall)
        if wall:
            last = self._close(pieces, inset)
            leave = self._lead(last.end, last.tangent(1.0), inset, away=True)
            if leave is not None:
                self._cut(leave, None, wall)
            self._mark_corners()

    def _pieces(
        self, inset: float, depth: float, corner: float, wall: bool = False, ahead: float = 0.0
    ) -> list[tuple[Curve, str]]:
        contour = self.operation.contour(inset, depth, corner)
        ramps = not self.feature.tool.centre_cutting
        if ramps and not wall and all(curve.is_arc for curve, _ in contour):
            pieces = contour  # as few arcs as can be
        elif ramps and self.result:
            pieces = from_line_near(contour, self.at, ahead)
        else:
            pieces = from_longest_line(contour, ahead)
        return [part for curve, name in pieces for part in _followable(curve, name)]

    def _down_along(
        self, pieces: list[tuple[Curve, str]], drop: float, more: bool
    ) -> list[tuple[Curve, str]]:
        """Down along a contour that clears, from where the tool stands if that is on it; the contour from there on."""
        slope = self.feature.tool.max_ramp
        # The next contour begins near the middle of a line; before a contour that stands alone the tool waits there.
        at = self.at
        if not (self.result or more or pieces[0][0].is_arc):
            step, ahead = self.feature.passes.depth_step, AHEAD * (self._lead_radius(self.radius) or 0.0)
            drops = np.diff([-LIFT, *levels(self.operation.depth, step)]).tolist()
            at, self.slope = centred(pieces, drops, slope, ahead)
        return self._along(pieces, at, drop, self.slope, more)

    def _along(
        self,
        pieces: list[tuple[Curve, str]],
        at: FloatArray,
        drop: float,
        slope: float,
        arriving: bool = False,
    ) -> list[tuple[Curve, str]]:
        """Down along a contour; the contour from there on."""
        found = descent(pieces, at, drop, slope, self.inward, arriving=arriving)
        over = self._over(found.ramp[0])
        if over > 0.0:
            found = descent(pieces, at, drop + over, slope, self.inward, arriving=arriving)
        self._ramp(found.ramp, found.slope)
        return list(found.lap)

    def _down_to(self, end: FloatArray, tangent: FloatArray, drop: float, room: float) -> None:
        """Down to where the wall pass begins: straight if there is room for it, else round the middle and across."""
        slope = self.feature.tool.max_ramp
        needed = drop + self._over(straight_descent(end, tangent, drop, slope, self.inward))
        if needed <= room * math.tan(slope):
            self._ramp([straight_descent(end, tangent, needed, slope, self.inward)], slope)
            return
        inset = self.half - AROUND * (self.half - self.radius)
        depth = float((end - self.operation.T_door_feature[:3, 3]) @ self.inward)
        lap = self._along(self._pieces(inset, depth, CORNER * self.radius), self.at, drop, slope)
        flat, _ = lap[0]
        if float((end - self.at) @ flat.tangent(0.0)) < 0.0:
            # A ramp that turned back at its end would be flown by steeper than it is; the flat way on is not.
            level = flat.part(0.0, min(1.0, 2.0 * ZONES[zone_of(self.radius)] / flat.length))
            self._cut(level, CLEARING, False)

    def _over(self, ramp: Curve) -> float:
        """How far over the floor the tool has to begin a ramp that it comes to along the floor [m]."""
        if not self.result:
            return 0.0  # it comes from in front of the surface
        way = ramp.start - self.at
        if np.linalg.norm(way) < NEAR:
            way = self.result[-1].curve.tangent(1.0)
        return head_room(way, ramp, ZONES[zone_of(self.radius)], self.inward)

    def _lead_radius(self, inset: float) -> float | None:
        """Radius of lead-in and lead-out [m], None where there is no room for them."""
        shape = self.feature.shape.inset(inset)
        radius = min(LEAD_RADIUS * self.radius, LEAD_ROOM * (self.half - inset))
        straight = (max(shape.width, shape.length) - 2.0 * shape.radius) / 2.0
        if shape.radius < radius:
            # Both must end before the corner, and the pass run past its start by what a motion needs.
            radius = min(radius, LEAD_ROOM * straight - SMALLEST_CHORD)
        return radius if radius >= SHORTEST_LEAD else None

    def _close(self, pieces: list[tuple[Curve, str]], inset: float) -> Curve:
        """Past the start of the wall pass, where nothing is left to cut and no force acts."""
        left = CLOSING
        if not pieces[0][0].is_arc and self.feature.shape.inset(inset).radius < left:
            # The way out must not run into the next corner.
            left = min(left, max(pieces[0][0].length - (self._lead_radius(inset) or 0.0), SMALLEST_CHORD))
        for curve, _ in pieces:
            last = curve if curve.length <= left else curve.part(0.0, left / curve.length)
            self._cut(last, None, True)
            left -= last.length
            if left < max(SMALLEST_CHORD, self.feed * self.settings.correction.segment_time):
                break
        return last

    def _lead(self, point: FloatArray, tangent: FloatArray, inset: float, away: bool = False) -> Arc | None:
        """Quarter turn that meets the wall pass along its tangent, from the middle of the pocket."""
        radius = self._lead_radius(inset)
        if radius is None:
            return None
        # The pocket lies to the right of climb milling, seen from inside the wood, else to the left.
        side = cross(tangent, self.inward)
        middle = self.operation.T_door_feature[:3, 3] - point
        turn = -1.0 if side @ middle > 0.0 else 1.0
        centre = point - turn * radius * side
        quarter = turn * math.pi / 2.0
        if away:
            return arc_about(point, centre, self.inward, quarter)
        start = centre - radius * tangent
        arc = arc_about(start, centre, self.inward, quarter)
        return replace(arc, end=point)


def _followable(curve: Curve, name: str) -> list[tuple[Curve, str]]:
    """The curve in pieces that MoveL and MoveC can follow."""
    if not isinstance(curve, Arc):
        return [(curve, name)]
    count = max(1, math.ceil(curve.sweep / LARGEST_PIECE - 1e-9))
    cuts = np.linspace(0.0, 1.0, count + 1)
    parts = [curve.part(a, b) for a, b in itertools.pairwise(cuts)]
    if np.linalg.norm(parts[0].point(0.5) - parts[0].start) > SMALLEST_CHORD:
        return [(part, name) for part in parts]
    # Two chords of so small an arc leave less wood than a hundredth of a millimetre.
    corners = curve.points(np.linspace(0.0, 1.0, 2 * count + 1))
    return [(Line(a, b), name) for a, b in itertools.pairwise(corners)]
