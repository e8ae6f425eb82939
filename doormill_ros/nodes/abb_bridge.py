"""Node /abb_bridge: targets in, RAPID target file and ready signal out; serves the action mill_door."""

from __future__ import annotations

import sys
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

from builtin_interfaces.msg import Time
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from rclpy.serialization import serialize_message
from std_msgs.msg import Bool, String

from doormill_interfaces.msg import AbbStatus, DoorLocalization, SensorLocalization, TargetArray
from doormill_ros.abb.controller_names import controller_names
from doormill_ros.abb.handshake.loop import HandshakeLoop
from doormill_ros.abb.handshake.sharing import SharedHandshake
from doormill_ros.abb.handshake.spindle_load import SpindleLoadMeter
from doormill_ros.abb.handshake.state import HandshakeSnapshot, HandshakeState, HandshakeTimeouts
from doormill_ros.abb.link_errors import MillingFaultError
from doormill_ros.abb.signal_paths import PARAMETER as SIGNAL_PATHS
from doormill_ros.abb.signal_paths import signal_paths
from doormill_ros.abb.target_file.rehearsal import PROGRAM, rehearse
from doormill_ros.abb.target_file.target_file import check_handover, render_target_file, write_target_file
from doormill_ros.abb.transport_kind import ANSWER, TransportOptions
from doormill_ros.abb.transports.registry import (
    SIMULATED_TRANSPORT,
    TRANSPORTS,
    addresses,
    open_transport,
    users_of,
)
from doormill_ros.cell.errors import NodeDoubledError
from doormill_ros.cell.graph.door_sensors import chosen_sensors
from doormill_ros.cell.graph.node_names import ABB_BRIDGE, DOOR_SHARES
from doormill_ros.cell.places.layout import load_layout
from doormill_ros.cell.run.run import LOCALIZATION, TARGETS
from doormill_ros.localization.sensors.agreement import rehearse_agreement
from doormill_ros.messages.from_message import program_of
from doormill_ros.nodes.base import topics
from doormill_ros.nodes.base.alive import LEASE
from doormill_ros.nodes.base.found_topics import type_name
from doormill_ros.nodes.base.managed_node import ManagedNode
from doormill_ros.nodes.base.node_parameter import NodeParameter
from doormill_ros.nodes.base.reporting_node import ERROR, OK, WARN
from doormill_ros.nodes.bridge.attendance import CellAttendance
from doormill_ros.nodes.bridge.controller_monitor import ControllerMonitor
from doormill_ros.nodes.bridge.expect_door import ExpectDoorServer
from doormill_ros.nodes.bridge.spindle_watch import SPINDLE_PARAMETER, SpindleWatch
from doormill_ros.nodes.convert.program import program_into
from doormill_ros.nodes.milling.door_inspections import GAUGE_PARAMETER
from doormill_ros.nodes.milling.limit_parameters import limit_parameters
from doormill_ros.nodes.milling.mill_door import MillDoorServer
from doormill_ros.nodes.process.run import run_nodes
from doormill_ros.nodes.sensing.sensors_parameter import SENSORS_PARAMETER
from doormill_ros.pipeline.course import recipe_nodes, stage_of
from doormill_ros.recording.typestores import reader_of
from doormill_ros.robot.description import load_robot
from doormill_ros.units import s_to_ns


def level_of(snapshot: HandshakeSnapshot) -> bytes:
    """Diagnostic level: ERROR for what keeps the robot from going on, WARN for a run that came to nothing."""
    if snapshot.error_code:
        return WARN
    # A fault while milling has no code of the handover: that succeeded.
    return ERROR if snapshot.state is HandshakeState.FAILED else OK


def code_of(snapshot: HandshakeSnapshot) -> int:
    """Code that goes with that level, 0 when nothing is wrong."""
    return MillingFaultError.code if level_of(snapshot) == ERROR else snapshot.error_code


def caution_of(transport: str) -> str:
    """What to do before the cell's robot moves, where the way leads to a real one; empty where there is nothing."""
    return load_robot(load_layout().robot).caution if TRANSPORTS[transport].moves_robot else ""


class AbbBridge(ManagedNode):
    """Owns the handshake with the controller; nothing else writes the target file or the ready signal."""

    PARAMETERS = (
        NodeParameter("transport", SIMULATED_TRANSPORT, "way to the controller", choices=tuple(TRANSPORTS)),
        NodeParameter("address", "out/controller/HOME", addresses()),
        NodeParameter(
            "certificate", "", f"PEM file with the controller's certificate, for {users_of('certificate')}"
        ),
        NodeParameter(
            "insecure", False, f"trust any certificate of the controller, for {users_of('insecure')}"
        ),
        NodeParameter(
            SIGNAL_PATHS,
            "",
            "NETWORK/DEVICE/NAME of signals whose plain name does not do, separated by spaces; over "
            f"{users_of(SIGNAL_PATHS)}",
        ),
        NodeParameter(
            "manual_mode",
            False,
            "in manual mode ask the operator for the remote privilege, for a dry run; over "
            f"{users_of('manual_mode')}",
        ),
        NodeParameter("archive", "out/targets", "folder that keeps a copy of every target file handed over"),
        NodeParameter(
            "shared",
            False,
            "the robot mills shares of doors: goals and the word to mill come from /door_shares",
        ),
        SENSORS_PARAMETER,
        *limit_parameters(at_start=("read", "milling")),  # those are the handshake's
        NodeParameter(
            "limit.answer",
            ANSWER,
            "longest wait for one answer of the controller or its folder [s]",
            0.1,
            600.0,
        ),
        NodeParameter(
            "limit.sign_of_life",
            LEASE,
            "a node of the cell without a sign of life for so long is dead; more on a slow machine [s]",
            LEASE,
            600.0,
        ),
        GAUGE_PARAMETER,
        SPINDLE_PARAMETER,
    )

    handshake: SharedHandshake

    def __init__(self, **kwargs: Any) -> None:
        super().__init__(ABB_BRIDGE, **kwargs)
        self._group = ReentrantCallbackGroup()
        self._apart = MutuallyExclusiveCallbackGroup()
        self._action = MillDoorServer(self, self, self._give_up, self._group)

    def setup(self) -> None:
        """Open the transport, clear the controller, subscribe."""
        self._status = self.publisher(topics.ABB_STATUS)
        self._request = self.publisher(topics.ABB_REQUEST)
        self._ready = self.publisher(topics.ABB_READY)
        self._file = self.publisher(topics.ABB_TARGET_FILE)
        self._shown: tuple[bool, bool] | None = None
        layout = load_layout()
        self._T_flange_tool = layout.T_flange_tool
        sensors = chosen_sensors(layout, self.value(SENSORS_PARAMETER.name))
        transport = open_transport(self.value("transport"), self._transport_options())
        if caution := caution_of(self.value("transport")):
            self.get_logger().warning(caution)
        self.handshake = SharedHandshake(
            transport,
            timeouts=HandshakeTimeouts(
                acknowledge=self.value("limit.read"), milling=self.value("limit.milling")
            ),
            check=check_handover,
            on_change=self._changed,
        )
        self._monitor = ControllerMonitor(self, transport, self.value("manual_mode"))
        self._spindle = SpindleWatch(self, SpindleLoadMeter(transport, lambda: self.handshake.snapshot))
        self._loop = HandshakeLoop(self.handshake, held=True)
        self._loop.start()
        self._monitor.start()
        self._spindle.start()
        needed = recipe_nodes(sensors)
        if self.value("shared"):
            needed = (*needed, DOOR_SHARES)
            self.subscribe(topics.SHARE_GO, self._take_word)
        self._attendance = CellAttendance(
            self,
            needed,
            controller_names(self.value("address")),
            self._action.notify,
            self.value("limit.sign_of_life"),
        )
        self._action.open(self._attendance, sensors, self.value("shared"))
        ExpectDoorServer(self, self.handshake.expect_door, self._group)
        self.subscribe(topics.PATH_TARGETS, self._take_targets)
        self.subscribe(topics.DOOR_LOCALIZATION, self._take_localization)
        self._several = len(sensors) > 1
        if self._several:
            self.subscribe(topics.SENSOR_LOCALIZATION, self._take_sensor)
        # In a group of its own: an order that waits for the controller must not keep it from being taken.
        look_round = self.create_timer(0.1, self.guarded(self._look_round), callback_group=self._apart)
        self.keep(self.destroy_timer, look_round)
        self.every(0.5, self._watch)

    def rehearse(self) -> None:
        """Read a program from its message, render its file and check that; with several sensors, let two agree."""
        read = reader_of(type_name(TargetArray))
        rehearse(program_of(read(serialize_message(program_into(TargetArray(), PROGRAM)))))
        if self._several:
            rehearse_agreement()

    def stop(self) -> None:
        """Give up the run in hand; the handshake lowers ready and removes the file."""
        self._action.cancel()
        self.handshake.abort("the bridge was deactivated by its operator")

    def teardown(self) -> None:
        """Lower ready, remove the file, close the transport."""
        self._action.close()
        self._spindle.stop()
        self._monitor.stop()
        self._loop.stop()

    def destroy_node(self) -> None:
        """Take the action away too: it latches the states of its goals."""
        self._action.destroy()
        super().destroy_node()

    def submit(self, message: TargetArray, request_number: int) -> bytes:
        """Render the target file and hand it to the controller; returns its bytes.

        Args:
            message: Accepted targets.
            request_number: Request for which the door was measured; a later one refuses the file.

        Raises:
            AbbError: The targets cannot be written, the controller can take no file, or the handshake does not.
        """
        self._monitor.require_fit()
        # The message does not carry the tool; path generator and bridge read the same cell.yaml.
        program = replace(program_of(message), tool=self._T_flange_tool)
        data = render_target_file(program, message.run_id)
        self.handshake.submit(message.run_id, message.door_id, data, request_number)
        return data

    def file_away(self, run_id: str, data: bytes) -> Path:
        """Put a copy of a submitted target file into the archive, show it, and return the copy's path.

        Raises:
            TargetFileWriteError: The copy could not be written.
        """
        path = (Path(self.value("archive")) / f"{run_id}.txt").resolve()
        write_target_file(path, data, make_folder=True)
        self._file.publish(String(data=data.decode("ascii")))
        return path

    def _transport_options(self) -> TransportOptions:
        certificate = self.value("certificate")
        return TransportOptions(
            self.value("address"),
            Path(certificate) if certificate else None,
            self.value("insecure"),
            self.value("limit.answer"),
            signal_paths(self.value(SIGNAL_PATHS)),
        )

    def _give_up(self, reason: str) -> None:
        if self.configured:
            self.handshake.abort(reason)

    def _take_word(self, message: String) -> None:
        self._action.give_word(message.data)

    def _take_localization(self, message: DoorLocalization) -> None:
        self._action.deliver(LOCALIZATION, message)

    def _take_sensor(self, message: SensorLocalization) -> None:
        self._action.deliver(stage_of(message.sensor), message)

    def _take_targets(self, message: TargetArray) -> None:
        if not self._action.deliver(TARGETS, message):
            # Of a run before a restart, or of another cell: nobody knows which door they are for.
            self.report(
                WARN,
                f"targets of run {message.run_id!r} were left aside: no goal of this bridge asked for them",
            )

    def _changed(self, snapshot: HandshakeSnapshot) -> None:
        self._action.notify()
        if not self.context.ok():
            return
        now = self.get_clock().now().to_msg()
        ready = snapshot.state is HandshakeState.READY
        status = AbbStatus(
            state=snapshot.state.value,
            reason=snapshot.reason,
            since=_wall_time(snapshot.since),
            run_id=snapshot.run_id,
            door_id=snapshot.door_id,
            request=snapshot.request,
            ready=ready,
            error_code=snapshot.error_code,
        )
        status.header.stamp = now
        if (snapshot.request, ready) != self._shown:  # first: the camera waits for the request
            self._shown = (snapshot.request, ready)
            self._request.publish(Bool(data=snapshot.request))
            self._ready.publish(Bool(data=ready))
        self._status.publish(status)
        said = f"{snapshot.state.value}: {snapshot.reason}"
        self.report(level_of(snapshot), said, error_code=code_of(snapshot))

    def _watch(self) -> None:
        if not self._loop.alive:
            raise RuntimeError(f"the handshake ended: {self._loop.failure!r}; restart the bridge")

    def _look_round(self) -> None:
        """Own the controller and answer goals, unless another bridge does."""
        self._attendance.look()
        hindrance = self._attendance.hindrance()
        if hindrance:
            self._loop.hold()
        elif self._attendance.may_touch:
            self._loop.release()
        self._action.leave_to_another(self._attendance.silent)
        if hindrance and self._health[1] != hindrance:
            self.get_logger().error(hindrance)
            self.report(ERROR, hindrance, error_code=NodeDoubledError.code)


def _wall_time(monotonic: float) -> Time:
    nanoseconds = time.time_ns() - s_to_ns(time.monotonic() - monotonic)
    return Time(sec=nanoseconds // 1_000_000_000, nanosec=nanoseconds % 1_000_000_000)


def main() -> int:
    """Run the node."""
    return run_nodes(AbbBridge)


if __name__ == "__main__":
    sys.exit(main())
