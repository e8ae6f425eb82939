"""Parameters: what is started with a bad value says so, and a live change works or is refused."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import rclpy
from rclpy.lifecycle import TransitionCallbackReturn
from rclpy.parameter import Parameter

from doormill_ros.cell.errors import BadParameterError
from doormill_ros.nodes.abb_bridge import AbbBridge
from doormill_ros.nodes.camera_simulator import CameraSimulator
from doormill_ros.nodes.cell import NODES
from doormill_ros.nodes.managed_node import ManagedNode
from doormill_ros.nodes.model_monitor import ModelMonitor
from doormill_ros.nodes.reporting_node import NodeParameter
from doormill_ros.nodes.run import run_nodes


@pytest.mark.parametrize("make", [*NODES, ModelMonitor], ids=lambda make: make.__name__)
def test_every_number_has_a_range(make: Any) -> None:
    numbers = [
        p for p in make.PARAMETERS if isinstance(p.default, (int, float)) and type(p.default) is not bool
    ]
    assert [p.name for p in numbers if p.low is None or p.high is None] == []
    assert [p.name for p in numbers if not p.low <= p.default <= p.high] == []


@pytest.mark.parametrize("value", [math.nan, math.inf, -1.0, 1e9])
def test_a_change_out_of_range_is_refused_with_the_range(context: rclpy.Context, value: float) -> None:
    node = AbbBridge(context=context)
    (answer,) = node.set_parameters([Parameter("limit.recipe", value=value)])
    assert not answer.successful
    assert "0.1" in answer.reason
    assert "600" in answer.reason
    assert node.value("limit.recipe") == 10.0
    node.destroy_node()


def test_a_change_that_would_do_nothing_is_refused_once_the_node_is_configured(
    context: rclpy.Context, tmp_path: Path
) -> None:
    (tmp_path / "HOME").mkdir()
    node = AbbBridge(context=context)

    def change(name: str, value: object) -> Any:
        return node.set_parameters([Parameter(name, value=value)])[0]

    assert change("address", str(tmp_path / "HOME")).successful
    assert change("archive", str(tmp_path / "targets")).successful
    assert node.trigger_configure() == TransitionCallbackReturn.SUCCESS
    refused = change("limit.milling", 20.0)
    assert not refused.successful
    assert "clean it up" in refused.reason
    assert node.value("limit.milling") == 600.0
    assert change("limit.milling", 600.0).successful  # nothing changes
    assert change("limit.recipe", 7.0).successful
    assert node._action._limits().recipe == 7.0
    node.trigger_cleanup()
    assert change("limit.milling", 20.0).successful
    node.destroy_node()


class Follower(ManagedNode):
    """Notes what its live parameter is each time that was set."""

    PARAMETERS = (NodeParameter("wanted", 1.0, "what is wanted", 0.0, 9.0, live=True),)

    def setup(self) -> None:
        self.seen: list[float] = []
        self.when_set("wanted", self._see)

    def _see(self) -> None:
        self.seen.append(self.value("wanted"))
        if self.seen[-1] == 9.0:
            raise BadParameterError("nine is too much")


def test_a_node_hears_of_a_live_change_until_it_is_cleaned_up(context: rclpy.Context) -> None:
    node = Follower("follower", context=context)

    def change(value: float) -> bool:
        return bool(node.set_parameters([Parameter("wanted", value=value)])[0].successful)

    assert change(2.0)  # nobody listens yet
    node.trigger_configure()
    assert node.seen == []
    assert change(3.0)
    assert not change(10.0)
    node.trigger_activate()
    assert change(4.0)
    assert change(9.0)  # what goes wrong in who hears of it takes no change back
    assert node.seen == [3.0, 4.0, 9.0]
    assert node._health[1] == "nine is too much"
    node.trigger_deactivate()
    node.trigger_cleanup()
    assert change(5.0)
    assert node.seen == [3.0, 4.0, 9.0]
    node.destroy_node()


@pytest.mark.parametrize(
    ("make", "name", "value", "words"),
    [
        (AbbBridge, "limit.recipe", -1.0, "-1.0, allowed is a float from 0.1 to 600"),
        (AbbBridge, "limit.recipe", "soon", "'soon', allowed is a float"),
        (CameraSimulator, "noise", math.nan, "nan, allowed is a float from 0 to 4"),
        (CameraSimulator, "seed", -1, "-1, allowed is a int"),
    ],
)
def test_a_node_is_not_started_with_a_value_that_makes_no_sense(
    context: rclpy.Context, make: Callable[..., Any], name: str, value: object, words: str
) -> None:
    with pytest.raises(BadParameterError, match=name) as refusal:
        make(context=context, parameter_overrides=[Parameter(name, value=value)])
    assert words in refusal.value.message


def test_a_whole_number_is_a_number(context: rclpy.Context) -> None:
    node = AbbBridge(context=context, parameter_overrides=[Parameter("limit.recipe", value=7)])
    assert node.value("limit.recipe") == 7.0
    node.destroy_node()


def test_the_executable_says_it_in_one_line(capfd: pytest.CaptureFixture[str]) -> None:
    assert run_nodes(AbbBridge, arguments=["abb_bridge", "--ros-args", "-p", "limit.recipe:=-1.0"]) == 2
    said = capfd.readouterr().err
    assert "limit.recipe" in said
    assert "Traceback" not in said
