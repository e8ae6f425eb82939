"""Judge a run: sweep mill, spindle and arm of all executed samples against door and cell.

This is no planner's check: it knows the recipe, the shapes of robot and cell and the executed samples, and
nothing of how the motions were made.
"""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import BoolArray, FloatArray
from doormill_ros.frames import inverse
from doormill_ros.recipes.recipe import Recipe
from doormill_ros.simulation.controller.records.executed_path import ExecutedPath
from doormill_ros.simulation.judge.bodies import Body, Box, JudgedCell
from doormill_ros.simulation.judge.links import BASE, FLANGE
from doormill_ros.simulation.judge.manner import bad_cuts
from doormill_ros.simulation.judge.mill import TOLERANCE, judge_mill
from doormill_ros.simulation.judge.mills import mill_radius, mill_there
from doormill_ros.simulation.judge.rack import first_tool, in_rack
from doormill_ros.simulation.judge.shapes import cylinder_gap
from doormill_ros.simulation.judge.sweep import Meeting, Sweep
from doormill_ros.simulation.judge.verdict import Touch, Verdict
from doormill_ros.simulation.judge.wood import Cuts, Pocket, still_there

FILL = 12  #: points along each edge of what a body shares with the door
DOOR, MILL = "door", "mill"


def judge(
    recipe: Recipe,
    T_base_door_true: FloatArray,
    executed: ExecutedPath,
    cell: JudgedCell,
    turning: BoolArray | None = None,
) -> Verdict:
    """What a run touched beside the wood to be cut.

    Args:
        recipe: The door and its features.
        T_base_door_true: Where the door really stood, shape (4, 4).
        executed: Everything the robot did from its first motion to its last.
        cell: Robot, spindle and obstacles.
        turning: Whether the spindle turned at each sample, shape (n,); None where nobody knows: it did.
    """
    turns = np.ones(len(executed), dtype=bool) if turning is None else np.asarray(turning)
    sweep = Sweep.of(cell.links, executed, cell.T_flange_tool)
    mill = judge_mill(recipe, T_base_door_true, executed, sweep, cell, turns)
    touches = list(mill.touches)
    size = np.array([recipe.thickness, recipe.width, recipe.height])
    T_base_box = T_base_door_true.copy()
    T_base_box[:3, 3] += T_base_door_true[:3, :3] @ (size / 2.0)
    door = Box(DOOR, BASE, T_base_box, size / 2.0)
    pockets = tuple(Pocket.of(recipe, feature) for feature in recipe.features)
    T_door_base = inverse(T_base_door_true)
    placed = [(board.name, board.box(size)) for board in cell.boards]
    boards = [Box(name, BASE, T_base_door_true @ box[0], box[1]) for name, box in placed if box is not None]
    for body in cell.bodies:
        for obstacle in (door, *cell.obstacles, *boards):
            met = _meeting(sweep, body, obstacle)
            if obstacle is door and len(met.place):
                met = _in_wood(met, sweep, body, T_door_base, size, pockets, mill.cuts)
            touches += _by_motion(
                met, body, obstacle, executed, T_door_base @ sweep.link(body.link, met.place)
            )
    for obstacle in cell.obstacles:
        met = _mill_meeting(recipe, executed, sweep, cell, obstacle)
        touches += _mill_touches(met, obstacle, executed, sweep, T_door_base)
    for board in boards:
        met = _mill_meeting(recipe, executed, sweep, cell, board)
        met = _beside_features(met, recipe, executed, sweep, cell, T_door_base, pockets)
        touches += _mill_touches(met, board, executed, sweep, T_door_base)
    touches += _at_rack(recipe, executed, sweep, cell, T_door_base)
    bad = bad_cuts(recipe, T_base_door_true, executed)
    touches.sort(key=lambda touch: (touch.time, touch.body, touch.obstacle))
    return Verdict(len(executed), tuple(touches), mill.gone, mill.torn, tuple(bad))


def _meeting(sweep: Sweep, body: Body, obstacle: Box) -> Meeting:
    T_box_base = inverse(obstacle.at)
    return sweep.met(
        body.link,
        body.extent,
        lambda place: body.gap(T_box_base @ sweep.link(body.link, place), obstacle.half),
    )


def _in_wood(
    met: Meeting,
    sweep: Sweep,
    body: Body,
    T_door_base: FloatArray,
    size: FloatArray,
    pockets: tuple[Pocket, ...],
    cuts: Cuts,
) -> Meeting:
    """Leave out the places at which all that a body shares with the door was already milled away."""
    T_door_link = T_door_base @ sweep.link(body.link, met.place)
    low, high = body.reaches(T_door_link)
    low, high = np.maximum(low, 0.0), np.minimum(high, size)
    kept = np.ones(len(met.place), dtype=bool)
    small = np.zeros(len(met.place), dtype=bool)
    for pocket in pockets:
        small |= np.all((low >= pocket.low) & (high <= pocket.high), axis=1)
    for i in np.flatnonzero(small):
        edges = np.linspace(low[i], high[i], FILL, axis=-1)
        points = np.stack(np.meshgrid(*edges, indexing="ij"), axis=-1).reshape(-1, 3)
        in_link = (points - T_door_link[i, :3, 3]) @ T_door_link[i, :3, :3]
        points = points[body.holds(in_link)]
        when, beside = np.full(len(points), met.place[i]), np.full(len(points), TOLERANCE)
        kept[i] = still_there(pockets, cuts, points, when, beside).any()
    return met.only(kept)


def _by_motion(
    met: Meeting, body: Body, obstacle: Box, executed: ExecutedPath, T_door_link: FloatArray
) -> list[Touch]:
    """One touch for each motion in which a body met an obstacle."""
    middle = body.at[:3, 3] if isinstance(body, Box) else 0.5 * (body.start + body.end)
    where = T_door_link[:, :3, :3] @ middle + T_door_link[:, :3, 3]
    return _touches(met, body.name, obstacle.name, executed, where)


def _mill_meeting(
    recipe: Recipe, executed: ExecutedPath, sweep: Sweep, cell: JudgedCell, obstacle: Box
) -> Meeting:
    """The mill, while one is in the spindle, against what is not of the door."""
    radius, there = mill_radius(recipe, executed), mill_there(recipe, executed)
    T_box_base = inverse(obstacle.at)

    def gap_at(place: FloatArray) -> FloatArray:
        T = T_box_base @ sweep.tool(place)
        tip, back = T[:, :3, 3], T[:, :3, 3] - cell.nose * T[:, :3, 2]
        return cylinder_gap(tip, back, radius[np.ceil(place).astype(int)], obstacle.half)

    extent = float(np.linalg.norm(cell.T_flange_tool[:3, 3])) + float(radius.max())
    met = sweep.met(FLANGE, extent, gap_at)
    return met.only(there[np.ceil(met.place).astype(int)])


def _beside_features(
    met: Meeting,
    recipe: Recipe,
    executed: ExecutedPath,
    sweep: Sweep,
    cell: JudgedCell,
    T_door_base: FloatArray,
    pockets: tuple[Pocket, ...],
) -> Meeting:
    """Of a board the mill may take what lies behind the feature at hand."""
    if not len(met.place):
        return met
    T, sample = T_door_base @ sweep.tool(met.place), np.ceil(met.place).astype(int)
    radius = mill_radius(recipe, executed)
    kept = np.ones(len(sample), dtype=bool)
    for pocket in pockets:
        own = np.flatnonzero(executed.feature[sample] == pocket.feature)
        beside = pocket.excess(T[own, :3, 3], T[own, :3, 2], cell.nose, radius[sample[own]])
        kept[own] = beside > TOLERANCE
    return met.only(kept)


def _mill_touches(
    met: Meeting, obstacle: Box, executed: ExecutedPath, sweep: Sweep, T_door_base: FloatArray
) -> list[Touch]:
    return _touches(met, MILL, obstacle.name, executed, (T_door_base @ sweep.tool(met.place))[:, :3, 3])


def _at_rack(
    recipe: Recipe, executed: ExecutedPath, sweep: Sweep, cell: JudgedCell, T_door_base: FloatArray
) -> list[Touch]:
    """All of the robot against holders and tools that wait, but for what a change of tools needs."""
    touches, first = [], first_tool(cell)
    for item in in_rack(cell, recipe):
        for body in cell.bodies:
            met = item.in_the_way(_meeting(sweep, body, item.box), sweep, executed, first, body.link)
            where = T_door_base @ sweep.link(body.link, met.place)
            touches += _by_motion(met, body, item.box, executed, where)
        met = _mill_meeting(recipe, executed, sweep, cell, item.box)
        met = item.in_the_way(met, sweep, executed, first, FLANGE)
        touches += _mill_touches(met, item.box, executed, sweep, T_door_base)
    return touches


def _touches(
    met: Meeting, body: str, obstacle: str, executed: ExecutedPath, where: FloatArray
) -> list[Touch]:
    sample = np.ceil(met.place).astype(int)
    motion = executed.motion[sample]
    found = []
    for number in dict.fromkeys(motion.tolist()):
        mine = np.flatnonzero(motion == number)
        worst = mine[met.depth[mine].argmax()]
        first, last = sample[mine[0]], sample[mine[-1]]
        found.append(
            Touch(
                body=body,
                obstacle=obstacle,
                motion=int(number) + 1,
                feature=str(executed.feature[first]),
                time=float(executed.time[first]),
                depth=float(met.depth[worst]),
                place=where[worst],
                samples=frozenset(
                    s for s in met.samples if first - 1 <= s <= last and executed.motion[s] == number
                )
                or frozenset({int(first)}),
            )
        )
    return found
