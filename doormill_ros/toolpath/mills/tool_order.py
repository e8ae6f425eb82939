"""In which order features are milled so that the tool is changed as rarely as can be."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from doormill_ros.cell.places.rack import Rack
from doormill_ros.toolpath.cuts.operation import Operation
from doormill_ros.toolpath.errors import PathError, ToolChangeError, ToolPlaceError


@dataclass(frozen=True, eq=False)
class ToolShare:
    """What is milled with one tool in one go.

    Attributes:
        place: Number of the tool's place in the rack, from 0; None where the cell has no say in it.
        operations: In the order of milling.
    """

    place: int | None
    operations: tuple[Operation, ...]


def tool_shares(operations: Sequence[Operation], rack: Rack | None, allowed: int) -> list[ToolShare]:
    """The operations by tool, so that the fewest changes lead from the tool of the first place through all and back.

    Operations with one tool keep the recipe's order among them, and so do two of which one belongs to the other (a
    face plate, a hole through a lock case). A door none of whose tools stands in the rack is milled with the one that
    somebody put into the spindle.

    Args:
        operations: What one robot mills, in the recipe's order.
        rack: Where tools stand; None for a robot that cannot change them.
        allowed: Most tools of a door that takes none of the rack.

    Raises:
        ToolChangeError: There is no rack, and they take more tools.
        ToolPlaceError: They take a tool that stands in no place.
    """
    first: dict[str, str] = {}
    for item in operations:
        first.setdefault(item.feature.tool.name, item.feature.id)
    tools = list(first)
    if rack is None:
        if len(tools) > allowed:
            raise _no_rack(first, allowed)
        return [ToolShare(None, tuple(operations))]
    places = {name: rack.place_of(name) for name in tools}
    if len(tools) <= allowed and not any(place is not None for place in places.values()):
        return [ToolShare(None, tuple(operations))]
    for name, place in places.items():
        if place is None:
            standing = ", ".join(repr(item.tool) for item in rack.places)
            raise ToolPlaceError(
                f"{first[name]}: tool {name!r} stands in no place of the rack, allowed are {standing}; put it into one "
                "and write that into rack.places of config/cell.yaml, or give the feature one of those",
                feature=first[name],
                found=name,
            )
    order = _fewest(operations, rack.places[0].tool)
    return [ToolShare(places[group[0].feature.tool.name], tuple(group)) for group in order]


def _fewest(operations: Sequence[Operation], start: str) -> list[list[Operation]]:
    """Breadth first over what is left: each step takes all that a tool may mill now."""
    whole = tuple(range(len(operations)))
    waiting: list[tuple[str, tuple[int, ...], list[list[int]]]] = [(start, whole, [])]
    found: list[tuple[int, list[list[int]]]] = []
    seen: set[tuple[str, tuple[int, ...]]] = set()
    while waiting:
        at, left, done = waiting.pop(0)
        if not left:
            found.append((len(done) + (at != start), done))
            continue
        if (at, left) in seen:
            continue
        seen.add((at, left))
        tools = dict.fromkeys([start, *(operations[i].feature.tool.name for i in left)])
        for tool in tools:
            group = _ready(operations, left, tool)
            if group and (tool != at or not done):
                rest = tuple(i for i in left if i not in group)
                waiting.append((tool, rest, [*done, group]))
    best = min(found, key=lambda item: item[0] + (operations[item[1][0][0]].feature.tool.name != start))
    return [[operations[i] for i in group] for group in best[1]]


def _ready(operations: Sequence[Operation], left: Sequence[int], tool: str) -> list[int]:
    """Those of a tool before which nothing is left that has to come first."""
    group: list[int] = []
    for i in left:
        if operations[i].feature.tool.name != tool:
            continue
        before = (j for j in left if j < i and j not in group)
        if not any(_belong(operations[i], operations[j]) for j in before):
            group.append(i)
    return group


def _belong(a: Operation, b: Operation) -> bool:
    return a.feature.belongs_to == b.feature.id or b.feature.belongs_to == a.feature.id


def _no_rack(first: dict[str, str], allowed: int) -> PathError:
    feature = list(first.values())[allowed]
    found = ", ".join(f"{tool} for {name}" for tool, name in first.items())
    return ToolChangeError(
        f"{feature}: the door takes {len(first)} tools ({found}), allowed are {allowed} where config/cell.yaml has no "
        "rack; describe the cell's rack there, give the features one tool, or split the door between two robots",
        feature=feature,
        found=len(first),
        allowed=allowed,
    )
