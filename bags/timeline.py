"""What a reference bag is meant to show, and whether it does."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import yaml

from doormill_ros.cell.graph import topic_names
from doormill_ros.recording.bag_reader import read_bag
from doormill_ros.recording.errors import BadTimelineError

SCHEMA = "doormill/timeline/1"


@dataclass(frozen=True)
class Scenario:
    """One run of one door and its intended course.

    Attributes:
        name: Folder of its bag.
        intent: What it shows, one sentence.
        door: Door id of the goal.
        success: How the run ends.
        error_codes: First and last allowed error code.
        messages: Number of messages by topic, without the leading slash.
        handshake: States of abb/status in order, repetitions left out; empty for any.
        targets: Number of targets; None for any.
        recipe: Recipe file beside the timeline; empty for a shipped door.
        parameters: Of the cell's nodes.
    """

    name: str
    intent: str
    door: str
    success: bool
    error_codes: tuple[int, int]
    messages: dict[str, int]
    handshake: tuple[str, ...] = ()
    targets: int | None = None
    recipe: str = ""
    parameters: dict[str, dict[str, Any]] = field(default_factory=dict)


def load_timeline(path: Path) -> tuple[dict[str, dict[str, Any]], list[Scenario]]:
    """Node parameters common to all scenarios, and the scenarios.

    Raises:
        BadTimelineError: The file is not of its form.
    """
    try:
        document = yaml.safe_load(path.read_text(encoding="utf-8"))
        if document["schema"] != SCHEMA:
            raise KeyError(f"schema {document['schema']!r} instead of {SCHEMA!r}")
        return document["common"], [_scenario(name, entry) for name, entry in document["scenarios"].items()]
    except (OSError, yaml.YAMLError, KeyError, TypeError, ValueError) as error:
        raise BadTimelineError(f"{path} is no timeline: {error}; correct it", path=str(path)) from error


def _scenario(name: str, entry: dict[str, Any]) -> Scenario:
    code = entry["ends"]["error_code"]
    return Scenario(
        name=name,
        intent=entry["intent"],
        door=entry["door"],
        success=entry["ends"]["success"],
        error_codes=tuple(code) if isinstance(code, list) else (code, code),
        messages=entry["messages"],
        handshake=tuple(entry.get("handshake", ())),
        targets=entry.get("targets"),
        recipe=entry.get("recipe", ""),
        parameters=entry.get("parameters", {}),
    )


def violations(scenario: Scenario, bag: Path) -> list[str]:
    """What a bag shows otherwise than intended; empty when it is as intended.

    Raises:
        UnreadableBagError: The bag cannot be read.
    """
    counts: Counter[str] = Counter()
    states: list[str] = []
    result = targets = None
    for item in read_bag(bag):
        topic = item.topic.lstrip("/")
        counts[topic] += 1
        if topic == topic_names.RUN_RESULT:
            result = item.message
        elif topic == topic_names.PATH_TARGETS:
            targets = item.message
        elif topic == topic_names.ABB_STATUS and item.message.state not in states[-1:]:
            states.append(item.message.state)
    wrong = [
        f"{counts[topic]} messages of {topic} instead of {number}"
        for topic, number in scenario.messages.items()
        if counts[topic] != number
    ]
    if result is None:
        return [*wrong, "no result"]
    low, high = scenario.error_codes
    if (
        result.success != scenario.success
        or not low <= result.error_code <= high
        or result.door_id != scenario.door
    ):
        wrong.append(f"door {result.door_id} ended with code {result.error_code}: {result.message}")
    if scenario.targets is not None and (targets is None or len(targets.targets) != scenario.targets):
        wrong.append(
            f"{0 if targets is None else len(targets.targets)} targets instead of {scenario.targets}"
        )
    if scenario.handshake and not _in_order(scenario.handshake, states):
        wrong.append(f"handshake went {', '.join(states)} instead of {', '.join(scenario.handshake)}")
    return wrong


def _in_order(wanted: tuple[str, ...], states: list[str]) -> bool:
    """True when the wanted states come in this order; others may stand between them."""
    rest = iter(states)
    return all(state in rest for state in wanted)
