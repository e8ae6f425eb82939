"""Wood that the mill took outside the features, or met while it stood still."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from doormill_ros.arrays import BoolArray, FloatArray, IntArray
from doormill_ros.frames import inverse
from doormill_ros.recipes.recipe import Recipe
from doormill_ros.simulation.controller.records.executed_path import ExecutedPath
from doormill_ros.simulation.judge.bodies import JudgedCell
from doormill_ros.simulation.judge.exits import torn_out
from doormill_ros.simulation.judge.links import FLANGE
from doormill_ros.simulation.judge.mills import mill_radius, mill_there
from doormill_ros.simulation.judge.shapes import cylinder_gap
from doormill_ros.simulation.judge.sweep import LEVER, Sweep, between
from doormill_ros.simulation.judge.verdict import TornOut, Touch, WoodGone
from doormill_ros.simulation.judge.wood import Cuts, Pocket, below_surface, still_there

TOLERANCE = 0.5e-3  #: how far beside a feature wood may be gone, section 1.3 of the thesis [m]
POINTS = 4_000_000  #: points of the door looked at, which sets their distance
SPACING = (2.5e-4, 2e-3)  #: shortest and longest distance of the points about a wall or floor [m]
COARSE = 1e-3  #: shortest distance of the points about a mill that is in no feature of its own [m]
SEEN = 2e-5  #: wood that is gone beside a feature counts from here on, once more than TOLERANCE is gone [m]
THINNING = 0.125  #: way between tools that are put into the wood, in radii of the mill
#: Irrational numbers that scatter one point within each cell of the lattice, so that no wall lies along its planes.
SCATTER = np.array([[0.7548776662, 0.5698402910, 0.8191725134], [0.6710436067, 0.5497004779, 0.8566748839],
                    [0.6180339887, 0.4142135624, 0.7320508076]])  # fmt: skip


@dataclass(frozen=True, eq=False)
class _Looks:
    """The mill wherever it was in the door; m places."""

    place: FloatArray  # (m,)
    sample: IntArray  # (m,) the sample whose motion it is
    tip: FloatArray  # (m, 3) door frame
    axis: FloatArray  # (m, 3)
    radius: FloatArray  # (m,)
    turning: BoolArray  # (m,)
    excess: FloatArray  # (m,) out of the own feature; infinite without one

    def part(self, chosen: BoolArray | FloatArray) -> _Looks:
        return _Looks(*(getattr(self, name)[chosen] for name in self.__dataclass_fields__))


@dataclass(frozen=True, eq=False)
class _Met:
    """Points of the door within the mill; k points, met m times in all."""

    spacing: float  # [m]
    points: FloatArray  # (k, 3) door frame
    taker: IntArray  # (k,) number of the look that met it first
    look: IntArray  # (m,)
    point: IntArray  # (m,) number of the point that this look met


@dataclass(frozen=True, eq=False)
class MillJudgement:
    """What the mill did.

    Attributes:
        gone: Wood outside the features.
        touches: Wood that a standing mill met.
        cuts: Where it took wood of the features.
        torn: Wood that it tore out where it came through a face.
    """

    gone: tuple[WoodGone, ...]
    touches: tuple[Touch, ...]
    cuts: Cuts
    torn: tuple[TornOut, ...]


def judge_mill(
    recipe: Recipe,
    T_base_door: FloatArray,
    executed: ExecutedPath,
    sweep: Sweep,
    cell: JudgedCell,
    turning: BoolArray,
) -> MillJudgement:
    """Look at the mill all along the path.

    Args:
        recipe: What may be taken.
        T_base_door: Where the door really stood, shape (4, 4).
        executed: What was done.
        sweep: The same between its samples.
        cell: How far the mill reaches out of its spindle.
        turning: Whether the spindle turned at each sample, shape (n,).
    """
    size = np.array([recipe.thickness, recipe.width, recipe.height])
    pockets = tuple(Pocket.of(recipe, feature) for feature in recipe.features)
    T_door_base, radius = inverse(T_base_door), mill_radius(recipe, executed)
    there = mill_there(recipe, executed)

    def mill_at(place: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        T = T_door_base @ sweep.tool(place)
        return T[:, :3, 3], T[:, :3, 2], radius[np.ceil(place).astype(int)]

    def gap_at(place: FloatArray) -> FloatArray:
        tip, axis, wide = mill_at(place)
        middle = tip - size / 2.0
        gap = cylinder_gap(middle, middle - cell.nose * axis, wide, size / 2.0)
        return np.where(there[np.ceil(place).astype(int)], gap, np.inf)

    extent = float(np.linalg.norm(cell.T_flange_tool[:3, 3])) + float(radius.max())
    place = sweep.met(FLANGE, extent, gap_at, TOLERANCE).place
    tip, axis, wide = mill_at(place)
    sample = np.ceil(place).astype(int)
    excess = np.full(len(place), np.inf)
    for pocket in pockets:
        own = np.flatnonzero(executed.feature[sample] == pocket.feature)
        excess[own] = pocket.excess(tip[own], axis[own], cell.nose, wide[own])
    turns = turning[sample] & turning[place.astype(int)]
    looks = _Looks(place, sample, tip, axis, wide, turns, excess)
    feature = executed.feature[sample]
    fair = looks.turning & (excess <= TOLERANCE)
    spoilt = np.unique(feature[looks.turning & (excess > TOLERANCE) & np.isfinite(excess)])
    beside = looks.turning & np.isfinite(excess) & (excess > SEEN) & np.isin(feature, spoilt)
    right = looks.part(fair)
    torn = torn_out(right.sample, right.tip, right.axis, right.radius, size, cell.boards, executed)
    cut = looks.part(fair & ~beside)
    cut = cut.part(_thin(cut, executed))
    cuts = Cuts(cut.place, cut.tip, cut.axis, cut.radius, executed.feature[cut.sample])
    gone, touches = [], []
    for chosen, finest in ((beside, SPACING[0]), (~fair & ~beside, COARSE)):
        wrong = looks.part(chosen)
        if len(wrong.place):
            wrong = wrong.part(_thin(wrong, executed))
            more = _taken(wrong, size, pockets, cuts, executed, cell.nose, finest)
            gone += more[0]
            touches += more[1]
    gone.sort(key=lambda item: item.time)
    return MillJudgement(tuple(gone), tuple(touches), cuts, tuple(sorted(torn, key=lambda item: item.time)))


def _thin(looks: _Looks, executed: ExecutedPath) -> BoolArray:
    """Looks that say as much as all of them: THINNING apart, and both ends of every motion."""
    if len(looks.place) < 3:
        return np.ones(len(looks.place), dtype=bool)
    back = looks.tip - looks.axis * LEVER
    moved = [np.linalg.norm(np.diff(points, axis=0), axis=1) for points in (looks.tip, back)]
    way = np.concatenate([[0.0], np.cumsum(np.maximum(*moved) / (THINNING * looks.radius[1:]))])
    motion = executed.motion[looks.sample]
    other = (np.diff(motion) != 0) | (np.diff(looks.turning.astype(int)) != 0)
    kept = np.ones(len(looks.place), dtype=bool)
    kept[1:-1] = ((np.diff(np.floor(way)) > 0.0) | other)[:-1] | other[1:]
    return kept


def _taken(
    looks: _Looks,
    size: FloatArray,
    pockets: tuple[Pocket, ...],
    cuts: Cuts,
    executed: ExecutedPath,
    length: float,
    finest: float,
) -> tuple[list[WoodGone], list[Touch]]:
    """Keep those points in the mill that were wood and not the feature's, and sum up by motion.

    The points are no less than `finest` [m] apart.
    """
    by_pocket = {pocket.feature: pocket for pocket in pockets}
    met = _met(looks, size, by_pocket, executed, length, finest)
    points, taker = met.points, met.taker
    # Beside its own feature a mill is held to the outline; elsewhere it may follow what was cut as it can.
    free = np.isinf(looks.excess) | ~looks.turning
    there = still_there(pockets, cuts, points, looks.place[taker], np.where(free[taker], TOLERANCE, 0.0))
    hit = np.zeros(len(looks.place), dtype=bool)
    hit[met.look[there[met.point]]] = True
    depth = below_surface(points, looks.axis[taker], size)
    gone, touches = [], []
    motion = executed.motion[looks.sample]
    for number in dict.fromkeys(motion[hit].tolist()):
        for turning in (True, False):
            mine = (motion == number) & (looks.turning == turning)
            chosen = np.flatnonzero(there & mine[taker])
            if not len(chosen):
                continue
            at = looks.sample[taker[chosen].min()]
            own = by_pocket.get(str(executed.feature[at]))
            deep = depth[chosen]
            if own is not None and turning:
                deep = np.minimum(deep, own.outside(points[chosen]))
                # The points lie less deep than the wood's rim, by no more than their distance.
                most = min(looks.excess[mine & hit].max(), deep.max() + np.sqrt(3.0) * met.spacing)
            else:
                most = deep.max()
            if most <= TOLERANCE:
                continue
            common = {
                "motion": int(number) + 1,
                "feature": str(executed.feature[at]),
                "time": float(executed.time[at]),
                "depth": float(most),
                "place": points[chosen[deep.argmax()]],
                "samples": frozenset(between(looks.place, mine & hit)),
            }
            if turning:
                gone.append(WoodGone(volume=len(chosen) * met.spacing**3, **common))
            else:
                touches.append(Touch(body="standing mill", obstacle="door", **common))
    return gone, touches


def _met(
    looks: _Looks,
    size: FloatArray,
    by_pocket: Mapping[str, Pocket],
    executed: ExecutedPath,
    length: float,
    finest: float,
) -> _Met:
    """Fill the mill with points of the door, but for those of the feature in which it turns."""
    back = looks.tip - length * looks.axis
    rim = looks.radius[:, None] * np.sqrt(np.maximum(1.0 - looks.axis**2, 0.0))
    low = np.maximum(np.minimum(looks.tip, back) - rim, 0.0)
    high = np.minimum(np.maximum(looks.tip, back) + rim, size)
    volume = np.prod(np.maximum(high - low, 0.0), axis=1).sum()
    spacing = float(np.clip(np.cbrt(volume / POINTS), finest, SPACING[1]))
    cells = np.ceil(size / spacing).astype(int) + 1
    keys, who = [], []
    for i in range(len(looks.place)):
        index = _lattice(low[i], high[i], spacing)
        points = _scattered(index, spacing)
        way = points - looks.tip[i]
        along = way @ looks.axis[i]
        inside = (along <= 0.0) & (along >= -length)
        inside &= np.einsum("ki,ki->k", way, way) - along**2 <= looks.radius[i] ** 2
        inside &= np.all((points >= 0.0) & (points <= size), axis=1)
        own = by_pocket.get(str(executed.feature[looks.sample[i]]))
        index, points = index[inside], points[inside]
        if own is not None and looks.turning[i]:
            index = index[own.outside(points) > 0.0]
        keys.append(np.ravel_multi_index(tuple(index.T), tuple(cells)))
        who.append(np.full(len(index), i))
    key, first, back_to = np.unique(np.concatenate(keys), return_index=True, return_inverse=True)
    look = np.concatenate(who)
    points = _scattered(np.stack(np.unravel_index(key, tuple(cells)), axis=1), spacing)
    return _Met(spacing, points, look[first], look, back_to)


def _lattice(low: FloatArray, high: FloatArray, spacing: float) -> IntArray:
    """Numbers of all cells that a box meets, shape (k, 3), int."""
    ranges = [np.arange(int(a / spacing), int(b / spacing) + 1) for a, b in zip(low, high, strict=True)]
    return np.stack(np.meshgrid(*ranges, indexing="ij"), axis=-1).reshape(-1, 3)


def _scattered(index: IntArray, spacing: float) -> FloatArray:
    """The one point of each cell (k, 3), shape (k, 3) [m]."""
    points: FloatArray = (index + (index @ SCATTER) % 1.0) * spacing
    return points
