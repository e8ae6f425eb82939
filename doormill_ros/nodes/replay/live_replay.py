"""Repeat a recorded run with the nodes, over DDS, and collect what they answer."""

from __future__ import annotations

import os
import re
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from rclpy.parameter import Parameter

from doormill_ros.abb import signals
from doormill_ros.abb.handshake.access import FAULT_WHILE_MILLING, NO_REASON
from doormill_ros.abb.link_errors import MillingFaultError
from doormill_ros.cell.errors import StageTimeoutError
from doormill_ros.localization.sensors.registry import registered
from doormill_ros.messages.from_message import recipe_of
from doormill_ros.nodes.abb_bridge import AbbBridge
from doormill_ros.nodes.base.managed_node import ManagedNode
from doormill_ros.nodes.door_localizer import DoorLocalizer
from doormill_ros.nodes.path_generator import PathGenerator
from doormill_ros.nodes.process.composition import Composition
from doormill_ros.nodes.recipe_database import RecipeDatabaseNode
from doormill_ros.nodes.replay.replay_driver import ReplayDriver
from doormill_ros.nodes.sensing.sensor_localizer import SensorLocalizer
from doormill_ros.nodes.sensing.sensors_parameter import SENSORS_PARAMETER
from doormill_ros.recipes.store.database import RecipeDatabase
from doormill_ros.recording.errors import SharedRunError
from doormill_ros.recording.replay.answer import Answer, pictureless
from doormill_ros.recording.replay.live import LiveRun
from doormill_ros.recording.replay.offline import LAST_REPLAYED
from doormill_ros.recording.replay.recorded_run import RecordedRun
from doormill_ros.simulation.controller.recorded_controller import (
    RecordedController,
    RecordedEvent,
    controller_events,
    with_end,
)

#: Targets follow from a pose found anew, whose own tolerance is that of a lever of some metres.
SLACK = 50.0
PATIENCE = 120.0  # s, for stages that answered in the recorded run
WAITED = re.compile(r"\(waited ([\d.]+) s\)")


@dataclass(frozen=True)
class LiveOptions:
    """How a run is repeated.

    Attributes:
        rate: Times the recorded speed; infinite to wait for answers only.
        robot_model: For the path generator; empty for the one that the recording names.
        database: URL of the recipe database that is asked; empty for one that holds the recorded recipe,
            or, when the run had none, the shipped ones.
    """

    rate: float = 1.0
    robot_model: str = ""
    database: str = ""


def replay_live(run: RecordedRun, options: LiveOptions) -> list[Answer]:
    """Start database, localizer, path generator and bridge in a namespace of their own and mill the door again.

    Args:
        run: What is repeated: its goal, its pictures, and its controller's signals.
        options: How.

    Returns:
        What the nodes answered, under the stamps of the recorded pictures.

    Raises:
        SharedRunError: Two robots milled the door.
        StageTimeoutError: A node does not answer.
    """
    if run.shared:
        raise SharedRunError(
            f"run {run.run_id} is of two robots, nodes repeat those of one; leave out --live",
            run_id=run.run_id,
        )
    with tempfile.TemporaryDirectory(prefix="replay-", ignore_cleanup_errors=True) as name:
        folder = Path(name)
        home = folder / "HOME"
        home.mkdir()
        events = _events(run)
        arguments = ["replay", "--ros-args", "-r", f"__ns:=/replay_{os.getpid()}"]
        nodes = _nodes(run, options, folder)
        with (
            Composition(arguments, nodes, partial(ReplayDriver, run.image_transport, run.sensors)) as cell,
            RecordedController(home, events, options.rate, _reason_of_fault(run)) as controller,
        ):
            live = LiveRun(run, cell.driver, options.rate, repeats_the_end(run))
            return live.replay(controller.begin, _age_check(cell.nodes))


def _events(run: RecordedRun) -> list[RecordedEvent]:
    events = controller_events(run.begun_ns, run.requests, run.states)
    if run.result is not None and run.result.success:
        return with_end(events, signals.DONE)
    if run.result is not None and run.result.error_code == MillingFaultError.code:
        return with_end(events, signals.FAULT)
    return events


def _reason_of_fault(run: RecordedRun) -> str:
    """What the robot program said of the fault that ended the run, empty when it said nothing."""
    if run.result is None or run.result.error_code != MillingFaultError.code:
        return ""
    reason = str(run.result.message).partition(FAULT_WHILE_MILLING)[2]
    return "" if reason == NO_REASON else reason


def repeats_the_end(run: RecordedRun) -> bool:
    """True when what ended the run is an answer of the nodes to what is played to them."""
    result = run.result
    if result is None:
        return False
    if any(pictureless(message) for _, message in run.localizations):
        return False
    without_picture = not run.pictures and result.error_code == StageTimeoutError.code
    return bool(
        result.error_code <= LAST_REPLAYED or without_picture or result.error_code == MillingFaultError.code
    )


def _nodes(run: RecordedRun, options: LiveOptions, folder: Path) -> list[Callable[[], Any]]:
    waited = WAITED.search(run.result.message) if run.result is not None else None
    stages = ("recipe", "picture", "targets", "request", "ready")
    limits = {f"limit.{stage}": PATIENCE for stage in (*stages, "answer")}
    if waited is not None and not run.pictures:
        limits["limit.picture"] = float(waited[1])
    sensors = {SENSORS_PARAMETER.name: ",".join(run.sensors)}
    bridge = {**sensors, "address": str(folder / "HOME"), "archive": str(folder / "targets"), **limits}
    database = {"database_url": options.database or _database(run, folder), "ship_recipes": False}
    # A recorded picture is old, nobody looks at its overlay, and /tf is the running cell's.
    localizer = {
        **sensors,
        "check_age": False,
        "overlay_step": 0,
        "frames": False,
        "image_transport": run.image_transport,
    }
    recorded = next((str(message.robot_model) for message in run.share().targets), "")
    model = options.robot_model or recorded
    chosen: tuple[tuple[Callable[..., ManagedNode], dict[str, Any]], ...] = (
        (RecipeDatabaseNode, database),
        (DoorLocalizer, localizer),
        (PathGenerator, {"robot_model": model, "models": "none", "frames": False}),
        (AbbBridge, bridge),
    )
    beside: list[tuple[Callable[..., ManagedNode], dict[str, Any]]] = [
        (partial(SensorLocalizer, name), {**sensors, "frames": False}) for name in registered(run.sensors)
    ]
    return [
        partial(make, parameter_overrides=[Parameter(k, value=v) for k, v in values.items()])
        for make, values in (*chosen, *beside)
    ]


def _database(run: RecordedRun, folder: Path) -> str:
    """URL of a database that knows what the recorded one knew of the door."""
    url = str(folder / "recipes.sqlite")
    with RecipeDatabase(url) as database:
        if run.recipe is None:
            database.add_shipped()
        else:
            recipe = recipe_of(run.recipe)
            # Each save is one version more.
            database.save_all([recipe] * max(1, int(run.recipe.version)), run.recipe.author or "replay")
    return url


def _age_check(nodes: Sequence[ManagedNode]) -> Callable[[bool], None]:
    """Switches the localizer's check of the pictures' age."""
    localizer = next(node for node in nodes if isinstance(node, DoorLocalizer))

    def switch(checked: bool) -> None:
        localizer.set_parameters([Parameter("check_age", value=checked)])

    return switch
