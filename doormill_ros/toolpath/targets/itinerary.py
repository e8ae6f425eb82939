"""Which targets a program has, and which steps of its plan pass each of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from doormill_ros.arrays import FloatArray, IntArray
from doormill_ros.toolpath.plan import Plan, Step
from doormill_ros.toolpath.program import MotionKind
from doormill_ros.toolpath.stations import FRACTIONS, VIA


@dataclass(eq=False)
class Visit:
    """One station at which the program passes a target: step, and station on it."""

    step: int
    station: int


@dataclass(eq=False)
class Stop:
    """A target with every visit to it.

    Attributes:
        name: Name in the program.
        feature: Feature it belongs to.
        visits: Stations at this target; the corrections of the decisive ones are averaged.
    """

    name: str
    feature: str
    visits: list[Visit] = field(default_factory=list)


@dataclass(frozen=True, eq=False)
class Itinerary:
    """Targets in the order of the target file, and which of them each step uses.

    Attributes:
        stops: The targets.
        end: Index of the target at the end of each step, -1 where that is a point of joint space, shape (m,).
        via: Index of the circle point of each step, -1 for a straight one, shape (m,).
    """

    stops: tuple[Stop, ...]
    end: IntArray
    via: IntArray


def itinerary(plan: Plan) -> Itinerary:
    """Number the targets of a plan.

    Named targets that come up again are one target, and so are those of a step that starts where
    the one before ended. A step that goes joint by joint has none.
    """
    steps = plan.steps
    stops: list[Stop] = []
    index: dict[str, int] = {}

    def stop(name: str, step: Step) -> int:
        if name and name in index:
            return index[name]
        index[name or f"#{len(stops)}"] = len(stops)
        stops.append(Stop(name or str(len(stops) + 1), step.feature))
        return len(stops) - 1

    end, via = [-1] * len(steps), [-1] * len(steps)
    for i, step in enumerate(steps):
        if step.kind is MotionKind.ABSOLUTE:
            continue
        if step.kind is MotionKind.CIRCULAR:
            via[i] = stop(step.via_name, step)
            stops[via[i]].visits.append(Visit(i, VIA))
        end[i] = stop(step.name, step)
        stops[end[i]].visits.append(Visit(i, -1))
        if i and end[i - 1] >= 0:
            stops[end[i - 1]].visits.append(Visit(i, 0))
    ends, vias = np.array(end), np.array(via)
    if plan.target_order:
        place = {name: k for k, name in enumerate(plan.target_order)}
        new = np.array([place[s.name] for s in stops])
        ordered: Sequence[Stop] = sorted(stops, key=lambda s: place[s.name])
        ends, vias = (np.where(numbers >= 0, new[numbers], -1) for numbers in (ends, vias))
        return Itinerary(tuple(ordered), ends, vias)
    return Itinerary(tuple(stops), ends, vias)


def decisive(stop: Stop, steps: Sequence[Step]) -> list[Visit]:
    """The visits whose load a target is corrected for.

    The finished wall counts first, other cuts count where there is no wall, and a target in the
    air is not corrected.
    """
    wall = [v for v in stop.visits if steps[v.step].wall]
    return wall or [v for v in stop.visits if steps[v.step].cutting] or stop.visits[:1]


def shift_along(route: Itinerary, shift: FloatArray) -> FloatArray:
    """What is added at the targets, interpolated along every step.

    Args:
        route: Targets and steps.
        shift: At each target, shape (n, d).

    Returns:
        At the stations of each step, shape (m, k, d).
    """
    t = FRACTIONS[None, :, None]
    shift = np.concatenate(
        [shift, np.zeros_like(shift[:1])]
    )  # of -1: nothing is added at points of joint space
    start = shift[np.concatenate([route.end[:1], route.end[:-1]])][:, None]  # (m, 1, d)
    end = shift[route.end][:, None]
    straight = start + t * (end - start)
    via = np.where(route.via >= 0, route.via, 0)
    middle = np.where((route.via >= 0)[:, None, None], shift[via][:, None], 0.5 * (start + end))
    first, second = start + 2.0 * t * (middle - start), middle + (2.0 * t - 1.0) * (end - middle)
    round_: FloatArray = np.where(t <= 0.5, first, second)
    return np.where((route.via >= 0)[:, None, None], round_, straight)
