"""The rack from which the robot takes its tools, and the gauge that measures their length."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from pydantic import StrictBool

from doormill_ros.cell.errors import BadCellFile
from doormill_ros.cell.rapid_limits import MAX_PLACES
from doormill_ros.robot.bodies import Body
from doormill_ros.robot.description import Joints
from doormill_ros.values import Name, Positive, Section


@dataclass(frozen=True, eq=False)
class RackPlace(Section):
    """A place of the rack.

    Attributes:
        tool: The tool that stands in it; the first place's is in the spindle between doors.
        front: Joint angles of the robot in front of it, shape (6,) [rad].
    """

    tool: Name
    front: Joints


@dataclass(frozen=True, eq=False)
class Gauge(Section):
    """What measures how far a tool stands out of the spindle.

    Attributes:
        front: Joint angles of the robot in front of it, shape (6,) [rad].
        depth: How far the spindle goes from there along its axis until a tool of the nominal length is measured [m].
    """

    front: Joints
    depth: Positive


@dataclass(frozen=True, eq=False)
class Rack(Section):
    """Where tools stand.

    Attributes:
        measured: False for a rack that somebody assumed.
        source: Where the figures come from.
        depth: How far the spindle goes along its axis from in front of a place until a tool is seated there [m].
        holder: What holds the tool of a place, in the flange frame as it is where the tool is seated.
        places: Counted from 1, as in rapid/DoorTool.mod.
        gauge: What measures lengths.
    """

    measured: StrictBool
    source: Name
    depth: Positive
    holder: Body
    places: tuple[RackPlace, ...]
    gauge: Gauge

    def place_of(self, tool: str) -> int | None:
        """Number of the place in which a tool stands, from 0; None for a tool that stands in none."""
        return next((i for i, place in enumerate(self.places) if place.tool == tool), None)

    def held_in(self, place: RackPlace) -> Body:
        """The holder of one place, under a name of its own, in the frame in which `holder` is given."""
        return replace(self.holder, name=f"holder of {place.tool}")


def check_rack(rack: Rack | None, where: str = "rack") -> Rack | None:
    """The rack, or none.

    Args:
        rack: What the cell's file says.
        where: Under which key.

    Raises:
        BadCellFile: It has no place or too many, or a tool stands in two.
    """
    if rack is None:
        return None
    if not 1 <= len(rack.places) <= MAX_PLACES:
        raise BadCellFile(
            f"{where}.places holds {len(rack.places)} places, allowed are 1 to {MAX_PLACES}: name those with a tool"
        )
    twice = _twice([place.tool for place in rack.places])
    if twice is not None:
        raise BadCellFile(
            f"{where}.places has tool {twice!r} in two places, allowed is one place for each tool: correct the name of "
            "one"
        )
    return rack


def _twice(names: Sequence[str]) -> str | None:
    return next((name for i, name in enumerate(names) if name in names[:i]), None)
