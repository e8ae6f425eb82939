"""Whether a picture of a chessboard is of use, and if not, why."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from doormill_ros.arrays import ByteArray, FloatArray
from doormill_ros.localization.calibration.chessboard import Chessboard, find_corners

_SOFTEST = 5.0  # px in which an edge rises from 10 to 90 %
_SOFTEST_SHARE = 0.35  # the same as a share of the smallest square: the next corner begins to mix in
#: Mean distance of the corners of two pictures that show the same, as a share of the picture's width.
_ALIKE = 0.01
_AT_RIM = 1.2  # squares from the picture's rim at which a board may go on outside
_SMALLEST = (3, 3)  # inner corners of a board that is looked for when the right one is not there


@dataclass(frozen=True, eq=False)
class BoardPicture:
    """A picture and what came of it.

    Attributes:
        name: Of the file or the message.
        corners: Inner corners in the board's order, shape (n, 2) [px]; None of a picture that is of no use.
        reason: Why it is of no use; empty for one that is.
    """

    name: str
    corners: FloatArray | None
    reason: str = ""


def judge(
    picture: ByteArray, name: str, board: Chessboard, before: Sequence[BoardPicture] = ()
) -> BoardPicture:
    """Look for the board.

    Args:
        picture: Grey picture, shape (h, w), uint8.
        name: What to call it.
        board: The chessboard.
        before: Pictures that were judged already; the same view again adds nothing.
    """
    corners = find_corners(picture, board)
    if corners is None:
        return BoardPicture(name, None, _why_not_found(picture, board))
    softness = _softness(picture, corners, board)
    grid = corners.reshape(board.rows, board.columns, 2)
    side = min(float(np.linalg.norm(np.diff(grid, axis=a), axis=2).min()) for a in (0, 1))
    limit = min(_SOFTEST, _SOFTEST_SHARE * side)
    if softness > limit:
        return BoardPicture(
            name,
            None,
            f"blurred: edges rise over {softness:.1f} px, allowed are {limit:.1f} px; hold the board still, focus, or "
            "go nearer",
        )
    for other in before:
        if other.corners is not None:
            apart = min(
                float(np.mean(np.linalg.norm(other.corners - c, axis=1))) for c in (corners, corners[::-1])
            )
            if apart < _ALIKE * picture.shape[1]:
                return BoardPicture(
                    name, None, f"the same view as {other.name}, {apart:.1f} px apart; move or tilt the board"
                )
    return BoardPicture(name, corners)


def _softness(picture: ByteArray, corners: FloatArray, board: Chessboard) -> float:
    """Pixels in which edges rise from 10 to 90 %, the worse of both directions; smear goes one way only."""
    points = corners.astype(np.float32).reshape(-1, 1, 2)
    shape = (board.columns, board.rows)
    return max(
        float(cv2.estimateChessboardSharpness(picture, shape, points, 0.8, vertical)[0][0])
        for vertical in (False, True)
    )


def _why_not_found(picture: ByteArray, board: Chessboard) -> str:
    flags = cv2.CALIB_CB_NORMALIZE_IMAGE | cv2.CALIB_CB_LARGER
    found, corners, cells = cv2.findChessboardCornersSBWithMeta(picture, _SMALLEST, flags)
    if not found:
        return "no board found: none is there, or something covers it, or it is too dark, too small or too blurred"
    rows, columns = cells.shape
    found_size = f"{max(rows, columns)} x {min(rows, columns)}"
    grid = corners.reshape(rows, columns, 2)
    size = np.array(picture.shape[::-1])
    sides = [np.linalg.norm(np.diff(grid, axis=a), axis=2).max() for a in (0, 1)]
    rim = float(np.minimum(grid, size - grid).min())
    small, large = sorted((rows, columns)), sorted((board.rows, board.columns))
    wanted = f"{board.columns} x {board.rows}"
    if rim < _AT_RIM * max(sides) and small[0] <= large[0] and small[1] <= large[1]:
        return (
            f"the board is only partly seen: {found_size} of {wanted} inner corners, up to the picture's rim; "
            "bring all of it and a white margin into the picture, or give --board as printed"
        )
    return (
        f"a board of {found_size} inner corners, {wanted} are expected; give --board as printed, uncover the "
        "board, or take the other board away"
    )
