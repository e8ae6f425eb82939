"""A hole through the door: against a board, half from each side, or refused."""

from dataclasses import replace

import numpy as np
import pytest

from doormill_ros.cell.places.backing import Board
from doormill_ros.recipes.door import Side
from doormill_ros.toolpath.air.far_side import check_far_side
from doormill_ros.toolpath.cuts.operation import operation
from doormill_ros.toolpath.errors import ToolFitError, UnbackedHoleError
from doormill_ros.toolpath.settings import load_settings
from doormill_ros.toolpath.split import split
from support.doors import door_with

DOOR = door_with("handle_hole", 2000, 800, 40)  # 22 mm, 50 mm from the lock edge, 500 mm high
(HOLE,) = DOOR.features
BOARD = Board("board", 0.018, np.array([0.010, 0.260]), np.array([0.15, 3.0]))


def look(*boards, hole=HOLE, **options):
    check_far_side([operation(hole, DOOR.size, **options)], DOOR.size, boards)


def test_a_board_round_the_hole_is_enough():
    look(BOARD)
    look(replace(BOARD, from_lock_edge=np.array([0.036, 0.064]), height=np.array([0.486, 0.514])))


@pytest.mark.parametrize(
    "change",
    [
        {"from_lock_edge": np.array([0.0365, 0.260])},
        {"from_lock_edge": np.array([0.010, 0.0635])},
        {"height": np.array([0.487, 3.0])},
        {"height": np.array([0.15, 0.513])},
        {"thickness": 0.0015},
    ],
)
def test_less_is_refused_with_figures(change):
    with pytest.raises(
        UnbackedHoleError, match=r"rear face 50 mm from the lock edge and 500 mm above"
    ) as caught:
        look(replace(BOARD, **change))
    assert caught.value.code == 340
    assert caught.value.data["feature"] == HOLE.id


def test_no_board_backs_the_front():
    rear = replace(HOLE, side=Side.REAR)
    with pytest.raises(UnbackedHoleError, match="out of the front face"):
        look(BOARD, hole=rear)
    look(hole=rear, half=True)


def test_half_a_hole_needs_no_board():
    look(half=True)
    look(half=True, far_side=True)


def test_a_cell_without_boards_mills_a_hole_with_two_robots_only(cell):
    recipe = replace(cell.recipe("standard_door"), features=(cell.recipe("standard_door").features[4],))
    T = cell.T_base_door(recipe)
    with pytest.raises(UnbackedHoleError, match=r"has no board\).*from_both_sides"):
        cell.program(recipe, T, layout=cell.layout.with_rear_free())
    first, _ = split(recipe, T, load_settings())
    assert cell.program_of(recipe, first).targets
    assert cell.program(recipe, T).targets


def test_a_left_hung_door_has_its_board_where_its_lock_edge_stands(cell):
    recipe = cell.recipe("leaf_hinge_door")
    hole = recipe.features[-1]
    assert recipe.size.head_down
    check_far_side([operation(hole, recipe.size)], recipe.size, cell.layout.boards)
    # It stands on its head: what is low on the door as it hangs is high in the clamp.
    low = replace(BOARD, height=np.array([1.05, 3.0]))
    with pytest.raises(UnbackedHoleError, match="1000 mm above the lower end"):
        check_far_side([operation(hole, recipe.size)], recipe.size, [low])


def test_the_tip_comes_out_behind_the_wood_whatever_the_tool_is_long():
    deep = [
        operation(replace(HOLE, tool=replace(HOLE.tool, cutting_length=length)), DOOR.size).depth
        for length in (0.041, 0.060)
    ]
    assert deep == pytest.approx([0.041, 0.041])


def test_a_tool_for_half_a_hole_mills_no_whole_one():
    short = replace(HOLE, tool=replace(HOLE.tool, cutting_length=0.030), from_both_sides=True)
    assert operation(short, DOOR.size, half=True).depth == pytest.approx(0.021)
    with pytest.raises(ToolFitError, match=r"cuts 30 mm deep, .* at least 41 mm; choose a longer tool"):
        operation(short, DOOR.size)
