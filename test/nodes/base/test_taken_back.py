"""A callback that failed once takes its error back when it goes well again, and no other one's."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import pytest
import rclpy

from doormill_ros.errors import DoormillError
from doormill_ros.nodes.base.managed_node import ManagedNode
from doormill_ros.nodes.base.reporting_node import ERROR, OK, WARN

Call = Callable[[str], None]


@pytest.fixture
def node(context: rclpy.Context) -> Iterator[ManagedNode]:
    made = ManagedNode("listener", context=context)
    made.bring_up()
    made.report(OK, "listening", heard=3)
    yield made
    made.close()
    made.destroy_node()


def complain(reason: str) -> None:
    """Fail for a reason, or do nothing."""
    if reason:
        raise DoormillError(reason)


@pytest.fixture
def two(node: ManagedNode) -> tuple[Call, Call]:
    return node.guarded(complain), node.guarded(complain)


def test_the_next_call_that_goes_well_takes_the_error_back(node: ManagedNode, two: tuple[Call, Call]) -> None:
    first, _ = two
    first("no such picture")
    first("no such picture either")
    assert node._health[:2] == (ERROR, "no such picture either")
    first("")
    assert node._health == (OK, "listening", {"heard": 3})


def test_the_error_of_another_callback_stays(node: ManagedNode, two: tuple[Call, Call]) -> None:
    first, second = two
    second("the disk is full")
    first("no such picture")
    first("")
    assert node._health[:2] == (ERROR, "the disk is full")
    first("")
    assert node._health[:2] == (ERROR, "the disk is full")
    first("no such picture")
    second("")
    assert node._health[:2] == (ERROR, "no such picture")
    first("")
    assert node._health[:2] == (OK, "listening")


def test_what_the_node_says_itself_is_not_taken_back(node: ManagedNode, two: tuple[Call, Call]) -> None:
    first, _ = two
    first("no such picture")
    node.report(WARN, "the door is missing")
    first("")
    assert node._health[:2] == (WARN, "the door is missing")
    node.report(ERROR, "no link")
    first("no such picture")
    first("")
    assert node._health[:2] == (ERROR, "no link")


def test_what_is_called_later_takes_back_what_went_wrong_under_its_name(node: ManagedNode) -> None:
    def call(name: str, reason: str) -> None:
        node.later(name, lambda: complain(reason))
        node._later[name].callback()

    call("overlay", "no colours")
    call("path", "")
    assert node._health[:2] == (ERROR, "no colours")
    call("overlay", "")
    assert node._health[:2] == (OK, "listening")


def test_a_node_that_was_activated_meanwhile_is_not_said_to_be_inactive(node: ManagedNode) -> None:
    node.trigger_deactivate()
    told = node.guarded(complain)
    told("nine is too much")
    node.trigger_activate()
    assert node._health[:2] == (ERROR, "nine is too much")
    told("")
    assert node._health[:2] == (OK, "active")
