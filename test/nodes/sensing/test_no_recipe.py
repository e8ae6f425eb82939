"""A picture that comes while the localizer knows of no door."""

from __future__ import annotations

import rclpy

from doormill_ros.nodes.base import topics
from doormill_ros.nodes.base.reporting_node import WARN
from doormill_ros.nodes.door_localizer import DoorLocalizer
from support.localizer_node import Localizer


class Fresh(Localizer):
    """One that was given no recipe."""

    def send(self, topic: topics.Topic, **changes: object) -> None:
        if topic is not topics.DOOR_RECIPE:
            super().send(topic, **changes)


def test_it_is_left_aside_with_a_warning(recorded: dict[str, bytes], context: rclpy.Context) -> None:
    localizer = Fresh(recorded, context)
    node: DoorLocalizer = localizer.node
    localizer.send(topics.CAMERA_INFO)
    localizer.send(topics.IMAGE)
    assert localizer.answers == []
    assert node._health[0] == WARN
    assert "a picture came while no recipe is in hand" in node._health[1]
    # The next door is found as ever.
    Localizer.send(localizer, topics.DOOR_RECIPE)
    answer = localizer.answer()
    assert (answer.run_id, answer.accepted) == (localizer.good["door/recipe"].run_id, True)
    node.close()
    node.destroy_node()
