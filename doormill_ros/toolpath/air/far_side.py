"""See that a hole comes out of the door only where a board backs the wood: elsewhere the mill would tear it out."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.cell.places.backing import Board
from doormill_ros.recipes.door import DoorSize, Side
from doormill_ros.recipes.features.base import BREAKTHROUGH
from doormill_ros.toolpath.cuts.operation import Operation
from doormill_ros.toolpath.errors import UnbackedHoleError
from doormill_ros.units import m_to_mm

RIM = 0.003  #: a board reaches this far beyond the rim of a hole [m]
LEFT = 0.001  #: of a board's thickness stays behind the mill [m]


def check_far_side(operations: Sequence[Operation], size: DoorSize, boards: Sequence[Board]) -> None:
    """Refuse a hole that comes out of the door where nothing backs the wood.

    A hole that another robot mills from the far side ends in the wood and needs no board.

    Args:
        operations: What the robot mills.
        size: The door.
        boards: What backs its rear face.

    Raises:
        UnbackedHoleError: Names the hole and the boards.
    """
    extent = np.array([size.thickness, size.width, size.height])
    for item in operations:
        feature = item.feature
        if not feature.through or item.depth < size.thickness:
            continue
        _, y, z = item.T_door_feature[:3, 3]
        face = "rear" if item.side is Side.FRONT else "front"
        around = np.array([feature.shape.width, feature.shape.length]) / 2.0 + RIM
        if item.side is not Side.FRONT or not any(
            _covers(board, extent, np.array([y, z]), around) for board in boards
        ):
            found = ", ".join(_where(board) for board in boards) or "no board"
            raise UnbackedHoleError(
                f"{feature.id}: it comes out of the {face} face {m_to_mm(size.width - y):.0f} mm from the lock edge "
                f"and {m_to_mm(z):.0f} mm above the lower end of the door, where nothing backs the wood and the "
                f"mill would tear it out; allowed is a hole with {m_to_mm(RIM):.0f} mm of board round it behind the "
                f"rear face (config/cell.yaml has {found}), milled from the front: place a board there, or let a "
                "second robot mill the other half (from_both_sides)",
                feature=feature.id,
                found=(y, z),
            )


def _covers(board: Board, extent: FloatArray, centre: FloatArray, around: FloatArray) -> bool:
    box = board.box(extent)
    if box is None or board.thickness < BREAKTHROUGH + LEFT:
        return False
    low, high = box
    return bool((low[1:] <= centre - around).all() and (centre + around <= high[1:]).all())


def _where(board: Board) -> str:
    first, last = m_to_mm(board.from_lock_edge)
    low, high = m_to_mm(board.height)
    return f"{board.name}, {first:.0f} to {last:.0f} mm from the lock edge, {low:.0f} to {high:.0f} mm high"
