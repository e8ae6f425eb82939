"""Plays rounds of strikes: a goal, signals to executables at drawn moments, and whether the next door is milled."""

from __future__ import annotations

import gc
import random
import shutil
import signal
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import rclpy
from numpy.typing import NDArray
from rcl_interfaces.srv import SetParameters
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.parameter import Parameter

from doormill_interfaces.action import MillDoor
from doormill_ros.cell.errors import NodeDeadError
from doormill_ros.nodes.base import topics
from doormill_ros.nodes.clients.goal_client import GoalClient
from doormill_ros.nodes.process.mailboxes import Mailboxes
from doormill_ros.recording.bag_reader import read_bag
from doormill_ros.units import ns_to_s
from support.cell_processes import free_port
from support.deaths.leftovers import Leftovers
from support.deaths.naming import Lives, named_after
from support.deaths.oracle import Oracle, Place, Placed, targets_of
from support.deaths.strikes import NODES, STAGES, Round, Strike
from support.deaths.supervisor import Supervisor
from support.source_tree import ROOT
from support.waiting import LIMIT

DOORS = ("thesis_190_0deg", "thesis_1350_0deg")
LIMITS = {
    "recipe": 20.0,
    "picture": 30.0,
    "targets": 30.0,
    "request": 30.0,
    "ready": 20.0,
    "read": 30.0,
    "milling": 60.0,
}
RESULT_LIMIT = 2.0 * sum(LIMITS.values())  # s; a run that has not ended by then has no end
PLACEMENT = "/simulation/door_placement"
TIME_SCALE = 40.0
LONG = 60.0  # s until a door is milled again, of which one wants to know why
NAMED = 2.0  # s after which a refusal names the node that died
#: How far off the doors stand; each of them at a place of its own [m, m, rad].
SCATTER = {"offset_y": 0.008, "offset_z": 0.008, "offset_rotation": 0.03}


@dataclass
class Tally:
    """What came of the strikes."""

    strikes: int = 0
    goals: int = 0
    milled: int = 0
    refused: dict[int, int] = field(default_factory=dict)
    wrong: list[str] = field(default_factory=list)
    without_result: list[str] = field(default_factory=list)
    manual: list[str] = field(default_factory=list)
    died: list[str] = field(default_factory=list)
    renewed: list[str] = field(default_factory=list)  # nodes that ended so as to be started again
    struck: set[tuple[str, bool, str]] = field(default_factory=set)  # node, killed or stopped, stage
    together: set[tuple[str, ...]] = field(default_factory=set)  # stages of the strikes that fell in one run
    named: list[float] = field(default_factory=list)  # from the strike to the refusal that names the node [s]
    late: list[str] = field(default_factory=list)  # those that came too late
    again: list[float] = field(default_factory=list)  # from the first strike to the next milled door [s]
    not_ended: list[str] = field(default_factory=list)  # told as milled, and no robot ended
    seen: int = 0  # times the oracle saw the robot begin
    left: list[str] = field(default_factory=list)  # files that stood there longer than their run
    missed: int = 0  # milled doors of which it did not see the begin
    places: int = 0  # different ones where a door stood then


class Client:
    """Sends goals and hears how they ended: by the action, or on run/result when its server died meanwhile."""

    def __init__(self, oracle: Oracle) -> None:
        self._oracle = oracle
        self.results: list[Any] = []
        self.stage = ""
        self.lives = Lives()
        self._open()

    def _open(self) -> None:
        self._mailboxes = Mailboxes()
        self.context = rclpy.Context()
        rclpy.init(context=self.context)
        self.node = Node("campaign", context=self.context)
        for topic, callback in (
            (topics.DOOR_PLACEMENT, self._place),
            (topics.RUN_RESULT, self.results.append),
        ):
            self.node.create_subscription(topic.type, topic.name, callback, topic.requested)
        self.lives.listen(self.node)
        self._action = GoalClient(self.node, MillDoor, "mill_door")
        self._places = self.node.create_client(SetParameters, "camera_simulator/set_parameters")
        self._executor = SingleThreadedExecutor(context=self.context)
        self._executor.add_node(self.node)
        self._thread = threading.Thread(target=self._executor.spin, daemon=True)
        self._thread.start()

    def close(self) -> None:
        self._executor.shutdown(timeout_sec=2.0)
        rclpy.shutdown(context=self.context)
        self._thread.join(2.0)

    def look(self) -> None:
        """Begin anew where a node that was started again does not hear this process, as nodes do by themselves."""
        if self._mailboxes.look():
            self.close()
            self.node.destroy_node()
            del self.node, self._action, self._places, self._executor
            gc.collect()  # what is left in cycles of references would keep the port that nobody hears
            self._open()

    # Both arguments are needed: with one, rclpy does not tell when the message was sent.
    def _place(self, message: Any, info: Any) -> None:
        self._oracle.placed(placed(message, ns_to_s(info["source_timestamp"])))

    def move(self, draw: random.Random) -> None:
        """Let the doors that are clamped from now on stand elsewhere; nothing when nobody is there to hear it."""
        if self._places.service_is_ready():
            drawn = {name: draw.uniform(-1.0, 1.0) * most for name, most in SCATTER.items()}
            parameters = [Parameter(name, value=value).to_parameter_msg() for name, value in drawn.items()]
            self._places.call_async(SetParameters.Request(parameters=parameters))

    def _feedback(self, message: Any) -> None:
        self.stage = message.feedback.stage

    def mill(self, door: str, limit: float, meanwhile: Callable[[], None] = lambda: None) -> Any:
        """The result of a goal, None when it has none within the limit [s]."""
        self.stage = ""
        deadline = time.monotonic() + limit
        while not self._action.server_is_ready():
            if time.monotonic() > deadline:
                return None
            time.sleep(0.05)
        answer: list[Any] = []
        before = {result.run_id for result in self.results}  # the latest one is told again to who begins anew

        def accepted(future: Any) -> None:
            future.result().get_result_async().add_done_callback(lambda f: answer.append(f.result().result))

        self._action.send_goal_async(MillDoor.Goal(door_id=door), self._feedback).add_done_callback(accepted)
        meanwhile()
        while time.monotonic() < deadline:
            told = [r for r in self.results if r.door_id == door and r.run_id not in before]
            if answer or told:
                return (answer or told)[0]
            time.sleep(0.05)
        return None


def placed(message: Any, sent: float) -> Placed:
    """What a message of simulation/door_placement says.

    Args:
        message: Its stamp is not asked: by a clock that is set, or that a node has not heard yet, it tells nothing.
        sent: When DDS took it, by the machine's own clock [s since the epoch].
    """
    at, turn = message.pose.position, message.pose.orientation
    place = Place((at.x, at.y, at.z), (turn.x, turn.y, turn.z, turn.w))
    return Placed(sent, message.door_id, message.run_id, place)


def good_targets(door: str) -> NDArray[np.float64]:
    """Where the targets of a door's recorded run lie, seen from the door (N, 3) [m]."""
    bag = ROOT / "bags" / door
    (file,) = (m.message.data for m in read_bag(bag, ["/abb/target_file"]))
    (place,) = (placed(m.message, ns_to_s(m.stamp_ns)).place for m in read_bag(bag, [PLACEMENT]))
    return place.seen(targets_of(file.encode()))


@contextmanager
def running(folder: Path) -> Iterator[tuple[Supervisor, Oracle, Client]]:
    """The cell, its judge and its client."""
    home = folder / "HOME"
    home.mkdir(parents=True)
    parameters: dict[str, dict[str, Any]] = {name: {} for name in NODES}
    parameters["recipe_database"] = {"database_url": f"sqlite:///{folder / 'recipes.sqlite'}"}
    parameters["abb_bridge"] = {
        "address": home,
        "archive": folder / "targets",
        **{f"limit.{name}": value for name, value in LIMITS.items()},
    }
    parameters["bag_recorder"] = {"folder": folder / "bags"}
    parameters["path_generator"] = {"models": folder / "models"}
    parameters["model_monitor"] = {
        "inspections": folder / "inspections",
        "bags": folder / "bags",
        "models": folder / "models",
    }
    parameters["operator_page"] = {"port": free_port(), "history": folder / "runs"}
    parameters["cell_simulator"] = {
        "controller_simulator:home": home,
        "controller_simulator:time_scale": TIME_SCALE,
    }
    with (
        Supervisor(folder, parameters) as supervisor,
        Oracle(home, {door: good_targets(door) for door in DOORS}) as oracle,
    ):
        client = Client(oracle)
        try:
            yield supervisor, oracle, client
        finally:
            client.close()


class Game:
    """Goals and strikes in one cell, and what came of them."""

    def __init__(self, supervisor: Supervisor, client: Client, leftovers: Leftovers, seed: int) -> None:
        self.tally = Tally()
        self._supervisor, self._client, self._leftovers = supervisor, client, leftovers
        self._places = random.Random(seed)
        self._milled: list[str] = []
        self._fallen: list[tuple[Strike, int, float]] = []  # strike, goal and when it fell

    def until_milled(self) -> bool:
        """Goal after goal until a door is milled; False when none is by itself."""
        deadline = time.monotonic() + LIMIT
        while time.monotonic() < deadline:
            result = self._goal("a goal between two strikes")
            if result is not None and result.success:
                return True
            time.sleep(0.5)
        return False

    def play(self, strikes: Round, tell: Callable[[str], None]) -> None:
        """Goals until each strike has fallen, and until a door is milled again."""
        self._fallen, tally = [], self.tally
        striking = threading.Thread(target=self._hit, args=(strikes,))
        result = self._goal(str(strikes), striking.start)
        while striking.is_alive():
            result = self._goal(str(strikes))
        striking.join()
        tally.strikes += len(self._fallen)
        tally.struck |= {strike.kind for strike, _, _ in self._fallen}
        if len({goal for _, goal, _ in self._fallen}) == 1:
            tally.together.add(tuple(strike.stage for strike in strikes))
        if not self.until_milled():
            tally.manual.append(str(strikes))
        tally.again.append(time.monotonic() - min(when for _, _, when in self._fallen))
        came_to = "no result" if result is None else f"{result.error_code} {result.message[:60]}"
        tell(f"{', '.join(map(str, strikes))}: {came_to}, milled again {tally.again[-1]:.1f} s after")

    def end(self, oracle: Oracle) -> Tally:
        """What came of all of it."""
        tally = self.tally
        oracle.close()
        begun = b"\n".join(start.data for start in oracle.starts)
        ended = b"\n".join(oracle.named)
        tally.wrong = oracle.faults()
        tally.seen, tally.places = len(oracle.starts), oracle.places()
        tally.missed = sum(run.encode() not in begun for run in self._milled)
        tally.not_ended = [run for run in self._milled if run.encode() not in ended]
        tally.died = self._supervisor.deaths_by_themselves
        tally.renewed = self._supervisor.renewed
        tally.left = self._leftovers.found
        return tally

    def _goal(self, what: str, meanwhile: Callable[[], None] = lambda: None) -> Any:
        tally = self.tally
        tally.goals += 1
        self._client.look()
        self._client.move(self._places)
        self._leftovers.sent()
        result = self._client.mill(DOORS[tally.goals % 2], RESULT_LIMIT, meanwhile)
        if result is not None:
            self._leftovers.told(result.run_id)
        if result is None:
            tally.without_result.append(what)
        elif result.success:
            tally.milled += 1
            self._milled.append(result.run_id)
        else:
            tally.refused[result.error_code] = tally.refused.get(result.error_code, 0) + 1
            if result.error_code == NodeDeadError.code:
                fallen = [(strike, when) for strike, goal, when in self._fallen if goal == tally.goals]
                after = named_after(result.message, fallen, time.monotonic(), self._client.lives)
                tally.named += after
                tally.late += [f"{result.message}: {s:.1f} s after {fallen}" for s in after if s > NAMED]
        return result

    def _hit(self, strikes: Round) -> None:
        for strike in strikes:
            reached = STAGES.index(strike.stage)
            deadline = time.monotonic() + sum(LIMITS.values())
            while (
                self._client.stage not in STAGES or STAGES.index(self._client.stage) < reached
            ) and time.monotonic() < deadline:
                time.sleep(0.005)
            time.sleep(strike.delay)
            self._client.move(self._places)
            self._supervisor.strike(strike.node, signal.SIGKILL if strike.kill else signal.SIGSTOP)
            self._fallen.append((strike, self.tally.goals, time.monotonic()))
            if not strike.kill:
                time.sleep(strike.stopped)
                self._supervisor.strike(strike.node, signal.SIGCONT)


def play(
    folder: Path,
    rounds: list[Round],
    tell: Callable[[str], None] = lambda line: None,
    kept: Path | None = None,
) -> Tally:
    """Play the rounds one after the other in one cell.

    Args:
        folder: Of the cell.
        rounds: What is struck.
        tell: Is given a line a round.
        kept: The nodes' logs are copied there after a round that took long.
    """
    with running(folder) as (supervisor, oracle, client):
        game = Game(supervisor, client, Leftovers(folder / "HOME"), len(rounds))
        if not game.until_milled():
            game.tally.manual.append("the cell did not come up")
            return game.tally
        for number, strikes in enumerate(rounds, 1):
            game.play(strikes, tell)
            if kept is not None and game.tally.again[-1] > LONG:
                (kept / str(number)).mkdir(parents=True, exist_ok=True)
                for log in folder.glob("*.log"):
                    shutil.copy(log, kept / str(number))
        return game.end(oracle)
