"""Wood torn out where the mill leaves the door through a face.

Fibres at a face give way outwards when the edge that cuts them comes from inside and nothing stands behind them.
So for each piece of a face counts what took it first: a mill that went in there cut it against the wood, one that
came out tore it, unless a board was pressed on.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from doormill_ros.arrays import BoolArray, FloatArray, IntArray
from doormill_ros.simulation.controller.records.executed_path import ExecutedPath
from doormill_ros.simulation.judge.boards import SolidBoard
from doormill_ros.simulation.judge.verdict import TornOut

GRID = 5e-4  #: distance of the points looked at in a face [m]
LEAST = 1e-6  #: torn wood that counts [m^2]
OUT = 2e-5  #: how far behind a face a tip has come out of it [m]
ALONG = 0.5  #: cosine between tool and face normal above which it goes through the face
FACES = {
    (0, 1): "rear face",
    (0, -1): "front face",
    (1, 1): "lock edge",
    (1, -1): "hinge edge",
    (2, 1): "top edge",
    (2, -1): "bottom edge",
}


def torn_out(
    sample: IntArray,
    tip: FloatArray,
    axis: FloatArray,
    radius: FloatArray,
    size: FloatArray,
    boards: Sequence[SolidBoard],
    executed: ExecutedPath,
) -> list[TornOut]:
    """What the mill tore, by motion and face.

    Args:
        sample: Samples at which the turning mill was in the wood of its own feature, in order, shape (m,).
        tip: Its tip, door frame, shape (m, 3) [m].
        axis: Its direction, door frame, shape (m, 3).
        radius: Its radius, shape (m,) [m].
        size: Extents of the door, shape (3,) [m].
        boards: What is pressed against the rear face.
        executed: What was done.
    """
    torn = []
    for (normal, sign), name in FACES.items():
        face = size[normal] if sign > 0 else 0.0
        beyond, toward = sign * (tip[:, normal] - face), sign * axis[:, normal]
        out = np.flatnonzero((toward > ALONG) & (beyond > OUT))
        if not len(out):
            continue
        flat = [k for k in range(3) if k != normal]
        moved = (face - tip[:, normal]) / np.where(np.abs(toward) > ALONG, axis[:, normal], 1.0)
        centre = (tip + moved[:, None] * axis)[:, flat]
        points, taker = _first_taken(centre[out], radius[out], size[flat])
        inward = np.flatnonzero((toward < -ALONG) & (beyond < -OUT))
        kept = ~_cut_before(points, out[taker], centre, radius, inward)
        points, taker = points[kept], out[taker[kept]]
        held = np.zeros(len(tip), dtype=bool)
        if (normal, sign) == (0, 1):
            for board in boards:
                held |= board.backs(centre, radius, beyond, size)
        points, taker = points[~held[taker]], taker[~held[taker]]
        motion = executed.motion[sample[taker]]
        for number in dict.fromkeys(motion.tolist()):
            mine = np.flatnonzero(motion == number)
            area = len(mine) * GRID**2
            if area < LEAST:
                continue
            first = sample[taker[mine].min()]
            worst = taker[mine[beyond[taker[mine]].argmax()]]
            place = np.zeros(3)
            place[normal], place[flat] = face, points[mine[0]]
            torn.append(
                TornOut(
                    motion=int(number) + 1,
                    feature=str(executed.feature[first]),
                    time=float(executed.time[first]),
                    depth=float(beyond[worst]),
                    place=place,
                    samples=frozenset(np.unique(sample[taker[mine]]).tolist()),
                    face=name,
                    area=area,
                )
            )
    return torn


def _first_taken(centre: FloatArray, radius: FloatArray, extent: FloatArray) -> tuple[FloatArray, IntArray]:
    """Points of a face that discs cover, shape (k, 2) [m], and the first disc that does, shape (k,)."""
    cells = np.ceil(extent / GRID).astype(int) + 1
    keys, who = [], []
    seen = -np.ones(2)
    for i in range(len(centre)):
        if np.linalg.norm(centre[i] - seen) < 0.1 * GRID:
            continue  # the same disc as before
        seen = centre[i]
        low, high = (centre[i] - radius[i]) / GRID, (centre[i] + radius[i]) / GRID
        ranges = [
            np.arange(max(0, int(np.ceil(a))), min(int(b), n - 1) + 1)
            for a, b, n in zip(low, high, cells, strict=True)
        ]
        index = np.stack(np.meshgrid(*ranges, indexing="ij"), axis=-1).reshape(-1, 2)
        index = index[np.linalg.norm(index * GRID - centre[i], axis=1) < radius[i]]
        keys.append(np.ravel_multi_index(tuple(index.T), tuple(cells)))
        who.append(np.full(len(index), i))
    key, first = np.unique(np.concatenate(keys), return_index=True)
    points: FloatArray = np.stack(np.unravel_index(key, tuple(cells)), axis=1).astype(np.float64) * GRID
    taker: IntArray = np.concatenate(who)[first]
    return points, taker


def _cut_before(
    points: FloatArray, when: IntArray, centre: FloatArray, radius: FloatArray, inward: IntArray
) -> BoolArray:
    """Which points a mill that went in through the face had taken before, shape (k,)."""
    taken = np.zeros(len(points), dtype=bool)
    if not len(points):
        return taken
    low, high = points.min(axis=0) - radius.max(), points.max(axis=0) + radius.max()
    near = inward[np.all((centre[inward] >= low) & (centre[inward] <= high), axis=1)]
    for i in near:
        taken |= (when > i) & (np.linalg.norm(points - centre[i], axis=1) < radius[i])
    return taken
