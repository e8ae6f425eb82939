"""The judge of doors that two robots share, where one of them has nothing to mill."""

from __future__ import annotations

from typing import Any

import pytest
import rclpy
from rclpy.serialization import deserialize_message

from doormill_ros.cell.graph.two_robots import FIRST, SECOND
from doormill_ros.frames import transform
from doormill_ros.nodes.base import topics
from doormill_ros.nodes.simulated.shared_door_judge import SharedDoorJudge


class Told:
    """A publisher that keeps what it is given."""

    def __init__(self) -> None:
        self.messages: list[Any] = []

    def publish(self, message: Any) -> None:
        self.messages.append(message)


@pytest.fixture
def judge(context: rclpy.Context):
    node = SharedDoorJudge(context=context)
    node.bring_up()
    node._verdict, node._milled = Told(), Told()
    yield node
    node.close()
    node.destroy_node()


def tell(judge: SharedDoorJudge, recorded: dict[str, bytes], second_too: bool = False) -> Any:
    """The recorded door has hinges alone, all of them the first robot's; the verdict on it."""

    def of(topic: topics.Topic) -> Any:
        return deserialize_message(recorded[f"/{topic.name}"], topic.type)

    judge._take_recipe(of(topics.DOOR_RECIPE))
    judge._take_placement(of(topics.DOOR_PLACEMENT))
    for robot in (SECOND, FIRST) if second_too else (FIRST,):
        judge._taker(judge._uncorrected, robot)(of(topics.EXECUTED_PATH))
        judge._taker(judge._done, robot)(of(topics.EXECUTED_PATH))
    (verdict,) = judge._verdict.messages
    assert len(judge._milled.messages) == 1
    return verdict


def test_the_idle_robot_where_it_belongs_is_in_nobodys_way(
    judge: SharedDoorJudge, recorded: dict[str, bytes]
) -> None:
    verdict = tell(judge, recorded)
    assert not [touch for touch in verdict.touches if "second" in touch.obstacle]


def test_the_idle_robot_in_the_way_is_found(judge: SharedDoorJudge, recorded: dict[str, bytes]) -> None:
    judge._bases[SECOND] = transform(translation=[-1.9, 0.0, 0.0]) @ judge._bases[SECOND]
    verdict = tell(judge, recorded)
    assert [touch for touch in verdict.touches if touch.obstacle.startswith("second's ")]
    assert not verdict.success


def test_a_robot_that_moved_with_nothing_to_mill_is_judged_too(
    judge: SharedDoorJudge, recorded: dict[str, bytes]
) -> None:
    """The second one goes through the first one's motions, before it, where it stands: at nothing of its own."""
    verdict = tell(judge, recorded, second_too=True)
    path = deserialize_message(recorded[f"/{topics.EXECUTED_PATH.name}"], topics.EXECUTED_PATH.type)
    assert verdict.judged == 2 * len(path.time)
