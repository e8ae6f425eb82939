"""The cell as containers: `python bench/contained.py`, where a docker daemon runs that this user may speak to.

Builds the image by the Containerfile, starts a container a node by compose.yaml with the simulated cell, mills a door,
kills every node and mills again, takes all down. Exit code 1 when a check came out otherwise, 2 without docker.
"""

from __future__ import annotations

import argparse
import json
import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "test"))

from rich.console import Console
from rich.table import Table

from doormill_ros.cell.graph.readiness import BESIDE, NEEDED
from support.source_tree import ROOT

CONTAINER = ROOT / "deploy" / "container"
NODES = (*NEEDED, *BESIDE, "cell_simulator")
RUN = "/opt/doormill/deploy/doormill-run"
GOAL = (ROOT / "test" / "support" / "booted" / "goal.py").read_text(encoding="utf-8")
BUILT, ANSWER, BACK = 3600.0, 300.0, 120.0  # s


class Containers:
    """The services of compose.yaml.

    Args:
        compose: The command that composes, in words.
    """

    def __init__(self, compose: list[str]) -> None:
        self._compose = [*compose, "-f", str(CONTAINER / "compose.yaml"), "--profile", "simulated"]

    def compose(self, *arguments: str, given: str = "", check: bool = True) -> str:
        """What compose says.

        Raises:
            RuntimeError: It failed, and `check` is set.
        """
        done = subprocess.run(
            [*self._compose, *arguments], input=given, capture_output=True, text=True, timeout=ANSWER
        )
        if check and done.returncode:
            raise RuntimeError(f"{' '.join(arguments)}: {done.stdout[-1000:]} {done.stderr[-1000:]}")
        return done.stdout.strip()

    def process(self, node: str) -> int:
        """Process number of a node's container, 0 while it does not run."""
        found = docker("inspect", "--format", "{{.State.Pid}}", self.compose("ps", "--quiet", node))
        return int(found.strip())

    def ready(self) -> None:
        """Wait until the cell is ready."""
        until, said = time.monotonic() + BACK, ""
        while time.monotonic() < until:
            said = self.compose("exec", "-T", "recipe_database", RUN, "health", "--wait", "20", check=False)
            if said == "ready":
                return
        raise TimeoutError(said)

    def mill(self) -> None:
        """Have a door milled."""
        command = ("exec", "-T", "recipe_database", RUN, "python", "-", "standard_door")
        result = json.loads(self.compose(*command, given=GOAL).splitlines()[-1])
        if not (result["success"] and result["measured"]):
            raise RuntimeError(str(result))

    def kill(self, node: str) -> None:
        """Kill a node's process as the kernel would, wait for it to be back, and have a door milled."""
        before = self.process(node)
        os.kill(before, signal.SIGKILL)
        until = time.monotonic() + BACK
        while self.process(node) in (before, 0):
            if time.monotonic() > until:
                raise TimeoutError(f"{node} did not come back within {BACK:g} s")
            time.sleep(0.5)
        self.ready()
        self.mill()


def docker(*arguments: str) -> str:
    """What docker says; subprocess.CalledProcessError when it fails."""
    command = ["docker", *arguments]
    return subprocess.run(command, check=True, capture_output=True, text=True, timeout=BUILT).stdout


def composing() -> list[str]:
    """The command that composes here: docker's own, or the one before it; nothing without either."""
    if shutil.which("docker") is None or subprocess.run(["docker", "info"], capture_output=True).returncode:
        return []
    if subprocess.run(["docker", "compose", "version"], capture_output=True).returncode == 0:
        return ["docker", "compose"]
    return ["docker-compose"] if shutil.which("docker-compose") else []


def play(containers: Containers) -> list[tuple[str, str]]:
    """Every check with what came instead, empty where it came."""
    checks: list[tuple[str, Callable[[], object]]] = [
        ("the containers start", lambda: containers.compose("up", "--detach")),
        ("the cell is ready", containers.ready),
        ("a door is milled", containers.mill),
    ]
    checks += [
        (f"{node}, killed, is there again, and a door is milled", lambda node=node: containers.kill(node))
        for node in NODES
    ]
    rows = []
    for what, check in checks:
        try:
            check()
        except (RuntimeError, TimeoutError, subprocess.SubprocessError) as error:
            rows.append((what, str(error)))
        else:
            rows.append((what, ""))
    return rows


def main() -> int:
    """Build, compose, print the table."""
    argparse.ArgumentParser(description=__doc__).parse_args()
    compose = composing()
    if not compose:
        print("no docker daemon answers, or nothing composes: install docker with compose", file=sys.stderr)
        return 2
    begun = time.monotonic()
    docker("build", "--network", "host", "-f", str(CONTAINER / "Containerfile"), "-t", "doormill", str(ROOT))
    os.environ.setdefault("ROS_DOMAIN_ID", "171")
    containers = Containers(compose)
    try:
        rows = play(containers)
    finally:
        containers.compose("down", "--volumes")
    version = docker("version", "--format", "{{.Server.Version}}").strip()
    title = (
        f"Containers by docker {version}, {' '.join(compose)}, {(time.monotonic() - begun) / 60.0:.1f} min"
    )
    table = Table(title=title)
    table.add_column("what was wanted")
    table.add_column("came")
    for what, instead in rows:
        table.add_row(what, instead or "as wanted")
    table.add_row("came otherwise", str(sum(bool(instead) for _, instead in rows)))
    Console(width=150).print(table)
    return 1 if any(instead for _, instead in rows) else 0


if __name__ == "__main__":
    sys.exit(main())
