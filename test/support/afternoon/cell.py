"""The cell of the afternoon: every executable of a real one, the controller behind a wire, and a clock to set."""

from __future__ import annotations

import os
import signal
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from resource import RLIMIT_FSIZE, prlimit
from typing import Any

from rcl_interfaces.srv import SetParameters
from rclpy.parameter import Parameter

from doormill_interfaces.action import MillDoor
from support.afternoon.faults import Fault
from support.cell_processes import free_port
from support.clock_to_set import ClockToSet
from support.deaths.campaign import LIMITS, TIME_SCALE, Client, good_targets
from support.deaths.oracle import Oracle
from support.deaths.strikes import STAGES
from support.deaths.supervisor import Supervisor
from support.faults.proxy import Relay
from support.faults.scenario import Scenario
from support.waiting import LIMIT

DOORS = ("thesis_190_0deg", "thesis_1350_0deg", "thesis_1350_2deg")
NODES = (
    "recipe_database",
    "door_localizer",
    "path_generator",
    "abb_bridge",
    "bag_recorder",
    "operator_page",
    "cell_simulator",
)
CLOCK_PERIOD = 0.1  # s
ASK_AGAIN = 5.0  # s
FULL = 300_000  # bytes that a file may have on the full disk
CREDENTIALS = {"DOORMILL_CONTROLLER_USER": "Default User", "DOORMILL_CONTROLLER_PASSWORD": "robotics"}


class AfternoonClient(Client):
    """Sets the clock, clamp and camera, and sends goals."""

    def __init__(self, oracle: Oracle) -> None:
        super().__init__(oracle)
        self.clock = ClockToSet(self.node, CLOCK_PERIOD)
        self.ended = threading.Event()  # no goal is in hand
        self._camera = self.node.create_client(SetParameters, "camera_simulator/set_parameters")
        self._controller = self.node.create_client(SetParameters, "controller_simulator/set_parameters")

    def mill(self, door: str, limit: float, meanwhile: Callable[[], None] = lambda: None) -> Any:
        """See the base class."""
        self.ended.clear()
        try:
            return super().mill(door, limit, meanwhile)
        finally:
            self.ended.set()

    def second(self, door: str, limit: float) -> Any:
        """The result of a goal beside the one in hand, None when it has none within the limit [s]."""
        answer: list[Any] = []

        def accepted(future: Any) -> None:
            future.result().get_result_async().add_done_callback(lambda f: answer.append(f.result().result))

        deadline = time.monotonic() + limit
        self._action.send_goal_async(MillDoor.Goal(door_id=door)).add_done_callback(accepted)
        while not answer and time.monotonic() < deadline:
            time.sleep(0.05)
        return answer[0] if answer else None

    def set_clock(self, step: float) -> None:
        """Set the clock forwards or back [s]."""
        self.clock.shift += step

    def set_camera(self, pictures: bool) -> None:
        """Plug the camera in or pull it."""
        self._set(self._camera, "pictures", pictures)

    def set_clamp(self, clamped: bool) -> None:
        """Open the clamp, or let the next door be clamped."""
        self._set(self._controller, "clamped", clamped)

    def _set(self, client: Any, name: str, value: bool) -> None:
        """Asks again until it is answered: left as it is, a fault would not end."""
        deadline = time.monotonic() + LIMIT
        while time.monotonic() < deadline:
            if client.service_is_ready():
                parameter = Parameter(name, value=value).to_parameter_msg()
                future = client.call_async(SetParameters.Request(parameters=[parameter]))
                asked = time.monotonic()
                while not future.done() and time.monotonic() < asked + ASK_AGAIN:
                    time.sleep(0.01)
                if future.done():
                    return
            time.sleep(0.05)


@dataclass
class AfternoonCell:
    """The running cell with what can be done to it."""

    folder: Path
    supervisor: Supervisor
    oracle: Oracle
    client: AfternoonClient
    wire: Relay

    def strike(self, fault: Fault, meanwhile: Callable[[], None]) -> None:
        """Let a fault begin and end; returns when all is as before, apart from what died."""
        reached, deadline = STAGES.index(fault.stage), time.monotonic() + sum(LIMITS.values())
        while self.client.stage not in STAGES or STAGES.index(self.client.stage) < reached:
            if self.client.ended.is_set() or time.monotonic() > deadline:
                break
            time.sleep(0.005)
        time.sleep(fault.delay)
        with self._during(fault, meanwhile):
            time.sleep(fault.lasts)

    @contextmanager
    def _during(self, fault: Fault, meanwhile: Callable[[], None]) -> Iterator[None]:
        kind = fault.kind
        if kind == "kill -9":
            self.supervisor.strike(fault.node, signal.SIGKILL)
            yield
        elif kind == "stop and continue":
            self.supervisor.strike(fault.node, signal.SIGSTOP)
            yield
            self.supervisor.strike(fault.node, signal.SIGCONT)
        elif kind == "network of the controller cut":
            self.wire.active = True
            yield
            self.wire.active = False
        elif kind == "camera pulled":
            self.client.set_camera(False)
            yield
            self.client.set_camera(True)
        elif kind == "folder of target files gone":
            with _displaced(self.folder / "targets"):
                yield
        elif kind == "disk of the recorder full":
            process = self.supervisor.process("bag_recorder")
            before = prlimit(process.pid, RLIMIT_FSIZE)
            prlimit(process.pid, RLIMIT_FSIZE, (FULL, before[1]))
            yield
            if process.poll() is None:
                prlimit(process.pid, RLIMIT_FSIZE, before)
        elif kind == "clock set":
            self.client.set_clock(fault.step)
            yield
        elif kind == "clamp opened":
            self.client.set_clamp(False)
            yield
            self.client.set_clamp(True)
        elif kind == "other goal meanwhile":
            meanwhile()
            yield
        else:
            yield


@contextmanager
def _displaced(folder: Path) -> Iterator[None]:
    """A file stands where the folder was."""
    away = folder.with_name(f"{folder.name}.away")
    folder.mkdir(exist_ok=True)
    os.rename(folder, away)
    folder.touch()
    yield
    folder.unlink()
    os.rename(away, folder)


@contextmanager
def running(folder: Path) -> Iterator[AfternoonCell]:
    """The cell, its judge and its client; the folder is made."""
    home, port = folder / "HOME", free_port()
    home.mkdir(parents=True)
    wire = Relay(port, Scenario(0, "dropped connections", options={"probability": 1.0}))
    wire.active = False
    parameters: dict[str, dict[str, Any]] = {
        "recipe_database": {"database_url": f"sqlite:///{folder / 'recipes.sqlite'}"},
        "path_generator": {"models": folder / "models"},
        "abb_bridge": {
            "transport": "rws1",
            "address": f"http://127.0.0.1:{wire.port}",
            "archive": folder / "targets",
            **{f"limit.{name}": value for name, value in LIMITS.items()},
        },
        "bag_recorder": {"folder": folder / "bags", "catalogue": "none"},
        "operator_page": {"port": 0, "history": folder / "runs", "audit": folder / "audit"},
        "cell_simulator": {
            "controller_simulator:home": home,
            "controller_simulator:time_scale": TIME_SCALE,
            "controller_simulator:web_services": "rws1",
            "controller_simulator:web_services_port": port,
        },
    }
    timed = {name: {**parameters.get(name, {}), "use_sim_time": "true"} for name in NODES}
    with (
        Supervisor(folder, timed) as supervisor,
        Oracle(home, {door: good_targets(door) for door in DOORS}) as oracle,
    ):
        client = AfternoonClient(oracle)
        try:
            with client.clock.running():
                yield AfternoonCell(folder, supervisor, oracle, client, wire)
        finally:
            client.close()
            wire.close()
