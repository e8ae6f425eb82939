"""Doors of the thesis' ranges, planned, run and judged; planner and target file are taken as they come."""

import time
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from hypothesis import HealthCheck, Phase, given, seed, settings

from doormill_ros.abb.target_file.target_file import render_target_file
from doormill_ros.cell.places.layout import DoorOffset, load_layout
from doormill_ros.errors import DoormillError
from doormill_ros.frames import inverse
from doormill_ros.pipeline.plan import MillingSetup, load_setup, plan
from doormill_ros.recipes.features.base import Feature
from doormill_ros.recipes.recipe import Recipe
from doormill_ros.robot_model.extended_model import ExtendedComplianceModel
from doormill_ros.simulation.judge.boards import RIM
from doormill_ros.simulation.judge.bodies import Box, JudgedCell, load_cell
from doormill_ros.simulation.judge.judge import judge
from doormill_ros.simulation.judge.pair import standing
from doormill_ros.simulation.judge.verdict import Verdict
from doormill_ros.toolpath.errors import UnbackedHoleError
from doormill_ros.toolpath.settings import load_settings
from support import doors
from support.file_run import HOME, run_file
from support.way_search import WaySearch, seen_from

RUN_ID = "20260101T000000000000Z"
#: Region of operation of the thesis: widths and heights that the cell shall mill [m].
WIDEST, NARROWEST, TALLEST = 1.350, 0.290, 2.700
#: What `search` says where a refusal is right: no posture at all, or no wood that holds.
CONFIRMED = ("no posture", "nothing behind it")
BACKED = 3e-3  #: board round a hole that comes out against it, by docs/toolpath.md [m]
WIDEST_MILL = 0.02  #: radius of the widest mill that a waiting robot may hold [m]


@dataclass(frozen=True)
class Outcome:
    """How one door came out: a refusal, or the judge's verdict on its motions."""

    recipe: Recipe
    offset: DoorOffset
    refusal: DoormillError | None = None
    verdict: Verdict | None = None
    planning: float = 0.0
    judging: float = 0.0
    robot: str = "first"
    robots: int = 1


def draw(count: int, number: int) -> list[tuple[Recipe, DoorOffset]]:
    """Doors of the thesis' ranges with any features in any place.

    The same for the same number in the same program: hypothesis also draws constants of the modules loaded so far.
    """
    drawn: dict[str, tuple[Recipe, DoorOffset]] = {}

    @seed(number)
    @settings(
        max_examples=2 * count,
        deadline=None,
        database=None,
        phases=[Phase.generate],
        suppress_health_check=list(HealthCheck),
    )
    @given(
        doors.doors().filter(
            lambda door: (
                door[0]["width_mm"] >= 1e3 * NARROWEST
                and door[0]["width_mm"] <= 1e3 * WIDEST
                and door[0]["height_mm"] <= 1e3 * TALLEST
            )
        )
    )
    def take(door):
        document, (y, z, rotation) = door
        drawn[repr(door)] = (Recipe.from_document(document), DoorOffset(y, z, rotation))

    take()  # hypothesis draws some doors twice
    return list(drawn.values())[:count]


def rigid(setup: MillingSetup) -> MillingSetup:
    """The setup of a robot that does not give way: `run_file` runs one, and a correction would be its error."""
    robot = setup.robot
    stiff = ExtendedComplianceModel(robot.name, robot.dh, 1e9 * robot.stiffness, ())
    return replace(setup, model=stiff)


def judge_door(
    recipe: Recipe, T_cell_door: np.ndarray, offset: DoorOffset, setup: MillingSetup, cell: JudgedCell
) -> Outcome:
    """Plan, run and judge one door, or one robot's share of it."""
    name, T_base_door = setup.share or "first", setup.shared(recipe, T_cell_door).T_base_door
    begun = time.perf_counter()
    try:
        program = plan(recipe, T_cell_door, setup).program
        text = render_target_file(program, RUN_ID).decode("ascii")
    except DoormillError as refusal:
        return Outcome(
            recipe,
            offset,
            refusal,
            planning=time.perf_counter() - begun,
            robot=name,
            robots=2 if setup.share else 1,
        )
    planned = time.perf_counter()
    executed, turned = run_file(text, setup.robot.name)
    run = time.perf_counter()
    verdict = judge(recipe, T_base_door, executed, cell, turned)
    return Outcome(
        recipe,
        offset,
        None,
        verdict,
        planned - begun,
        time.perf_counter() - run,
        name,
        2 if setup.share else 1,
    )


def judge_doors(count: int, number: int, tools: int | None = None, robots: int = 1) -> Iterator[Outcome]:
    """Outcomes of drawn doors.

    Args:
        count: How many doors.
        number: Seed.
        tools: For a cell that has more than the usual number of them at hand.
        robots: 2 for a share of each door to either robot, one outcome a share; each is judged beside the other
            one as it waits at home.
    """
    setup, cell = rigid(load_setup()), load_cell()
    if tools is not None:
        checks = replace(setup.settings.checks, tools=tools)
        setup = replace(setup, settings=replace(setup.settings, checks=checks))
    T_first_second = setup.settings.second_robot.T_base_second
    bare = cell.of_two(T_first_second)
    setups = {"first": setup} if robots == 1 else {name: setup.of(name) for name in ("first", "second")}
    cells = {"first": cell}
    if robots > 1:
        home = np.radians(HOME)
        cells = {
            "first": _beside(bare, standing(bare, home, T_first_second, "second", WIDEST_MILL)),
            "second": _beside(
                seen_from(bare, T_first_second),
                standing(bare, home, inverse(T_first_second), "first", WIDEST_MILL),
            ),
        }
    for recipe, offset in draw(count, number):
        T_cell_door = setup.layout.T_base_door(recipe.width, recipe.thickness, offset)
        for name, own in setups.items():
            if own.shared(recipe, T_cell_door).operations:
                yield judge_door(recipe, T_cell_door, offset, own, cells[name])


def _beside(cell: JudgedCell, boxes: list[Box]) -> JudgedCell:
    return replace(cell, obstacles=(*cell.obstacles, *boxes))


def search(outcome: Outcome, tries: int = 100) -> str:
    """What an independent look says of a refused feature: "way", "posture", "no posture", or that none was named.

    Of a hole without a board it tells whether the judge knows of one.
    Of a way that is refused it asks for the feature where it begins, too.
    """
    named = outcome.refusal.data.get("feature") if outcome.refusal is not None else None
    ids = [feature.id for feature in outcome.recipe.features]
    if named not in ids:
        return "no feature named"
    at = ids.index(named)
    if isinstance(outcome.refusal, UnbackedHoleError):
        return _behind(outcome, outcome.recipe.features[at])
    before = outcome.refusal is not None and outcome.refusal.message.startswith("the way to") and at > 0
    features = outcome.recipe.features[at - before : at + 1]
    recipe = outcome.recipe
    T_base_door = load_layout().T_base_door(recipe.width, recipe.thickness, outcome.offset)
    T_cell_robot = np.eye(4)
    if outcome.robot == "second":
        T_cell_robot = load_settings().second_robot.T_base_second
        T_base_door = inverse(T_cell_robot) @ T_base_door
    asked = WaySearch(recipe, T_base_door, T_cell_robot=T_cell_robot)
    found = [asked.serves(feature, tries=tries).split(":")[0] for feature in features]
    return min(found, key=("no posture", "posture", "way").index)


def _behind(outcome: Outcome, feature: Feature) -> str:
    """Whether a hole that one mill cuts from one side comes out where the judge knows of no board."""
    recipe = outcome.recipe
    if not feature.through or (outcome.robots > 1 and feature.from_both_sides):
        return "wrong: no hole that one mill takes through the door"
    size = np.array([recipe.thickness, recipe.width, recipe.height])
    T = recipe.T_door_feature(feature)
    out = T[:3, 3] + T[:3, 2] * feature.cut_depth(recipe.size)
    boards = () if outcome.robots > 1 or T[0, 2] < 0.0 else load_cell().boards
    rim = (feature.outline().points(step=1e-3) @ T[:3, :2].T + out)[:, 1:]
    beyond, more = np.zeros(len(rim)), np.full(len(rim), BACKED - RIM)
    held = [board.backs(rim, more, beyond, size).all() for board in boards]
    return "wrong: a board backs it" if any(held) else "nothing behind it"
