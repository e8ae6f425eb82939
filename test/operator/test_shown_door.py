"""The last picture says whose door it is, whatever door is in hand by then."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from sensor_msgs.msg import Image
from std_msgs.msg import Header

from doormill_interfaces.msg import DoorLocalization
from doormill_ros.nodes.convert.picture import picture_message
from doormill_ros.nodes.operator_page import OperatorPage
from doormill_ros.operator.views.shown_door import KEPT, ShownDoors
from doormill_ros.operator.views.view_store import ViewStore


@pytest.mark.parametrize("told_first", [True, False])
def test_picture_and_door_find_each_other_in_any_order(told_first: bool) -> None:
    shown: ShownDoors[str] = ShownDoors()
    if told_first:
        assert shown.of_door(5, "oak") is None
        assert shown.of_picture(6, "another") is None
        assert shown.of_picture(5, "picture") == "oak"
    else:
        assert shown.of_picture(5, "picture") is None
        assert shown.of_door(6, "elm") is None
        assert shown.of_door(5, "oak") == "picture"


def test_what_nobody_joins_is_forgotten() -> None:
    shown: ShownDoors[bytes] = ShownDoors()
    for stamp in range(KEPT + 1):
        assert shown.of_picture(stamp, b"picture") is None
    assert shown.of_door(0, "oak") is None
    assert shown.of_door(KEPT, "oak") == b"picture"


@pytest.mark.parametrize("picture_first", [True, False])
@pytest.mark.parametrize("accepted", [True, False])
def test_a_late_picture_is_not_of_the_door_in_hand(picture_first: bool, accepted: bool) -> None:
    # Without a node round it: only what it does with the two messages.
    page: Any = OperatorPage.__new__(OperatorPage)
    page.store, page._shown, page._pictures = ViewStore(), ShownDoors(), ()
    page.store.update(lambda view: view.with_run("r2", "elm"))
    header = Header()
    header.stamp.sec = 1_800_000_000
    overlay: Image = picture_message(np.zeros((8, 12, 3), np.uint8), header)
    found = DoorLocalization(header=header, run_id="r1", door_id="oak", accepted=accepted)
    steps: list[Callable[[], None]] = [
        lambda: page._take_localization(found),
        lambda: page._take_overlay(overlay),
    ]
    for step in steps[::-1] if picture_first else steps:
        step()
    assert page.store.view.picture is not None
    assert page.store.view.picture.caption.startswith("Door oak: picture of ")
