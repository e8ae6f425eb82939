"""One share by which all lengths are off, where the lengths of several links would tell the same.

Link lengths contain a scale of the tracker to the last digit, so that no pose tells the two apart: the simpler of two
explanations is taken where it predicts rows left out as well.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.diagnosis.pose.model import SeriesFit
from doormill_ros.diagnosis.pose.selection import WORTH
from doormill_ros.robot_model.candidate import number
from doormill_ros.robot_model.pose.causes.cause import PoseCause
from doormill_ros.robot_model.pose.causes.link_geometry import LENGTHS, PARALLEL, LinkGeometry
from doormill_ros.robot_model.pose.causes.tracker_scale import PoseTrackerScale

#: Largest share that lengths may have in common: aluminium (24e-6 for each K) 20 K warmer or colder than its drawing. A
#: tracker that is told of the wrong air is off by a hundredth of that. More is no scale: lengths happen to agree.
LARGEST = 5e-4


def scaled_members(model: SeriesFit) -> tuple[PoseCause, ...] | None:
    """The members of a model with a scale in the place of lengths of links; None where it spares no length."""
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
    free = _spared(H, C @ solution.x[ids], drawn)
    if free is None:
        return None
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
    return (PoseTrackerScale("tracker"), *members)


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


def _spared(H: FloatArray, g: FloatArray, drawn: FloatArray) -> Sequence[int] | None:
    """Lengths that stay free beside a scale, where fewer numbers explain as much with one; None where none do.

    Every length costs what a cause has to gain, and so does the scale.

    Args:
        H: What the data alone say of the lengths: their precision, shape (k, k).
        g: Precision times lengths, shape (k,).
        drawn: Nominal lengths, shape (k,) [m].
    """
    best: dict[bool, tuple[float, Sequence[int]]] = {}
    for scaled in (False, True):
        for count in range(len(g) + (not scaled)):
            for free in combinations(range(len(g)), count):
                M = np.eye(len(g))[:, free]
                M = np.column_stack([M, drawn]) if scaled else M
                pull = M.T @ g
                sizes = np.linalg.lstsq(M.T @ H @ M, pull, rcond=1e-12)[0] if M.size else np.empty(0)
                if scaled and abs(sizes[-1]) > LARGEST:
                    continue
                score = float(pull @ sizes) - WORTH * M.shape[1]
                if scaled not in best or score > best[scaled][0]:
                    best[scaled] = score, free
    if True not in best:
        return None
    # In the place of a single length it only fits that one, whatever the others are.
    simpler = len(best[True][1]) + 1 < len(best[False][1])
    return best[True][1] if simpler and best[True][0] > best[False][0] else None
