"""One run: start the processes, let things go wrong, wait for the end, ask the judge."""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import random
import signal
import sys
import tempfile
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from multiprocessing import forkserver
from pathlib import Path

from doormill_ros.simulation.controller.rws_server.cabinet import Cabinet
from doormill_ros.simulation.controller.rws_server.server import RwsServer
from support.faults import small_disk
from support.faults.blind_robot import blind_process
from support.faults.bridge import bridge_process
from support.faults.judge import Verdict, judge
from support.faults.proxy import Relay
from support.faults.rapid_robot import rapid_process
from support.faults.scenario import Scenario
from support.faults.world import World
from support.waiting import LIMIT

_FAULT_TIME = 4.0  # how long network and server misbehave after the first request
_LOOK = 0.03
_DOORS_AFTER = 2  # that a run has to mill once all is calm
_context = multiprocessing.get_context("forkserver")
_context.set_forkserver_preload(["__main__", "support.faults.prepared"])


def start_fork_server() -> None:
    """Start what forks the processes of all runs, with this process' path: it would find no module otherwise."""
    before = os.environ.get("PYTHONPATH")
    os.environ["PYTHONPATH"] = os.pathsep.join(path for path in sys.path if path)
    try:
        forkserver.ensure_running()
    finally:
        if before is None:
            del os.environ["PYTHONPATH"]
        else:
            os.environ["PYTHONPATH"] = before


class Process:
    """A process that is started again whenever it died."""

    def __init__(self, entry: object, world: World, scenario: Scenario, *more: object) -> None:
        self._entry = entry
        self._arguments = (world, scenario)
        self._more = more
        self.life = 0
        self._start()

    def _start(self) -> None:
        arguments = (*self._arguments, self.life, *self._more)
        self._process = _context.Process(target=self._entry, args=arguments, daemon=True)
        self._process.start()

    def kill(self) -> bool:
        """Kill -9; whatever it was doing stays as it is. False where it had ended before."""
        with contextlib.suppress(ProcessLookupError):
            os.kill(self._process.pid, signal.SIGKILL)
        self._process.join()
        return self._process.exitcode == -signal.SIGKILL

    def revive(self) -> None:
        """Start it again if it died."""
        if not self._process.is_alive():
            self._process.join()
            self.life += 1
            self._start()


def run(scenario: Scenario) -> Verdict:
    """Play one scenario."""
    start_fork_server()
    with contextlib.ExitStack() as stack:
        root = Path(stack.enter_context(_folder(scenario)))
        world = World.create(root / "run")
        if scenario.kind == "full disk" and not stack.enter_context(small_disk.mounted(world.home)):
            # It is full for the bridge's process then, so that has to write the file.
            scenario = replace(scenario, transport="folder")
        link, server, relay = {}, None, None
        if scenario.transport != "folder":
            server = stack.enter_context(
                RwsServer(
                    Cabinet.create(world.home),
                    1 if scenario.transport == "rws1" else 2,
                    robotware=8 if scenario.transport == "rws2 of 8" else 0,
                )
            )
            relay = Relay(server.port, scenario)
            stack.callback(relay.close)
            link = {
                "url": f"{server.url.rsplit(':', 1)[0]}:{relay.port}",
                "certificate": str(server.certificate),
            }
        early = "early" in scenario.kind
        robot_process = rapid_process if scenario.robot == "rapid" else blind_process
        robot = Process(robot_process, world, scenario) if early else None
        if early:
            time.sleep(0.3)
        bridge = Process(bridge_process, world, scenario, link)
        robot = robot or Process(robot_process, world, scenario)
        try:
            return _play(scenario, world, bridge, robot, server, relay)
        finally:
            bridge.kill()
            robot.kill()


def campaign(
    scenarios: list[Scenario],
    workers: int,
    show: Callable[[Scenario, Verdict, float], None] = lambda _scenario, _verdict, _seconds: None,
) -> list[tuple[Scenario, Verdict]]:
    """Play all scenarios, a few at a time; `show` hears of each as it ends, with how long it took [s]."""

    def play(scenario: Scenario) -> Verdict:
        begin = time.monotonic()
        verdict = run(scenario)
        show(scenario, verdict, time.monotonic() - begin)
        return verdict

    with ThreadPoolExecutor(workers) as pool:
        return list(zip(scenarios, pool.map(play, scenarios), strict=True))


def _play(
    scenario: Scenario,
    world: World,
    bridge: Process,
    robot: Process,
    server: RwsServer | None,
    relay: Relay | None,
) -> Verdict:
    chance = random.Random(f"run/{scenario.seed}")
    _await_request(world, bridge, robot)
    begin = time.monotonic()
    pending = _harness_faults(scenario, chance)
    restarts = 0
    calm_since = None

    def struck() -> int:
        return len(world.entries("faults")) + (relay.hits if relay is not None else 0)

    while time.monotonic() - begin < LIMIT:
        time.sleep(_LOOK)
        elapsed = time.monotonic() - begin
        while pending and elapsed >= pending[0] and _strike(scenario, world, bridge, robot, server):
            world.log("faults", what=scenario.kind)
            pending.pop(0)
        if server is not None and "restarts" in scenario.kind and restarts < struck():
            restarts = struck()
            server.expire_sessions()
            server.drop_streams()
        over = not pending and elapsed > _FAULT_TIME and (struck() > 0 or not scenario.strikes)
        if relay is not None and over:
            relay.active = False
        if scenario.kind == "full disk":
            small_disk.fill(world, full=not over)
        bridge.revive()
        robot.revive()
        if over and calm_since is None:
            calm_since = time.monotonic()
        if calm_since is not None and _milled_since(world, calm_since):
            break
    verdict = judge(world)
    verdict.recovered = calm_since is not None and _milled_since(world, calm_since)
    verdict.faults += relay.hits if relay is not None else 0
    return verdict


def _await_request(world: World, bridge: Process, robot: Process) -> None:
    """Let both sides come up: what strikes earlier strikes nothing."""
    limit = time.monotonic() + LIMIT
    while not world.entries("robot") and time.monotonic() < limit:
        time.sleep(0.02)
        bridge.revive()
        robot.revive()


def _harness_faults(scenario: Scenario, chance: random.Random) -> list[float]:
    """Times at which the harness strikes from outside [s]."""
    outside = ("kill -9 any time", "kill -9 of", "session", "event streams")
    if not any(word in scenario.kind for word in outside):
        return []
    first = scenario.options["when"]
    return sorted(first + chance.uniform(0.0, 1.0) * i for i in range(scenario.faults))


def _strike(
    scenario: Scenario, world: World, bridge: Process, robot: Process, server: RwsServer | None
) -> bool:
    """Strike from outside; False where there was nothing to strike, so that it has to be done again."""
    kind = scenario.kind
    if "of both" in kind:
        return all([bridge.kill(), robot.kill()])
    if "robot program" in kind:
        return robot.kill()
    if "any time" in kind:
        return bridge.kill()
    if "503" in kind and server is not None:
        server.services.sessions.limit = 1 if server.services.sessions.limit > 1 else 70
        server.services.sessions.end_all()
        thief = server.services.sessions.create()
        server.services.sessions.idle_expiry = 0.3 if thief else 300.0
        return True
    if "401" in kind and server is not None:
        held = bool(server.services.sessions.sessions)
        server.expire_sessions()
        return held
    if "streams" in kind and server is not None:
        held = any(group.streams for group in [*server.services.subscriptions.groups.values()])
        server.drop_streams()
        return held
    return False


def _milled_since(world: World, since: float) -> bool:
    """Doors were requested and milled after that moment, one after the other."""
    requested, milled = set(), set()
    for entry in world.entries("robot"):
        if entry["t"] < since:
            continue
        if entry["event"] == "request":
            requested.add(entry["placement"])
        elif entry["event"] == "milled" and entry["placement"] in requested:
            milled.add(entry["placement"])
    return len(milled) >= _DOORS_AFTER


def _folder(scenario: Scenario) -> tempfile.TemporaryDirectory[str]:
    base = "/dev/shm" if os.access("/dev/shm", os.W_OK) else None
    return tempfile.TemporaryDirectory(prefix="faults-", dir=base, ignore_cleanup_errors=True)
