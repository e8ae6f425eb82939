"""Parameters: what is started with a bad value says so, and a live change works or is refused."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import rclpy
from rclpy.lifecycle import TransitionCallbackReturn
from rclpy.parameter import Parameter

from doormill_ros.cell.errors import BadParameterError
from doormill_ros.nodes.abb_bridge import AbbBridge, caution_of
from doormill_ros.nodes.base.chosen_values import check_values
from doormill_ros.nodes.base.managed_node import ManagedNode
from doormill_ros.nodes.base.node_parameter import NodeParameter
from doormill_ros.nodes.base.reporting_node import ReportingNode
from doormill_ros.nodes.door_localizer import DoorLocalizer
from doormill_ros.nodes.model_monitor import ModelMonitor
from doormill_ros.nodes.one_process.cell import NODES
from doormill_ros.nodes.path_generator import PathGenerator
from doormill_ros.nodes.process.run import run_nodes
from doormill_ros.nodes.process.unknown_parameters import unknown_nodes, unknown_parameters
from doormill_ros.nodes.simulated.camera_simulator import CameraSimulator
from doormill_ros.nodes.simulated.controller_simulator import ControllerSimulator
from support.package_nodes import first_arguments, reporting_nodes

ALL = reporting_nodes()

#: No limit of a stage can be one of these [s].
BEYOND = (math.nan, math.inf, -1.0, 600.1, 1e9)


def test_the_nodes_of_the_package_are_found() -> None:
    assert {AbbBridge, CameraSimulator, ModelMonitor, *NODES} < set(ALL)
    assert ManagedNode not in ALL


@pytest.mark.parametrize("make", ALL, ids=lambda make: make.__name__)
def test_every_number_has_a_range(make: type[ReportingNode]) -> None:
    numbers = [
        p for p in make.PARAMETERS if isinstance(p.default, (int, float)) and type(p.default) is not bool
    ]
    assert [p.name for p in numbers if p.low is None or p.high is None] == []
    assert [p.name for p in numbers if not p.low <= p.default <= p.high] == []


@pytest.mark.parametrize("make", ALL, ids=lambda make: make.__name__)
def test_every_parameter_says_what_it_means_and_can_be(
    make: type[ReportingNode], context: rclpy.Context
) -> None:
    node = make(**first_arguments(make), context=context)
    names = [p.name for p in make.PARAMETERS]
    described = dict(zip([*names, "autostart"], node.describe_parameters([*names, "autostart"]), strict=True))
    assert [name for name, descriptor in described.items() if not descriptor.description] == []
    for parameter in make.PARAMETERS:
        told = described[parameter.name].additional_constraints
        assert all(repr(choice) in told for choice in parameter.choices)
        if parameter.choices:
            assert parameter.default in parameter.choices
    node.destroy_node()


#: Parameters that are one of a few words, and a word that looks like one.
CHOSEN = [
    (AbbBridge, "transport", "rws2", "rws3"),
    (PathGenerator, "share", "second", "third"),
    (ControllerSimulator, "web_services", "rws1", "http"),
    (DoorLocalizer, "image_transport", "compressed", "theora"),
]


@pytest.mark.parametrize(("make", "name", "good", "bad"), CHOSEN)
def test_one_of_a_few_words_is_told_and_another_is_refused(
    make: Callable[..., Any], name: str, good: str, bad: str, context: rclpy.Context
) -> None:
    with pytest.raises(BadParameterError, match=name) as refusal:
        make(context=context, parameter_overrides=[Parameter(name, value=bad)])
    assert f"{bad!r}, allowed is one of " in refusal.value.message
    assert repr(good) in refusal.value.message
    node = make(context=context, parameter_overrides=[Parameter(name, value=good)])
    assert repr(good) in node.describe_parameter(name).additional_constraints
    (answer,) = node.set_parameters([Parameter(name, value=bad)])
    assert not answer.successful
    assert f"{bad!r}, allowed is one of " in answer.reason
    assert node.value(name) == good
    node.destroy_node()


def test_every_parameter_with_a_few_words_is_tried() -> None:
    assert {p.name for make in ALL for p in make.PARAMETERS if p.choices} == {
        name for _, name, _, _ in CHOSEN
    }


@pytest.mark.parametrize(
    ("make", "name", "value", "words"),
    [
        (AbbBridge, "limit.recipe", "soon", "'soon', allowed is a float from 0.1 to 600: "),
        (AbbBridge, "limit.recipe", 7, "7, allowed is a float from 0.1 to 600: "),
        (AbbBridge, "limit.recipe", [7.0], "[7.0], allowed is a float from 0.1 to 600: "),
        (AbbBridge, "limit.recipe", None, "None, allowed is a float from 0.1 to 600: "),
        (AbbBridge, "transport", 2, "2, allowed is one of "),
        (AbbBridge, "address", 192, "192, allowed is a str: "),
        (AbbBridge, "autostart", "no", "'no', allowed is a bool: "),
        (CameraSimulator, "pictures", 1, "1, allowed is a bool: "),
        (CameraSimulator, "seed", 1.0, "1.0, allowed is an int from "),
        (CameraSimulator, "seed", -1, "-1, allowed is an int from "),
        *((AbbBridge, "limit.recipe", bad, f"{bad}, allowed is a float from 0.1 to 600: ") for bad in BEYOND),
    ],
)
def test_a_change_that_cannot_be_is_refused_in_one_sentence(
    make: Callable[..., Any], name: str, value: Any, words: str, context: rclpy.Context
) -> None:
    node = make(context=context)
    before = node.value(name)
    change = [Parameter(name, value=value)]
    for answer in (*node.set_parameters(change), node.set_parameters_atomically(change)):
        assert not answer.successful
        assert answer.reason.startswith(f"parameter {name} of /{node.get_name()} is {words}")
        description = node.describe_parameter(name).description
        sentence, remedy = answer.reason.rsplit(f": {description}; ", 1)
        assert re.match("set it to|set it within|write 7.0$|quote it", remedy)
        assert "\n" not in sentence
    assert node.value(name) == before
    assert node.set_parameters([Parameter(name, value=before)])[0].successful
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
    assert node._action._runs.limits().recipe == 7.0
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
        (CameraSimulator, "seed", -1, "-1, allowed is an int from 0 to 2147483647"),
    ],
)
def test_a_node_is_not_started_with_a_value_that_makes_no_sense(
    context: rclpy.Context, make: Callable[..., Any], name: str, value: object, words: str
) -> None:
    with pytest.raises(BadParameterError, match=name) as refusal:
        make(context=context, parameter_overrides=[Parameter(name, value=value)])
    assert words in refusal.value.message
    # The same is said where there is no node yet.
    node = re.search(r"of /(\w+) is", refusal.value.message)
    assert node is not None
    with pytest.raises(BadParameterError) as before:
        check_values(node[1], make, {name: value})  # type: ignore[arg-type]  # a class of nodes
    assert before.value.message == refusal.value.message


@pytest.mark.parametrize("make", reporting_nodes(), ids=lambda make: make.__name__)
def test_a_default_is_a_value_that_a_node_takes(make: type[ReportingNode]) -> None:
    check_values("node", make, {parameter.name: parameter.default for parameter in make.PARAMETERS})


def test_a_whole_number_is_a_number(context: rclpy.Context) -> None:
    node = AbbBridge(context=context, parameter_overrides=[Parameter("limit.recipe", value=7)])
    assert node.value("limit.recipe") == 7.0
    node.destroy_node()


def test_the_executable_says_it_in_one_line(capfd: pytest.CaptureFixture[str]) -> None:
    assert run_nodes(AbbBridge, arguments=["abb_bridge", "--ros-args", "-p", "limit.recipe:=-1.0"]) == 2
    said = capfd.readouterr().err
    assert "limit.recipe" in said
    assert "Traceback" not in said


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--log-level", "loud"], "--log-level loud"),
        (["--params-file", "{broken}"], "broken.yaml"),
        (["--params-file", "{missing}"], "missing.yaml"),
        (["-r", "no_rule"], "no_rule"),
        (["--bogus"], "--bogus"),
    ],
    ids=lambda value: str(value[0]).strip("-") if isinstance(value, list) else "",
)
def test_arguments_that_ros_cannot_read_are_one_sentence(
    arguments: list[str], words: str, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "broken.yaml").write_text("abb_bridge: [1\n")
    names = {name: tmp_path / f"{name}.yaml" for name in ("broken", "missing")}
    given = ["abb_bridge", "--ros-args", *(argument.format(**names) for argument in arguments)]
    assert run_nodes(AbbBridge, arguments=given) == 2
    said = capfd.readouterr().err
    (fatal,) = [line for line in said.splitlines() if "[FATAL]" in line]
    assert words in fatal
    assert "correct" in fatal
    assert "Traceback" not in said
    assert "/src/" not in fatal


def test_a_misspelt_parameter_is_named_with_the_one_that_is_meant(context: rclpy.Context) -> None:
    given = {"limit.recipy": 3.0, "limit.picture": 3.0, "use_sim_time": False, "autostart": False}
    overrides = [Parameter(name, value=value) for name, value in given.items()]
    bridge = AbbBridge(context=context, parameter_overrides=overrides)
    simulator = CameraSimulator(context=context, parameter_overrides=[Parameter("limit.picture", value=3.0)])
    (sentence,) = unknown_parameters([bridge, simulator])
    assert "no parameter limit.recipy of /abb_bridge" in sentence
    assert "limit.recipe is meant" in sentence
    (alone,) = unknown_parameters([simulator])
    assert "limit.picture of /camera_simulator" in alone
    for node in (bridge, simulator):
        node.destroy_node()


def test_a_misspelt_node_is_named_with_the_one_that_is_meant(context: rclpy.Context) -> None:
    simulator = CameraSimulator(context=context, namespace="/cell1")
    good = [
        "-p",
        "camera_simulator:noise:=0.5",
        "--param",
        "/cell1/camera_simulator:seed:=3",
        "-p",
        "noise:=1.0",
    ]
    others = [
        "-p",
        "/**:seed:=3",
        "-r",
        "camera_simulater:door/recipe:=other",
        "-r",
        "__node:=camera_simulator",
    ]
    assert unknown_nodes(["cell_simulator", "--ros-args", *good, *others], [simulator]) == []
    for wrong in ("camera_simulater:noise:=0.5", "/cell2/camera_simulator:noise:=0:5"):
        (sentence,) = unknown_nodes(["cell_simulator", "--ros-args", *good, "-p", wrong], [simulator])
        assert f"no node {wrong.partition(':')[0]} in this process" in sentence
        assert "parameter noise is left aside" in sentence
        assert "camera_simulator is meant" in sentence
    simulator.destroy_node()


def test_the_bridge_to_a_real_robot_tells_what_nobody_measured_of_it() -> None:
    assert caution_of("simulated_folder") == ""
    for transport in ("rws1", "rws2"):
        assert "before a real robot moves compare them with its manual" in caution_of(transport)
