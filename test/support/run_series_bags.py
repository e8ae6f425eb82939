"""Bags of a drawn series of runs: shipped ones, rewritten as the cell would have recorded them that day."""

from __future__ import annotations

import struct
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from builtin_interfaces.msg import Time
from geometry_msgs.msg import PoseStamped, PoseWithCovariance, TwistStamped
from rclpy.serialization import deserialize_message, serialize_message
from std_msgs.msg import Bool

from doormill_interfaces.msg import (
    AbbStatus,
    DoorLocalization,
    RunResult,
    SensorLocalization,
    SpindleLoad,
    StageTimes,
    TargetArray,
)
from doormill_ros.recording.bag_reader import read_bag
from doormill_ros.recording.bag_writer import BagWriter
from doormill_ros.recording.metadata import BagRecord
from support.run_series import BEGAN, PROBE, TAKT, Floats, Series
from support.source_tree import ROOT

KEPT = ("/door/recipe", "/door/localization", "/path/targets", "/abb/target_file", "/run/result")
TYPES = {
    "/abb/status": "doormill_interfaces/msg/AbbStatus",
    "/abb/request": "std_msgs/msg/Bool",
    "/abb/ready": "std_msgs/msg/Bool",
    "/door/recipe": "doormill_interfaces/msg/DoorRecipe",
    "/door/pose": "geometry_msgs/msg/PoseStamped",
    "/door/localization": "doormill_interfaces/msg/DoorLocalization",
    "/sensors/localization": "doormill_interfaces/msg/SensorLocalization",
    "/camera/moved": "geometry_msgs/msg/TwistStamped",
    "/path/targets": "doormill_interfaces/msg/TargetArray",
    "/abb/target_file": "std_msgs/msg/String",
    "/abb/spindle_load": "doormill_interfaces/msg/SpindleLoad",
    "/run/result": "doormill_interfaces/msg/RunResult",
}
REQUESTED = 0.7  #: from the start of a run to the request [s]
AGAIN = 3.0  #: from one localization of a run to the next [s]
REFUSED = 204
REASON = (
    "the door stands +13.00 mm in y, +1.00 mm in z and +0.11 degrees off, allowed are 10 mm, 10 mm and "
    "2 degrees; place it again"
)
LOOK = 0.25  #: from one look at the spindle's load to the next [s]
OFF, SPUN_UP = 1.0, 2.5  #: a spindle is told to turn, and has its speed, so long after milling began [s]
SURGE, AIR = 0.45, 0.11  #: load while it comes to speed, and in the air
CUTS = {"thesis_190_0deg": (3, 0.16), "thesis_1350_0deg": (5, 0.12), "standard_door": (9, 0.2)}
"""By recipe: how many cuts take seven tenths of the time at speed, and their usual load beyond that in the air."""
SHARE = 0.7
SEES = [False, True, True, True, False, False]  #: y, z and the rotation about x


@dataclass(frozen=True, eq=False)
class Shipped:
    """What is taken from a bag: serialized messages by topic, and the door's nominal place x, y, z [m]."""

    messages: dict[str, bytes]
    run_id: str
    door_id: str
    nominal: tuple[float, float, float]
    cycle_time: float  # s


@lru_cache
def shipped(name: str) -> Shipped:
    """A bag of the repository."""
    messages = {item.topic: item.data for item in read_bag(ROOT / "bags" / name, KEPT)}
    found = deserialize_message(messages["/door/localization"], DoorLocalization)
    targets = deserialize_message(messages["/path/targets"], TargetArray)
    place = found.pose.pose.position
    nominal = (place.x, place.y - found.offset_y, place.z - found.offset_z)
    return Shipped(messages, found.run_id, found.door_id, nominal, targets.cycle_time)


def write_series(series: Series, folder: Path) -> list[Path]:
    """Write one bag a run, and return them in order: FOLDER/door_000/bag and so on."""
    bags = []
    for run in range(len(series.recipes)):
        bags.append(folder / f"door_{run:03d}" / "bag")
        writer = BagWriter(bags[-1], ros_distro="kilted")
        writer.record = _WrittenOnce("kilted", files=writer.record.files)
        messages = sorted(_Run(series, run).messages(), key=lambda item: item[0])
        for topic in dict.fromkeys(topic for _, topic, _ in messages):
            writer.add_topic(topic, TYPES[topic])
        for stamp_ns, topic, data in messages:
            writer.write(topic, data, stamp_ns)
        writer.close()
    return bags


class _WrittenOnce(BagRecord):
    """A bag's metadata, not written again with each topic: that took most of the time."""

    def write(self, folder: Path) -> None:
        """Once there are messages, which is when the bag is closed."""
        if self.files[-1].message_count:
            super().write(folder)


class _Run:
    """One run of a series; times are seconds since its start."""

    def __init__(self, series: Series, run: int) -> None:
        self._series, self._run = series, run
        self._bag = shipped(series.recipes[run])
        self._begun_ns = round(BEGAN.timestamp() * 1e6) * 1000 + run * round(TAKT * 1e9)
        self._refused = run == series.refused
        self._names = {"run_id": series.run_id(run), "door_id": self._bag.door_id}

    def messages(self) -> Iterator[tuple[int, str, bytes]]:
        """When it was recorded [ns], topic and serialized message, not quite in order."""
        yield self._patched("/door/recipe", 0.0, 0.02)
        yield from self._status("idle", -0.1, named=False)
        yield from self._status("requested", REQUESTED, named=False, request=True)
        located = REQUESTED + 0.02
        for number in range(1 if self._refused else self._series.seen.shape[1]):
            located = REQUESTED + 0.02 + AGAIN * number
            yield from self._localized(number, located)
        if self._refused:
            yield from self._status("failed", located + 0.1, reason=REASON)
            yield from self._status("idle", located + 0.11, reason=f"no request; before: {REASON}")
            yield self._result(located + 0.08, StageTimes())
            return
        targets, writing = located + 0.15, located + 0.16
        yield self._patched("/path/targets", located, targets)
        link, answer = (float(times[self._run]) for times in (self._series.link, self._series.answer))
        yield from self._status("writing", writing, request=True)
        yield from self._status("verifying", writing + 0.3 * link, request=True)
        yield from self._status("raising", writing + 0.6 * link, request=True)
        ready, acknowledged = writing + link, writing + link + answer
        yield from self._status("ready", ready, request=True, ready=True)
        at, topic, data = self._patched("/abb/target_file", None, ready + 0.02)
        yield at, topic, data
        yield from self._status("acknowledged", acknowledged)
        yield from self._status("clearing", acknowledged + 0.001)
        yield from self._status("milling", acknowledged + 0.03)
        done = acknowledged + 0.03 + self._bag.cycle_time * float(self._series.milling[self._run])
        yield from self._status("done", done)
        if self._series.work is not None:
            yield from self._loads(acknowledged + 0.03, done)
        times = StageTimes(picture_to_pose=0.06, pose_to_targets=0.09)
        times.targets_to_ready, times.request_to_ready = ready - targets, ready - REQUESTED
        yield self._result(done + 0.05, times)

    def _loads(self, begun: float, done: float) -> Iterator[tuple[int, str, bytes]]:
        """What the converter gives: nothing, the surge of coming to speed, then air and cuts in turn until the end."""
        series, run = self._series, self._run
        assert series.work is not None
        cuts, usual = CUTS[series.recipes[run]]
        noise = np.random.default_rng(self._begun_ns % 2**32)
        # A door takes its work, whatever the pace.
        cut = usual * float(series.work[run]) / float(series.milling[run])
        for at in np.arange(begun + 0.1, done, LOOK):
            since, within = at - begun, cuts * (at - begun - SPUN_UP) / (done - begun - SPUN_UP)
            load = AIR + (cut if within % 1.0 < SHARE else 0.0)
            if since < SPUN_UP:
                load = 0.0 if since < OFF else SURGE
            load = max(load + float(noise.normal(0.0, 0.004)), 0.0)
            told = SpindleLoad(run_id=self._names["run_id"], load=load)
            told.header.stamp = self._time(float(at))
            yield self._told("/abb/spindle_load", float(at) + 0.002, told)

    def _ns(self, at: float) -> int:
        return self._begun_ns + round(at * 1e9)

    def _time(self, at: float) -> Time:
        return Time(sec=self._ns(at) // 10**9, nanosec=self._ns(at) % 10**9)

    def _told(self, topic: str, at: float, message: Any) -> tuple[int, str, bytes]:
        return self._ns(at), topic, serialize_message(message)

    def _patched(self, topic: str, stamped: float | None, at: float) -> tuple[int, str, bytes]:
        """The shipped message with this run's id, as long as its own, and another stamp where it has a header."""
        data = self._bag.messages[topic].replace(
            self._bag.run_id.encode(), str(self._names["run_id"]).encode()
        )
        if stamped is not None:
            data = data[:4] + struct.pack("<iI", *divmod(self._ns(stamped), 10**9)) + data[12:]
        return self._ns(at), topic, data

    def _status(
        self,
        state: str,
        since: float,
        named: bool = True,
        request: bool = False,
        ready: bool = False,
        reason: str = "",
    ) -> Iterator[tuple[int, str, bytes]]:
        message = AbbStatus(state=state, since=self._time(since), request=request, ready=ready, reason=reason)
        message.header.stamp = self._time(since + 1e-4)
        if named and not self._refused:
            message.run_id, message.door_id = self._names["run_id"], self._names["door_id"]
        yield self._told("/abb/status", since + 0.01, message)
        if state in ("idle", "requested", "ready", "acknowledged", "failed"):
            yield self._told("/abb/request", since + 0.011, Bool(data=request))
            yield self._told("/abb/ready", since + 0.011, Bool(data=ready))

    def _localized(self, number: int, at: float) -> Iterator[tuple[int, str, bytes]]:
        """What camera, marks and probe say of one picture."""
        series, run = self._series, self._run
        message = deserialize_message(self._bag.messages["/door/localization"], DoorLocalization)
        message.header.stamp, message.run_id, message.duration = self._time(at), self._names["run_id"], 0.025
        message.pose = PoseWithCovariance()
        y, z, rotation = map(float, series.seen[run, number])
        if self._refused:
            message.accepted, message.error_code, message.reason = False, REFUSED, REASON
            message.offset_y = message.offset_z = message.offset_rotation = 0.0
            message.residual = message.quality = 0.0
        else:
            self._place(message.pose, series.seen[run, number], series.stated[0])
            message.offset_y, message.offset_z, message.offset_rotation = y, z, rotation
            message.residual = float(series.residual[run, number])
            yield self._told(
                "/door/pose", at + 0.06, PoseStamped(header=message.header, pose=message.pose.pose)
            )
        yield self._told("/door/localization", at + 0.061, message)
        if series.way is not None:
            moved = TwistStamped(header=message.header)
            way = moved.twist.linear, moved.twist.angular
            way[0].y, way[0].z, way[1].x = map(float, series.way[run, number])
            yield self._told("/camera/moved", at + 0.062, moved)
        if series.probe is None:
            return
        beside = SensorLocalization(sensor="camera", header=message.header, pose=message.pose, **self._names)
        beside.accepted, beside.error_code, beside.reason = (
            message.accepted,
            message.error_code,
            message.reason,
        )
        beside.sees = SEES if message.accepted else [False] * 6
        beside.duration = message.duration
        yield self._told("/sensors/localization", at + 0.06, beside)
        if number == 0 and not self._refused:
            probed = SensorLocalization(sensor=PROBE, accepted=True, sees=SEES, duration=0.002, **self._names)
            probed.header.frame_id, probed.header.stamp = "base_link", self._time(at + 0.01)
            self._place(probed.pose, series.probe[run], series.stated[1])
            yield self._told("/sensors/localization", at + 0.08, probed)

    def _place(self, pose: PoseWithCovariance, offset: Floats, deviations: Floats) -> None:
        x, y, z = self._bag.nominal
        place, turn = pose.pose.position, pose.pose.orientation
        place.x, place.y, place.z = x, y + float(offset[0]), z + float(offset[1])
        turn.x, turn.w = float(np.sin(offset[2] / 2.0)), float(np.cos(offset[2] / 2.0))
        covariance = np.zeros((6, 6))
        covariance[[1, 2, 3], [1, 2, 3]] = deviations**2
        pose.covariance = covariance.ravel()

    def _result(self, at: float, times: StageTimes) -> tuple[int, str, bytes]:
        message = deserialize_message(self._bag.messages["/run/result"], RunResult)
        message.header.stamp, message.run_id, message.times = self._time(at), self._names["run_id"], times
        message.measured, message.worst_feature, message.deviation, message.tolerance = False, "", 0.0, 0.0
        message.message = f"door {self._bag.door_id} milled; nobody measured it"
        if self._refused:
            message.success, message.error_code, message.largest_correction = False, REFUSED, 0.0
            message.target_file = message.sha256 = message.robot_model = ""
            message.message = f"door {self._bag.door_id}: {REASON}"
        return self._told("/run/result", at + 0.01, message)
