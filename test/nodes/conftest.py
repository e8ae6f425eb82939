"""What tests of nodes share."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
import rclpy

from doormill_ros.recording.bag_reader import read_bag
from support.source_tree import ROOT


@pytest.fixture
def context() -> Iterator[rclpy.Context]:
    """A context of the test's own."""
    context = rclpy.Context()
    rclpy.init(context=context)
    yield context
    rclpy.shutdown(context=context)


@pytest.fixture(scope="session")
def recorded() -> dict[str, bytes]:
    """The last message of each topic of a good run, serialized."""
    return {message.topic: message.data for message in read_bag(ROOT / "bags" / "thesis_190_0deg")}
