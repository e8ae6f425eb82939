"""Where the mill leaves the door through a face: torn out, unless a board or an earlier cut from that face kept it."""

import dataclasses

import numpy as np
import pytest

from doormill_ros.abb.target_file.target_file import render_target_file
from doormill_ros.frames import transform
from doormill_ros.pipeline.plan import load_setup, plan
from doormill_ros.recipes.documents import shipped_recipes
from doormill_ros.recipes.door import R_DOOR_FEATURE, Side
from doormill_ros.resources import resource
from doormill_ros.simulation.errors import BodiesError, BodyTouched, WoodTornOut
from doormill_ros.simulation.judge.boards import SolidBoard
from doormill_ros.simulation.judge.bodies import load_cell
from doormill_ros.simulation.judge.exits import torn_out
from doormill_ros.simulation.judge.judge import judge
from support import doors
from support.file_run import run_file
from support.flights import flight, straight
from support.judged_doors import RUN_ID, rigid

FRONT, REAR = R_DOOR_FEATURE[Side.FRONT], R_DOOR_FEATURE[Side.REAR]
FAR = transform(translation=[1.6, 0.0, 0.0])
WITH_HOLES = {name: r for name, r in shipped_recipes().items() if any(f.through for f in r.features)}
DOOR = doors.door_with("handle_hole", 2000, 800, 40, centre_cutting=True)
HOLE = DOOR.features[0]
Y, Z = 0.75, HOLE.height
BOARD = SolidBoard("board", 0.018, np.array([0.010, 0.200]), np.array([0.4, 0.6]))
CELL = dataclasses.replace(load_cell(), obstacles=(), boards=())


def round_the_hole(tip, front, z=Z):
    """In at x `front`, round the hole with the tip at x `tip`, and out again."""
    ring = HOLE.outline(inset=HOLE.tool.radius).points(step=5e-4)
    ring = np.concatenate([ring, ring[:1]])
    rim = np.column_stack([np.full(len(ring), tip), Y + ring[:, 0], z + ring[:, 1]])
    at = [front, *rim[0, 1:]]
    return np.concatenate([straight(at, rim[0]), rim, straight(rim[-1], at)])


def milled(*boards, tip=0.041, feature=HOLE.id):
    run = flight(FAR, round_the_hole(tip, -0.02), FRONT, feature)
    return judge(DOOR, FAR, run, dataclasses.replace(CELL, boards=boards))


@pytest.mark.parametrize("name", WITH_HOLES)
def test_a_shipped_hole_in_one_go_is_torn_where_nothing_backs_it(name):
    recipe, setup, cell = WITH_HOLES[name], rigid(load_setup()), load_cell()
    T_base_door = setup.layout.T_base_door(recipe.width, recipe.thickness)
    text = render_target_file(plan(recipe, T_base_door, setup).program, RUN_ID).decode("ascii")
    executed, turned = run_file(text)
    verdict = judge(recipe, T_base_door, executed, dataclasses.replace(cell, boards=()), turned)
    assert isinstance(verdict.error, WoodTornOut)
    assert (verdict.touches, verdict.gone) == ((), ())
    for feature in recipe.features:
        torn = sum(t.area for t in verdict.torn if t.feature == feature.id)
        hole = np.pi / 4.0 * feature.shape.width**2 if feature.through else 0.0
        assert torn == pytest.approx(hole, rel=0.03)
    assert judge(recipe, T_base_door, executed, cell, turned).error is None


@pytest.mark.parametrize("name", WITH_HOLES)
def test_two_robots_tear_nothing_out_without_a_board(name):
    recipe, setup = WITH_HOLES[name], rigid(load_setup())
    assert all(f.from_both_sides for f in recipe.features if f.through)
    setup = setup.of("first")
    T_base_door = setup.layout.T_base_door(recipe.width, recipe.thickness)
    text = render_target_file(plan(recipe, T_base_door, setup).program, RUN_ID).decode("ascii")
    executed, turned = run_file(text)
    holes = {f.id for f in recipe.features if f.through}
    assert holes <= set(executed.feature)
    verdict = judge(recipe, T_base_door, executed, dataclasses.replace(load_cell(), boards=()), turned)
    assert verdict.error is None, verdict.sentence


def test_the_sentence_says_face_place_and_cure():
    verdict = milled()
    assert isinstance(verdict.error, WoodTornOut)
    (torn,) = verdict.torn
    assert (torn.face, torn.feature, torn.motion) == ("rear face", HOLE.id, 1)
    assert torn.area == pytest.approx(np.pi * 0.011**2, rel=0.03)
    assert torn.depth == pytest.approx(0.001, abs=1e-4)
    assert "mm^2 of wood out of the rear face" in verdict.sentence
    assert "place one, or mill from both sides" in verdict.sentence


def test_a_tip_that_stays_in_the_wood_tears_nothing():
    assert milled(tip=0.039).error is None
    assert milled(tip=0.0402).error is not None


@pytest.mark.parametrize(
    ("change", "kept"),
    [
        ({}, True),
        ({"from_lock_edge": np.array([0.045, 0.200])}, False),  # begins within the hole
        ({"from_lock_edge": np.array([0.038, 0.0615])}, False),  # ends at its rim
        ({"height": np.array([0.6, 0.9])}, False),
        ({"thickness": 0.0005}, False),  # milled through
    ],
)
def test_only_a_board_behind_the_whole_hole_keeps_the_wood(change, kept):
    verdict = milled(dataclasses.replace(BOARD, **change))
    assert (not verdict.torn) == kept


def test_a_board_is_a_body_like_others_beside_the_hole():
    assert milled(BOARD).error is None
    assert isinstance(milled(BOARD, feature="").error, BodyTouched)  # between features
    tips = straight([0.02, 0.9, Z], [0.05, 0.9, Z])
    assert (
        judge(DOOR, FAR, flight(FAR, tips, FRONT), dataclasses.replace(CELL, boards=(BOARD,))).error is None
    )
    behind = straight([0.05, 0.9, Z], [0.05, 0.7, Z])  # along behind the door, into the side of the board
    verdict = judge(
        DOOR,
        FAR,
        flight(FAR, behind, FRONT @ np.diag([1, -1, -1])),
        dataclasses.replace(CELL, boards=(BOARD,)),
    )
    assert "board" in {touch.obstacle for touch in verdict.touches}


def test_a_face_that_was_cut_from_its_own_side_is_not_torn():
    """Half from the rear, then through from the front: at the rear face nothing is left to be torn."""
    rear, front = round_the_hole(0.025, 0.06), round_the_hole(0.041, -0.02)
    size = np.array([DOOR.thickness, DOOR.width, DOOR.height])

    def torn(*ways):
        tips = np.concatenate([way for way, _ in ways])
        axes = np.concatenate([np.tile(into, (len(way), 1)) for way, into in ways])
        run = flight(FAR, tips, FRONT, HOLE.id)
        radius = np.full(len(tips), HOLE.tool.radius)
        return torn_out(np.arange(len(tips)), tips, axes, radius, size, (), run)

    assert torn((rear, REAR[:, 2]), (front, FRONT[:, 2])) == []
    (found,) = torn((front, FRONT[:, 2]), (rear, REAR[:, 2]))
    assert found.face == "rear face"


def test_boards_are_read_from_the_cell(tmp_path):
    (board,) = load_cell().boards
    assert board.thickness == 0.018
    assert board.box(np.array([0.04, 0.19, 2.0]))[1] == pytest.approx([0.009, 0.09, 0.925])
    assert board.box(np.array([0.04, 0.19, 0.1])) is None
    path = tmp_path / "cell.yaml"
    path.write_text(resource("config/cell.yaml").read_text().replace("thickness: 0.018", "thickness: -1.0"))
    with pytest.raises(BodiesError, match="thickness"):
        load_cell(cell=path)
