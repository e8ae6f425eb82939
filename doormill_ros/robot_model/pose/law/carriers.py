"""Which frames of a robot may be displaced, for one unit of it: one line a carrier."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.robot_model.law.parts import Carrier, number_of
from doormill_ros.robot_model.pose.chain import direction, joint_turn
from doormill_ros.robot_model.pose.view import SetView

#: Of a series and where: for each component the direction of a frame's twist and its size, shape (n,).
Motion = Callable[[SetView, str], list[tuple[int, FloatArray]]]


def _turn(view: SetView, where: str) -> list[tuple[int, FloatArray]]:
    return [(joint_turn(number_of(where) + 1), np.ones(len(view)))]


def _sag(view: SetView, where: str) -> list[tuple[int, FloatArray]]:
    k = number_of(where)
    return [(joint_turn(k + 1), view.gravity_moment[:, k, 2])]


def _frame(axes: Sequence[int], last: bool = False) -> Motion:
    """Along or about some axes of the frame before a joint, the base's without a joint, or of the flange."""

    def motion(view: SetView, where: str) -> list[tuple[int, FloatArray]]:
        frame = view.joints if last else max(number_of(where), 0)
        return [(direction(frame, axis), np.ones(len(view))) for axis in axes]

    return motion


_SHIFT, _TURN, _ACROSS = (0, 1, 2), (3, 4, 5), (3, 4)

#: Carriers by what they act on, as in diagnosis.json.
CARRIERS: dict[str, Carrier[Motion]] = {
    "joint angle": Carrier(_turn, "rad", 1e-5, "turns"),
    "sag": Carrier(_sag, "rad / (N m)", 1e-6, "gives way to the weight"),
    "axis": Carrier(_frame(_ACROSS), "rad", 1e-5, "tilts about x, y before it", True, 2),
    "base place": Carrier(_frame(_SHIFT), "m", 1e-5, "moves along x, y, z", False, 3),
    "base turn": Carrier(_frame(_TURN), "rad", 1e-5, "turns about x, y, z", False, 3),
    "seat": Carrier(_frame(_TURN, True), "rad", 1e-5, "turns about x, y, z of the flange", True, 3),
    "seat place": Carrier(_frame(_SHIFT, True), "m", 1e-5, "moves along x, y, z of the flange", True, 3),
}
