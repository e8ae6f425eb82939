"""One share by which all lengths are off, where the lengths of several links would tell the same.

Link lengths contain a scale of the tracker to the last digit, so that no pose tells the two apart: the simpler of two
explanations is taken where it predicts rows left out as well.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.diagnosis.pose.fitting.model import SeriesFit
from doormill_ros.diagnosis.pose.searching.selection import SURE, WORTH
from doormill_ros.robot_model.candidate import number
from doormill_ros.robot_model.pose.causes.cause import PoseCause
from doormill_ros.robot_model.pose.causes.link_geometry import LENGTHS, PARALLEL, LinkGeometry
from doormill_ros.robot_model.pose.causes.tracker_scale import PoseTrackerScale

#: Largest share that lengths may have in common: aluminium (24e-6 for each K) 20 K warmer or colder than its drawing. A
#: tracker that is told of the wrong air is off by a hundredth of that. More is no scale: lengths happen to agree.
LARGEST = 5e-4
#: Lengths that have to ask for one share where more than a part of them in so many is off by its own: of many that are
#: off, two agree by chance often.
AGREEING = 3


@dataclass(frozen=True, eq=False)
class Scaled:
    """A model with a scale in the place of lengths of links.

    Attributes:
        members: The scale first, then the others.
        earned: Whether enough lengths ask for its share to name it in their place.
    """

    members: tuple[PoseCause, ...]
    earned: bool


def scaled_members(model: SeriesFit) -> Scaled | None:
    """The members of a model with a scale in the place of lengths of links; None where lengths predict as well."""
    geometry = [cause for cause in model.members if isinstance(cause, LinkGeometry)]
    places = [(cause, name) for cause in geometry for name in cause.names if name in LENGTHS]
    if not places:
        return None
    first = {cause: int(model.ids([cause])[0]) for cause in geometry}
    ids = np.array([first[cause] + cause.names.index(name) for cause, name in places])
    solution = model.solution
    C = np.linalg.inv(solution.covariance[np.ix_(ids, ids)])
    H = C - np.diag(1.0 / solution.variance[ids])
    drawn = np.array([drawn_length(model.problem.sets[0].dh, number(c.where), name) for c, name in places])
    found = _spared(H, C @ solution.x[ids], drawn)
    if found is None:
        return None
    free, earned = found
    kept: dict[PoseCause, list[str]] = {cause: [] for cause in geometry}
    for at in free:
        cause, name = places[at]
        kept[cause].append(name)
    dh = model.problem.sets[0].dh
    members: list[PoseCause] = []
    for member in model.members:
        if isinstance(member, LinkGeometry):
            drawn_names = [name for name in LENGTHS if name in member.names and name not in kept[member]]
            members.append(LinkGeometry(member.where, dh, drawn_names))
        else:
            members.append(member)
    return Scaled((PoseTrackerScale("tracker"), *members), earned)


def spared(cause: LinkGeometry, members: Sequence[PoseCause]) -> bool:
    """Whether members with a scale do without a length of a link."""
    return any(
        isinstance(other, LinkGeometry) and other.key == cause.key and other.drawn for other in members
    )


def drawn_length(dh: FloatArray, link: int, name: str) -> float:
    """Nominal a or d of a link [m]; d with those of the parallel axes before it, which are the same displacement.

    Args:
        dh: Nominal table, shape (J, 4).
        link: Number of the link, from 1 on.
        name: a or d.
    """
    if name == "a":
        return float(dh[link - 1, 2])
    length = float(dh[link - 1, 1])
    for k in range(link - 2, -1, -1):
        if abs(np.sin(dh[k, 3])) >= PARALLEL:
            break
        length += float(np.cos(dh[k, 3])) * float(dh[k, 1])
    return length


def _spared(H: FloatArray, g: FloatArray, drawn: FloatArray) -> tuple[Sequence[int], bool] | None:
    """Lengths that stay free beside a scale, where fewer numbers explain as much with one; None where none do.

    Every length costs what a cause has to gain, and so does the scale.

    Args:
        H: What the data alone say of the lengths: their precision, shape (k, k).
        g: Precision times lengths, shape (k,).
        drawn: Nominal lengths, shape (k,) [m].

    Returns:
        The lengths, and whether the scale has earned its name.
    """
    best: dict[bool, tuple[float, Sequence[int]]] = {}
    for scaled in (False, True):
        for count in range(len(g) + (not scaled)):
            for some in combinations(range(len(g)), count):
                gain, share = _explained(H, g, some, drawn if scaled else None)
                if abs(share) > LARGEST:
                    continue
                score = gain - WORTH * (count + scaled)
                if scaled not in best or score > best[scaled][0]:
                    best[scaled] = score, some
    if True not in best or best[True][0] <= best[False][0]:
        return None
    free = best[True][1]
    if len(best[False][1]) - len(free) < 2:
        return None  # in the place of a single length it only fits that one, whatever the others are
    return free, _asking(H, g, free, drawn) >= AGREEING or AGREEING * len(free) <= len(g)


def _explained(
    H: FloatArray, g: FloatArray, free: Sequence[int], drawn: FloatArray | None
) -> tuple[float, float]:
    """What some lengths explain, with a scale of the drawn ones beside them where these are given, and its share."""
    M = np.eye(len(g))[:, list(free)]
    if drawn is not None:
        M = np.column_stack([M, drawn])
    if not M.size:
        return 0.0, 0.0
    pull = M.T @ g
    sizes = np.linalg.lstsq(M.T @ H @ M, pull, rcond=1e-12)[0]
    return float(pull @ sizes), 0.0 if drawn is None else float(sizes[-1])


def _asking(H: FloatArray, g: FloatArray, free: Sequence[int], drawn: FloatArray) -> int:
    """How many lengths ask for the share: that each of them is as drawn is refused by itself."""
    whole, _ = _explained(H, g, free, drawn)
    without = [np.where(np.arange(len(g)) == i, 0.0, drawn) for i in range(len(g)) if i not in free]
    return sum(whole - _explained(H, g, free, others)[0] > SURE**2 for others in without)
