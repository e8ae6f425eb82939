"""Clients that others wrote for real controllers make their ordinary calls on the project's own controller.

Behind the web services runs the virtual controller with the project's modules: every signal, datum, state and file that
a call names is the project's own. What does not work is named, and is exactly that.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest
from abb_motion_program_exec import MotionProgram, MotionProgramExecClient, fine, jointtarget, v50
from abb_robot_client import rws as public
from rwswrap.RWS import RWS as RWS2

from doormill_ros.simulation.controller.cabinet.cell import DOOR_CLAMPED
from doormill_ros.simulation.controller.controller import VirtualController
from doormill_ros.simulation.controller.motions.arm import ControllerArm
from doormill_ros.simulation.controller.rws_server.running import served_cabinet
from doormill_ros.simulation.controller.rws_server.server import RwsServer
from support.waiting import LIMIT, until

USER, PASSWORD = "Default User", "robotics"
DIGITAL = ("doPathRequest", "doPathReady", "doPathFault", "doPathBusy", "doPathDone")
TEXT = b"1;2;3;\n" * 40

Call = Callable[[], object]

#: Calls of abb-robot-client that come to nothing, and why.
REST_OF_ROBOT_CLIENT = {
    # The signal is the program's own (access level Default): a controller refuses it with 403 as well.
    "set_analog_io aoSpindleSpeed",
    # The client asks for an address that begins with its own address twice.
    "request_rmmp",
    # The one motion task cannot be taken away from a controller.
    "deactivate_task",
}
#: Calls of abb-motion-program-exec: its own RAPID program has to be loaded, with its signals.
REST_OF_MOTION_PROGRAM = {
    "execute_motion_program and its log",
    "get_current_cmdnum",
    "get_queued_cmdnum",
    "get_current_preempt_number",
    "stop_egm",
    "enable_motion_logging",
    "get_motion_logging_enabled",
}
#: Calls of rwswrap: modules are not exchanged over the services, and there is no I/O device.
REST_OF_RWSWRAP = {"load_module", "unload_module", "load_RAPID", "set_io_signal"}


@pytest.fixture
def controller(tmp_path: Path, arm: ControllerArm) -> Iterator[VirtualController]:
    """Waits for a start with the clamp open."""
    virtual = VirtualController(tmp_path, arm)
    virtual.cell.set_input(DOOR_CLAMPED, 0)
    thread = threading.Thread(target=virtual.serve, daemon=True)
    thread.start()
    yield virtual
    virtual.stop()
    thread.join(LIMIT)


def outcome(calls: dict[str, Call]) -> tuple[set[str], dict[str, str]]:
    """Names of the calls that worked, and of the others with what they said."""
    worked, failed = set(), {}
    for name, call in calls.items():
        try:
            assert call() is not False, "said no"
            worked.add(name)
        except Exception as error:
            failed[name] = f"{type(error).__name__}: {error}"
    return worked, failed


def subscribes(client: public.RWS, kind: str, change: Call, param: object = None) -> Call:
    """Subscribe, make a change, and wait for its event."""

    def call() -> bool:
        events: list[object] = []
        resource = public.SubscriptionResourceType[kind]
        high = kind in ("Signal", "PersVar")
        priority = (
            public.SubscriptionResourcePriority.High if high else public.SubscriptionResourcePriority.Medium
        )
        request = public.SubscriptionResourceRequest(resource, priority, param)
        subscription = client.subscribe([request], events.append)
        begin = time.monotonic()
        while not any(type(event).__module__.startswith("abb_robot_client") for event in events):
            change()
            time.sleep(0.05)
            if time.monotonic() - begin > LIMIT:
                return False
        subscription.close()
        return True

    return call


def test_abb_robot_client(controller: VirtualController, tmp_path: Path) -> None:
    cabinet = served_cabinet(tmp_path, controller.io, lambda: controller)
    with RwsServer(cabinet, 1) as server:
        client = public.RWS(server.url)
        turn = iter(range(10_000))
        panel, levels = controller.panel, controller.io

        def motors() -> None:
            panel.motors(next(turn) % 2 == 0)

        def stopped_and_started() -> None:
            panel.stop() if panel.running else panel.start()

        calls: dict[str, Call] = {
            "get_controller_state": lambda: client.get_controller_state() == "motoron",
            "get_operation_mode": lambda: client.get_operation_mode() == "AUTO",
            "get_tasks": lambda: client.get_tasks()["T_ROB1"].motiontask,
            "activate_task": lambda: client.activate_task("T_ROB1"),
            "deactivate_task": lambda: client.deactivate_task("T_ROB1"),
            "resetpp": client.resetpp,
            "start": lambda: (client.start(), until(lambda: panel.running)),
            "get_execution_state": lambda: client.get_execution_state().ctrlexecstate == "running",
            **{
                f"get_digital_io {name}": lambda name=name: client.get_digital_io(name) == levels.read(name)
                for name in DIGITAL
            },
            "set_digital_io doPathReady": lambda: (
                client.set_digital_io("doPathReady", 1),
                levels.read("doPathReady") == 1 or 1 / 0,
                client.set_digital_io("doPathReady", 0),
            ),
            "get_analog_io aoSpindleSpeed": lambda: client.get_analog_io("aoSpindleSpeed") == 0.0,
            "set_analog_io aoSpindleSpeed": lambda: client.set_analog_io("aoSpindleSpeed", 100.0),
            "get_analog_io goPathReady": lambda: client.get_analog_io("goPathReady") == 0,
            "set_analog_io goPathReady": lambda: (
                client.set_analog_io("goPathReady", 4711),
                levels.read("goPathReady") == 4711 or 1 / 0,
            ),
            "get_rapid_variables": lambda: any(
                item["name"] == "expectedDoor" for item in client.get_rapid_variables()
            ),
            "get_rapid_variable expectedDoor": lambda: client.get_rapid_variable("expectedDoor") == '""',
            "set_rapid_variable expectedDoor": lambda: (
                client.set_rapid_variable("expectedDoor", '"door_1"'),
                controller.program.read("expectedDoor") == "door_1" or 1 / 0,
            ),
            "get_rapid_variable_num requestNumber": lambda: (
                client.get_rapid_variable_num("requestNumber") == controller.program.read("requestNumber")
            ),
            "set_rapid_variable_num seenNext": lambda: (
                client.set_rapid_variable_num("seenNext", 3),
                controller.program.read("seenNext") == 3 or 1 / 0,
            ),
            "get_jointtarget": lambda: np.allclose(
                client.get_jointtarget().robax, controller.current_joints()
            ),
            "get_robtarget": lambda: client.get_robtarget(tool="toolMill").trans[0] > 500.0,
            "get_speedratio": lambda: client.get_speedratio() == 100.0,
            "set_speedratio": lambda: (
                client.set_speedratio(60),
                panel.state.speed_override == 60.0 or 1 / 0,
            ),
            "subscribe Signal": subscribes(
                client, "Signal", lambda: levels.write("doPathReady", next(turn) % 2), "doPathReady"
            ),
            "subscribe PersVar": subscribes(
                client,
                "PersVar",
                lambda: controller.program.write("expectedDoor", f'"door_{next(turn)}"'),
                "expectedDoor",
            ),
            "subscribe ExecutionState": subscribes(client, "ExecutionState", stopped_and_started),
            "stop": lambda: (client.stop(), until(lambda: not panel.running)),
            "set_controller_state": lambda: client.set_controller_state("motoroff"),
            "subscribe ControllerState": subscribes(client, "ControllerState", motors),
            "subscribe Elog": subscribes(client, "Elog", motors),
            "read_event_log": lambda: client.read_event_log()[0].code in (10010, 10011),
            "upload_file HOME": lambda: client.upload_file("$home/Hei2.txt", TEXT),
            "read_file HOME": lambda: client.read_file("$home/Hei2.txt") == TEXT,
            "list_files HOME": lambda: "Hei2.txt" in client.list_files("$home"),
            "delete_file HOME": lambda: (
                client.delete_file("$home/Hei2.txt"),
                (tmp_path / "Hei2.txt").exists() and 1 / 0,
            ),
            "upload_file RAMDISK": lambda: client.upload_file(f"{client.get_ramdisk_path()}/a.bin", TEXT),
            "try_create_ipc_queue": lambda: (
                client.try_create_ipc_queue("pc") and not client.try_create_ipc_queue("pc")
            ),
            "send_ipc_message": lambda: client.send_ipc_message("pc", "hello", "pc"),
            "request_rmmp": lambda: (panel.stop(), client.request_rmmp(timeout=1)),
        }
        cabinet.answers_privilege = "GRANTED"
        worked, failed = outcome(calls)
        client.close()
    assert set(failed) == REST_OF_ROBOT_CLIENT, failed
    assert (len(calls), len(worked)) == (43, 40)


def test_abb_motion_program_exec(controller: VirtualController, tmp_path: Path) -> None:
    cabinet = served_cabinet(tmp_path, controller.io, lambda: controller)
    home = jointtarget(np.array([0.0, -40.0, 30.0, 0.0, 10.0, 0.0]), np.zeros(6))
    with RwsServer(cabinet, 1) as server:
        client = MotionProgramExecClient(server.url)
        program = MotionProgram()
        program.MoveAbsJ(home, v50, fine)
        calls: dict[str, Call] = {
            "is_motion_program_running": lambda: not client.is_motion_program_running(),
            "execute_motion_program without its end": lambda: (
                controller.panel.motors(False),
                controller.panel.motors(True),
                client.execute_motion_program(program, wait=False),
                until(lambda: controller.panel.running),
                list(cabinet.ramdisk.glob("motion_program*")) or 1 / 0,
            ),
            "stop_motion_program": lambda: (
                client.stop_motion_program(),
                until(lambda: not controller.panel.running),
            ),
            "wait_motion_program_complete": client.wait_motion_program_complete,
            "execute_motion_program and its log": lambda: client.read_motion_program_result_log(0),
            "get_current_cmdnum": client.get_current_cmdnum,
            "get_queued_cmdnum": client.get_queued_cmdnum,
            "get_current_preempt_number": client.get_current_preempt_number,
            "stop_egm": client.stop_egm,
            "enable_motion_logging": client.enable_motion_logging,
            "get_motion_logging_enabled": client.get_motion_logging_enabled,
        }
        worked, failed = outcome(calls)
    assert set(failed) == REST_OF_MOTION_PROGRAM, failed
    assert (len(calls), len(worked)) == (11, 4)


def test_rwswrap(controller: VirtualController, tmp_path: Path) -> None:
    cabinet = served_cabinet(tmp_path, controller.io, lambda: controller)
    panel = controller.panel
    with RwsServer(cabinet, 2) as server:
        client = RWS2(
            server.url, username=USER, password=PASSWORD, verify=str(server.certificate), module="DoorLink"
        )

        def accepted(answer: object) -> bool:
            return answer.status_code in (200, 201, 202, 204)

        calls: dict[str, Call] = {
            "get_exec_state": lambda: client.get_exec_state() == "stopped",
            "get_modules": lambda: {"DoorMill", "DoorLink"} <= set(client.get_modules()),
            "toggle_motors": lambda: accepted(client.toggle_motors(0)) and accepted(client.toggle_motors(1)),
            "toggle_mastership": lambda: (
                accepted(client.toggle_mastership(1)) and accepted(client.toggle_mastership(0))
            ),
            "reset_pp": lambda: accepted(client.reset_pp()),
            "start_RAPID": lambda: (client.start_RAPID(), until(client.is_running)),
            "get_rapid_variable": lambda: (
                client.get_rapid_variable("expectedDoor", module="DoorLink") == '""'
            ),
            "set_rapid_variable": lambda: (
                accepted(client.set_rapid_variable("expectedDoor", '"door_2"', module="DoorLink"))
                and controller.program.read("expectedDoor") == "door_2"
            ),
            "get_rapid_variable_properties": lambda: accepted(
                client.get_rapid_variable_properties("expectedDoor")
            ),
            "stop_RAPID": lambda: (client.stop_RAPID(), until(lambda: not panel.running)),
            "load_module": lambda: accepted(client.load_module("arrs_mod")),
            "unload_module": lambda: accepted(client.unload_module("arrs_mod")),
            "load_RAPID": lambda: accepted(client.load_RAPID()),
            "set_io_signal": lambda: accepted(client.set_io_signal()),
        }
        worked, failed = outcome(calls)
    assert set(failed) == REST_OF_RWSWRAP, failed
    assert (len(calls), len(worked)) == (14, 10)
