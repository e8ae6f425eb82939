"""Start the nodes of the cell as separate processes and drive them as an integrator would."""

from __future__ import annotations

import gc
import os
import signal
import socket
import subprocess
import threading
import time
from collections import Counter
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import rclpy
from lifecycle_msgs.srv import GetState
from rcl_interfaces.srv import SetParameters
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.parameter import Parameter

from doormill_interfaces.action import MillDoor
from doormill_ros.nodes.base import topics
from doormill_ros.nodes.clients.goal_client import GoalClient
from doormill_ros.nodes.process.mailboxes import lost_mailboxes
from support.waiting import LIMIT

NODES = (
    "bag_recorder",
    "recipe_database",
    "door_localizer",
    "path_generator",
    "abb_bridge",
    "cell_simulator",
)
MANAGED = (*NODES[:-1], "camera_simulator", "controller_simulator")
#: A loaded machine must not turn a good door into a refused one.
PATIENT = {f"limit.{stage}": 120.0 for stage in ("recipe", "picture", "targets", "request", "ready", "read")}
PATIENT |= {"limit.sign_of_life": 30.0, "limit.answer": 30.0}
ASK_AGAIN = 5.0  # s
ASK_ANEW = 20.0  # s, by a client that everybody has to discover again

#: How the reason ends that a node gives when it hears nobody, or is not heard, and where it is looked for [characters].
RENEWED, LAST_WORDS = "so that it can be started again.", 2000


def executable(name: str) -> str:
    """The installed executable that `ros2 run doormill_ros NAME` starts."""
    for prefix in os.environ["AMENT_PREFIX_PATH"].split(os.pathsep):
        path = Path(prefix) / "lib" / "doormill_ros" / name
        if path.is_file():
            return str(path)
    raise FileNotFoundError(f"{name} is in no lib/doormill_ros of AMENT_PREFIX_PATH")


def is_renewed(log: str) -> bool:
    """Whether a node that ended has said that it does so as to be started again."""
    return RENEWED in log[-LAST_WORDS:]


def free_port() -> int:
    """A port of this machine that nobody listens on."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


class CellProcesses:
    """The running nodes, their folder, and a node of the test's own that watches them."""

    def __init__(
        self,
        folder: Path,
        parameters: dict[str, dict[str, Any]] | None = None,
        nodes: Sequence[str] = NODES,
        environment: dict[str, str] | None = None,
    ) -> None:
        self.folder = folder
        self._names = nodes
        self._environment = {**os.environ, **(environment or {})}
        self.processes: dict[str, subprocess.Popen[bytes]] = {}
        self._arguments: dict[str, tuple[str, ...]] = {}
        self._parameters = {
            "bag_recorder": {"bag": folder / "bag"},
            "abb_bridge": {"address": folder / "HOME", "archive": folder / "targets", **PATIENT},
            "cell_simulator": {"controller_simulator:home": folder / "HOME"},
            "path_generator": {"models": folder / "models"},
            "model_monitor": {
                "inspections": folder / "inspections",
                "bags": folder,
                "models": folder / "models",
            },
        }
        for name, values in (parameters or {}).items():
            self._parameters.setdefault(name, {}).update(values)
        (folder / "HOME").mkdir(parents=True)

    def start(self, name: str, *arguments: str) -> None:
        """Start one executable, with further ROS arguments; its output goes to a file of its own."""
        command = [executable(name), "--ros-args"]
        for key, value in self._parameters.get(name, {}).items():
            text = str(value).lower() if isinstance(value, bool) else str(value)
            command += ["-p", f"{key}:={text}"]
        command += arguments
        self._arguments[name] = arguments
        with open(self.folder / f"{name}.log", "ab") as log:
            self.processes[name] = subprocess.Popen(
                command, stdout=log, stderr=subprocess.STDOUT, env=self._environment
            )

    def stop(self, name: str, how: int = signal.SIGINT) -> int:
        """Signal one process and wait for its end; returns the exit status."""
        process = self.processes.pop(name)
        process.send_signal(how)
        try:
            return process.wait(LIMIT)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
            raise AssertionError(f"{name} did not end within {LIMIT} s: {self.log(name)}") from None

    def log(self, name: str) -> str:
        return (self.folder / f"{name}.log").read_text(errors="replace")

    def __enter__(self) -> CellProcesses:
        gc.collect()  # What earlier tests left in cycles of references leaves the network now, not while nodes start.
        rclpy.init()
        for name in self._names:
            self.start(name)
        self.node = Node("test_driver")
        self._executor = SingleThreadedExecutor()
        self._executor.add_node(self.node)
        self._thread = threading.Thread(target=self._executor.spin, daemon=True)
        self._thread.start()
        self._action = GoalClient(self.node, MillDoor, "mill_door")
        self._actions = {"mill_door": self._action}
        self._results = self.subscribe(topics.RUN_RESULT)
        try:
            self.wait_until_up()
        except BaseException:
            self.__exit__()
            raise
        return self

    def __exit__(self, *_: object) -> None:
        self._executor.shutdown(timeout_sec=2.0)
        rclpy.try_shutdown()
        self._thread.join(2.0)
        for process in self.processes.values():
            process.send_signal(signal.SIGINT)
        for name in list(self.processes):
            self.stop(name)

    def wait_until_up(self) -> None:
        """The action is served and every managed node says that it is active."""
        for node in MANAGED:
            if node in self._names or (node.endswith("simulator") and "cell_simulator" in self._names):
                self.wait_until_active(node)
        if "abb_bridge" in self._names:
            assert self._action.wait_for_server(LIMIT), self.log("abb_bridge")

    def wait_until_active(self, node: str) -> None:
        """Asks again and again, now and then by a new client: an answer of a process that was killed never comes."""
        heard: list[str] = []

        def active(client: Any) -> bool:
            future = client.call_async(GetState.Request())
            end = time.monotonic() + 1.0
            while not future.done() and time.monotonic() < end:
                time.sleep(0.01)
            heard.append(future.result().current_state.label if future.done() else "no answer")
            return heard[-1] == "active"

        def asked_anew() -> bool:
            client = self.node.create_client(GetState, f"{node}/get_state")
            end = time.monotonic() + ASK_ANEW
            try:
                while not client.service_is_ready():
                    if time.monotonic() > end or self._ended():
                        heard.append("no service")
                        return False
                    time.sleep(0.02)
                while not (is_active := active(client)) and time.monotonic() < end and not self._ended():
                    time.sleep(0.02)
                return is_active
            finally:
                self.node.destroy_client(client)

        try:
            self.wait(asked_anew)
        except AssertionError as error:
            raise AssertionError(f"/{node}: {dict(Counter(heard))}; {error}") from None

    def _ended(self) -> bool:
        return any(process.poll() is not None for process in self.processes.values())

    def _situation(self) -> str:
        """What may tell why nothing comes: who hears nobody, and what everybody said last."""
        lost = {name: lost_mailboxes(str(process.pid)) for name, process in self.processes.items()}
        said = "\n".join(f"--- {name}\n{self.log(name)[-1500:]}" for name in self.processes)
        return f"this process has lost {lost_mailboxes()}, the others {lost}\n{said}"

    def wait(self, condition: Callable[[], Any], limit: float = LIMIT, pause: float = 0.02) -> Any:
        deadline = time.monotonic() + limit
        while not (value := condition()):
            assert time.monotonic() < deadline, f"waited for {limit:g} s in vain; {self._situation()}"
            for name, process in list(self.processes.items()):
                if process.poll() is not None:
                    status = process.returncode
                    assert is_renewed(self.log(name)), (
                        f"{name} ended by itself with {status}: {self.log(name)}"
                    )
                    self.start(name, *self._arguments[name])
            time.sleep(pause)
        return value

    def ask(self, service_type: Any, name: str, request: Any) -> Any:
        """A service's answer; asks again when it got lost, as a server may not know a new client yet."""
        client = self.node.create_client(service_type, name)
        self.wait(client.service_is_ready)
        futures: list[Any] = []
        asked_at = [0.0]

        def answered() -> Any:
            if not futures or time.monotonic() - asked_at[0] > ASK_AGAIN:
                futures.append(client.call_async(request))
                asked_at[0] = time.monotonic()
            return next((future for future in futures if future.done()), None)

        answer = self.wait(answered).result()
        self.node.destroy_client(client)
        return answer

    def put(self, node: str, **values: object) -> None:
        """Change parameters of a running node."""
        parameters = [Parameter(k, value=v).to_parameter_msg() for k, v in values.items()]
        request = SetParameters.Request(parameters=parameters)
        answer = self.ask(SetParameters, f"{node}/set_parameters", request)
        assert all(result.successful for result in answer.results), answer.results

    def subscribe(self, topic: Any) -> list[Any]:
        """A list that grows by each message of the topic."""
        received: list[Any] = []
        self.node.create_subscription(topic.type, topic.name, received.append, topic.requested)
        return received

    def mill(
        self, door_id: str, limit: float = LIMIT, action: str = "mill_door"
    ) -> tuple[MillDoor.Result, list[str]]:
        """Send the goal; the result and the stages that the feedback named. Says how far it came where none comes."""
        if action not in self._actions:
            self._actions[action] = GoalClient(self.node, MillDoor, action)
        client = self._actions[action]
        assert client.wait_for_server(LIMIT)
        stages: list[str] = []
        before = {result.run_id for result in self._results}
        done = threading.Event()
        answer: list[Any] = []

        def finished(future: Any) -> None:
            answer.append(future.result())
            done.set()

        sent = client.send_goal_async(
            MillDoor.Goal(door_id=door_id), lambda m: stages.append(m.feedback.stage)
        )
        sent.add_done_callback(lambda f: f.result().get_result_async().add_done_callback(finished))
        deadline = time.monotonic() + limit
        while not done.wait(1.0):
            result = None if sent.done() else self._told_otherwise(door_id, before)
            if result is not None:
                return result, stages
            answered = "taken" if sent.done() else "not answered"
            assert time.monotonic() < deadline, (
                f"no result of {door_id} within {limit:g} s; the goal was {answered}, "
                f"stages {stages}; {self._situation()}"
            )
        return answer[0].result, stages

    def _told_otherwise(self, door_id: str, before: set[str]) -> MillDoor.Result | None:
        """What `run/result` says of a goal whose acceptance got lost: its server did not know this client yet."""
        told = next((m for m in self._results if m.door_id == door_id and m.run_id not in before), None)
        if told is None:
            return None
        common = set(told.get_fields_and_field_types()) & set(MillDoor.Result.get_fields_and_field_types())
        return MillDoor.Result(**{name: getattr(told, name) for name in common})
