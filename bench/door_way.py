"""The way of each door through the cell, stage by stage, from the stamps in its bag alone."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from mcap.reader import make_reader
from rclpy.serialization import deserialize_message

from doormill_ros.abb.handshake.state import HandshakeState
from doormill_ros.messages.stamps import nanoseconds_of
from doormill_ros.nodes.base import topics
from doormill_ros.recording.bag_reader import bag_files
from doormill_ros.units import ns_to_s, s_to_ns

#: Each begins where the one before ends; together they are the time from request to ready.
STAGES = (
    "picture taken",  # from the request
    "picture on the wire",  # until the localizer begins
    "pose",
    "pose on the wire",  # until the path generator begins
    "targets computed",
    "targets on the wire",  # until the bridge has them
    "file rendered",
    "file written",
    "read back, checked",
    "ready",
)
#: Between a stamp of the wall clock and a time that the bridge measured on its steady one, a switch of threads included
#: [ns].
ROUNDING = 20_000_000
HANDOVER = (HandshakeState.WRITING, HandshakeState.VERIFYING, HandshakeState.RAISING, HandshakeState.READY)
READ = (
    topics.DOOR_LOCALIZATION,
    topics.DOOR_POSE,
    topics.PATH_TARGETS,
    topics.ABB_STATUS,
    topics.RUN_RESULT,
)


@dataclass(frozen=True)
class DoorWay:
    """One door: its id, how long each of `STAGES` took and all of them together [s]."""

    door_id: str
    stages: tuple[float, ...]
    total: float


@dataclass
class _Stamps:
    """What the bag says of one run, times in ns since the epoch; duration and send time of an answer."""

    localized: dict[int, int] = field(default_factory=dict)  # duration by the picture's stamp
    planned: dict[int, tuple[int, int]] = field(default_factory=dict)
    states: dict[str, int] = field(default_factory=dict)
    result: Any = None


def ways_of(bag: Path) -> list[DoorWay | str]:
    """The runs of a bag in order, each its door's way, or what is missing to tell it."""
    runs: dict[str, _Stamps] = {}
    posed: dict[int, int] = {}
    for name, message, sent in _messages(bag):
        if name == topics.DOOR_POSE.name:
            posed[nanoseconds_of(message.header.stamp)] = sent
            continue
        if not message.run_id:
            continue
        stamps = runs.setdefault(message.run_id, _Stamps())
        if name == topics.DOOR_LOCALIZATION.name and message.accepted:
            stamps.localized[nanoseconds_of(message.header.stamp)] = s_to_ns(message.duration)
        elif name == topics.PATH_TARGETS.name and message.accepted:
            stamps.planned[nanoseconds_of(message.header.stamp)] = s_to_ns(message.duration), sent
        elif name == topics.ABB_STATUS.name:
            stamps.states.setdefault(message.state, nanoseconds_of(message.since))
        elif name == topics.RUN_RESULT.name:
            stamps.result = message
    return [_way(stamps, posed) for stamps in runs.values()]


def _way(stamps: _Stamps, posed: dict[int, int]) -> DoorWay | str:
    result, states = stamps.result, [stamps.states.get(state.value) for state in HANDOVER]
    if result is None or None in states:
        return f"result {'there' if result else 'missing'}, states {', '.join(stamps.states) or 'none'}"
    ready = states[-1]
    total = s_to_ns(result.times.request_to_ready)
    # A slow machine's camera takes a second picture before the first is used; that one counts.
    requested = ready - total
    used = stamps.localized.keys() & stamps.planned.keys() & posed.keys()
    picture = min((stamp for stamp in used if stamp >= requested - ROUNDING), default=0)
    if not picture:
        at = {"pictures": stamps.localized, "targets": stamps.planned, "poses": posed}
        told = (f"{name} {[round(ns_to_s(t - ready), 3) for t in times][-3:]}" for name, times in at.items())
        return f"none led to targets since {ns_to_s(requested - ready):.3f} s before ready: {', '.join(told)}"
    planning, planned = stamps.planned[picture]
    heard = picture + s_to_ns(result.times.picture_to_pose + result.times.pose_to_targets)
    marks = [
        requested,
        picture,
        posed[picture] - stamps.localized[picture],
        posed[picture],
        planned - planning,
        planned,
        heard,
        *states,
    ]
    steps = [ns_to_s(b - a) for a, b in itertools.pairwise(marks)]
    return DoorWay(result.door_id, tuple(steps), ns_to_s(total))


def _messages(bag: Path) -> Iterator[tuple[str, Any, int]]:
    """Topic without its slash, message and when it was sent [ns since the epoch]."""
    wanted = {f"/{topic.name}": topic for topic in READ}
    for path in bag_files(bag):
        with path.open("rb") as file:
            for _, channel, record in make_reader(file).iter_messages(list(wanted)):
                topic = wanted[channel.topic]
                yield topic.name, deserialize_message(record.data, topic.type), record.publish_time
