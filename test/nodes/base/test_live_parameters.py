"""Every parameter that may be changed while its node runs, and what the node makes of the change."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from rclpy.context import Context
from rclpy.parameter import Parameter
from rclpy.serialization import deserialize_message

from doormill_interfaces.action import MillDoor
from doormill_interfaces.msg import DoorRecipe
from doormill_ros.cell.run.run import StageLimits
from doormill_ros.localization.errors import CameraInfoMissing, StalePicture
from doormill_ros.nodes import door_shares
from doormill_ros.nodes.abb_bridge import AbbBridge
from doormill_ros.nodes.base import topics
from doormill_ros.nodes.door_localizer import DoorLocalizer
from doormill_ros.nodes.door_shares import DoorShares
from doormill_ros.nodes.gige_camera import GigeCamera
from doormill_ros.nodes.milling import mill_door
from doormill_ros.nodes.model_monitor import ModelMonitor
from doormill_ros.nodes.simulated.camera_simulator import UNSET, CameraSimulator
from doormill_ros.nodes.simulated.controller_simulator import ControllerSimulator
from doormill_ros.nodes.simulated.sensor_simulator import SensorSimulator
from doormill_ros.nodes.simulated.simulated_shift import SimulatedShift
from doormill_ros.pipeline.run_end import RunEnd
from support.hostile.listeners import Listener
from support.localizer_node import Answers, Localizer
from support.package_nodes import reporting_nodes

#: What the tests below change, by node; the decorator fills it.
CHANGED: set[tuple[type, str]] = set()
SCATTERED = ("scatter_y", "scatter_z", "scatter_rotation")
OFFSETS = ("offset_y", "offset_z", "offset_rotation")
STAGES = ("recipe", "picture", "targets", "request", "ready", "inspection")


def changes(kind: type, *names: str) -> Callable[[Any], Any]:
    """Note what a test changes."""

    def note(test: Any) -> Any:
        CHANGED.update((kind, name) for name in names)
        return test

    return note


def change(node: Any, **values: Any) -> None:
    answers = node.set_parameters([Parameter(name.replace("__", "."), value=v) for name, v in values.items()])
    assert [answer.reason for answer in answers if not answer.successful] == []


@pytest.fixture
def up(context: Context, tmp_path: Path) -> Iterator[Callable[..., Any]]:
    """Make an active node that nobody spins."""
    nodes = []

    def make(kind: Any) -> Any:
        nodes.append(Listener(kind).up(context, tmp_path))
        return nodes[-1]

    yield make
    for node in nodes:
        node.close()
        node.destroy_node()


class Clamp:
    """A simulated camera's node, and where the doors that it is given stand."""

    def __init__(self, node: Any, recorded: dict[str, bytes]) -> None:
        self.node = node
        self.recorded = recorded[f"/{topics.DOOR_RECIPE.name}"]
        self.number = 0

    def door(self) -> tuple[np.ndarray, Any]:
        """The next one's offsets and picture."""
        self.number += 1
        recipe = deserialize_message(self.recorded, DoorRecipe)
        recipe.run_id = f"run-{self.number}"
        # A recipe that says where its door stands is obeyed; and every door is the first of its shift here.
        document = json.loads(recipe.document)
        document.pop("placement", None)
        recipe.document = json.dumps(document)
        self.node._shift = SimulatedShift("", 0)
        placements = self.node._placement = Answers()
        self.node._place(recipe)
        (placement,) = placements
        picture = self.node.picture(recipe.run_id)
        return np.array([getattr(placement, name) for name in OFFSETS]), picture


@pytest.fixture
def clamp(up: Callable[..., Any], recorded: dict[str, bytes]) -> Clamp:
    return Clamp(up(CameraSimulator), recorded)


@changes(CameraSimulator, *SCATTERED)
def test_doors_scatter_as_far_as_they_are_told_to(clamp: Clamp) -> None:
    whole, _ = clamp.door()
    assert np.all(whole != 0.0)
    for axis, name in enumerate(SCATTERED):
        change(clamp.node, **{name: clamp.node.value(name) / 2})
        half, _ = clamp.door()
        assert half[axis] == pytest.approx(whole[axis] / 2, rel=1e-9)


@changes(CameraSimulator, *OFFSETS)
def test_doors_stand_where_they_are_put(clamp: Clamp) -> None:
    scattered, _ = clamp.door()
    put = np.array([0.003, -0.002, 0.01])
    for axis, name in enumerate(OFFSETS):
        change(clamp.node, **{name: float(put[axis])})
        assert clamp.door()[0][axis] == put[axis]
    change(clamp.node, **dict.fromkeys(OFFSETS, UNSET))
    assert clamp.door()[0].tolist() == scattered.tolist()


@changes(CameraSimulator, "seed", "noise")
def test_what_is_drawn_comes_from_the_seed_and_noise_from_its_share(clamp: Clamp) -> None:
    first, noisy = clamp.door()
    assert clamp.door()[1].data == noisy.data
    change(clamp.node, seed=1)
    assert not np.any(clamp.door()[0] == first)
    change(clamp.node, seed=0, noise=0.0)
    place, clean = clamp.door()
    assert place.tolist() == first.tolist()
    scatter = np.subtract(noisy.data, clean.data, dtype=float)
    change(clamp.node, noise=4.0)
    assert np.subtract(clamp.door()[1].data, clean.data, dtype=float).std() > 2 * scatter.std() > 0.0


@changes(CameraSimulator, "pictures")
def test_a_camera_breaks_and_is_mended(clamp: Clamp) -> None:
    for works in (False, True):
        change(clamp.node, pictures=works)
        assert (clamp.door()[1] is not None) is works


@changes(SensorSimulator, "seed")
def test_what_sensors_read_comes_from_the_seed(up: Callable[..., Any], recorded: dict[str, bytes]) -> None:
    node = up(SensorSimulator)
    recipe = deserialize_message(recorded[f"/{topics.DOOR_RECIPE.name}"], DoorRecipe)
    placement = deserialize_message(recorded[f"/{topics.DOOR_PLACEMENT.name}"], topics.DOOR_PLACEMENT.type)

    def read(number: int) -> list[Any]:
        recipe.run_id = placement.run_id = f"run-{number}"
        node._doors = 0
        node._take_recipe(recipe)
        node._take_placement(placement)
        return [(list(r.distances), r.points, [p.data for p in r.pictures]) for r in node._readings]

    first, same = read(1), read(2)
    assert first == same
    change(node, seed=1)
    assert all(a != b for a, b in zip(first, read(3), strict=True))


@changes(ControllerSimulator, "clamped")
def test_the_clamp_opens_under_a_door(up: Callable[..., Any]) -> None:
    node, opened = up(ControllerSimulator), []
    node._run = SimpleNamespace(open_clamp=lambda: opened.append(True), stop=lambda: None)
    change(node, clamped=True)
    assert not opened
    change(node, clamped=False)
    assert opened == [True]


@changes(DoorLocalizer, "check_age", "camera_info_wait", "overlay_step")
def test_the_localizer_looks_at_age_waits_and_draws_as_told(
    recorded: dict[str, bytes], context: Context
) -> None:
    localizer = Localizer(recorded, context)
    node = localizer.node
    node.later = lambda _, act: act()
    overlays = node._overlay = Answers()
    # Without intrinsics a picture waits for them, as long as it is told.
    change(node, camera_info_wait=30.0)
    before = time.monotonic()
    localizer.send(topics.IMAGE)
    assert node._waiting[1] >= before + 30.0
    node._give_up_waiting()
    assert localizer.answers == []
    change(node, camera_info_wait=0.0)
    localizer.send(topics.IMAGE)
    assert node._waiting[1] < time.monotonic() + 30.0
    node._give_up_waiting()
    assert [answer.error_code for answer in localizer.answers] == [CameraInfoMissing.code]
    localizer.send(topics.CAMERA_INFO)
    assert localizer.answer().accepted
    change(node, check_age=True)
    assert localizer.answer().error_code == StalePicture.code
    change(node, check_age=False)
    sizes = {}
    for step in (1, 4, 0):
        overlays.clear()
        change(node, overlay_step=step)
        assert localizer.answer().accepted
        sizes[step] = [(shown.width, shown.height) for shown in overlays]
    image = localizer.good[topics.IMAGE.name]
    assert sizes == {
        1: [(image.width, image.height)],
        4: [(-(-image.width // 4), -(-image.height // 4))],
        0: [],
    }
    node.close()
    node.destroy_node()


def limits_of_runs(monkeypatch: pytest.MonkeyPatch, module: Any, name: str) -> list[StageLimits]:
    """What the runs of a module's node are given; its course, by name, is replaced by one that refuses every door."""
    given: list[StageLimits] = []

    class Course:
        def __init__(self, run: Any, *arguments: Any) -> None:
            given.extend(argument for argument in arguments if isinstance(argument, StageLimits))
            self.end = RunEnd(run.run_id, run.door_id)

        def mill(self) -> RunEnd:
            self.end.refuse(1, "no course")
            return self.end

    monkeypatch.setattr(module, name, Course)
    return given


@pytest.mark.parametrize("stage", STAGES)
@changes(AbbBridge, *(f"limit.{stage}" for stage in STAGES))
def test_the_bridge_waits_for_the_next_door_as_long_as_told(
    up: Callable[..., Any], monkeypatch: pytest.MonkeyPatch, stage: str
) -> None:
    node, limits = up(AbbBridge), limits_of_runs(monkeypatch, mill_door, "Course")
    goal = SimpleNamespace(
        request=MillDoor.Goal(door_id="thesis_190_0deg"), is_cancel_requested=False, abort=lambda: None
    )
    for seconds in (7.0, 9.0):
        change(node, **{f"limit__{stage}": seconds})
        node._action._runs._execute(goal)
    assert [getattr(limit, stage) for limit in limits] == [7.0, 9.0]


@pytest.mark.parametrize("stage", [*STAGES, "read", "milling"])
@changes(DoorShares, *(f"limit.{stage}" for stage in (*STAGES, "read", "milling")))
def test_two_robots_are_waited_for_as_long_as_told(
    up: Callable[..., Any], monkeypatch: pytest.MonkeyPatch, stage: str
) -> None:
    node, limits = up(DoorShares), limits_of_runs(monkeypatch, door_shares, "SharedCourse")
    run = node._runs.desk.begin("thesis_190_0deg")
    for seconds in (7.0, 9.0):
        change(node, **{f"limit__{stage}": seconds})
        node._mill(run, lambda stage, progress: None)
    assert [getattr(limit, stage) for limit in limits] == [7.0, 9.0]


@changes(GigeCamera, "exposure", "gain", "exposure_auto", "exposure_longest", "limit")
def test_the_camera_on_the_network_exposes_and_waits_as_told(
    up: Callable[..., Any], recorded: dict[str, bytes], monkeypatch: pytest.MonkeyPatch
) -> None:
    node, asked = up(GigeCamera), []

    def take(exposure: float, gain: float) -> Any:
        asked.append((exposure, gain))
        return np.zeros((4, 4), np.uint8)

    node._line = SimpleNamespace(take=take, exposures=(1e-5, 10.0), close=lambda: None)
    change(node, exposure=0.02, gain=3.0)
    node._taken()
    assert asked == [(0.02, 3.0)]
    # In the dark the automatic exposure goes as far as it may; by hand it stays where it was put.
    node._light = SimpleNamespace(level=lambda picture: 0.0)
    for longest in (0.05, 0.07):
        change(node, exposure_longest=longest)
        assert node._taken().exposure == longest
    change(node, exposure_auto=False)
    assert node._taken().exposure == 0.02
    refused: list[Any] = []
    monkeypatch.setattr(node._teller, "refuse", refused.append)
    node._take_recipe(deserialize_message(recorded[f"/{topics.DOOR_RECIPE.name}"], DoorRecipe))
    monkeypatch.setattr(node, "still_wanted", lambda run_id: True)
    monkeypatch.setattr(node._waiting, "of", lambda run_id, now: 5.0)
    change(node, limit=6.0)
    node._give_up_waiting()
    assert not refused
    change(node, limit=4.0)
    node._give_up_waiting()
    assert [answer.duration for answer in refused] == [5.0]


@changes(ModelMonitor, "doors", "runs", "since", "limit.expected", "limit.diagnosis")
def test_the_monitor_asks_anew_by_what_it_is_told(
    up: Callable[..., Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    node, settled, runs_settled = up(ModelMonitor), [], []
    monkeypatch.setattr(node._watch, "settle", lambda: settled.append(node._watch._settings()))
    monkeypatch.setattr(node._runs, "settle", lambda: runs_settled.append(node._runs._settings()))
    told = {"doors": 7, "runs": 9, "since": "run-3", "limit__expected": 1e-4, "limit__diagnosis": 9.0}
    for name, value in told.items():
        change(node, **{name: value})
        node._look()
        node._look()
    assert len(settled) == len(told)
    last = settled[-1]
    assert (last.doors, last.runs, last.since, last.limit, last.patience) == (7, 9, "run-3", 1e-4, 9.0)
    assert runs_settled == settled


def test_every_parameter_that_can_be_changed_is() -> None:
    assert {(kind, p.name) for kind in reporting_nodes() for p in kind.PARAMETERS if p.live} == CHANGED
