"""The page as a process of its own beside the nodes of a cell, as an integrator runs it."""

from __future__ import annotations

import re
import signal
import socket
import subprocess
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

import httpx
import pytest
import yaml

from doormill_ros.nodes.base import topics
from support.cell_processes import NODES, CellProcesses, executable, free_port
from support.waiting import LIMIT

DOOR = "thesis_190_0deg"
PAGE = "operator_page"


class Beside:
    """The cell, a client of its page, and what the page showed."""

    def __init__(self, folder: Path) -> None:
        self.port, self.folder = free_port(), folder
        self.tokens = folder / "tokens.yaml"
        written = {"history": folder / "runs", "audit": folder / "audit"}
        # A run can be held at its picture for longer than anything here is waited for.
        patient = {"limit.picture": 600.0}
        parameters = {PAGE: {"port": self.port, "tokens": self.tokens, **written}, "abb_bridge": patient}
        self.cell = CellProcesses(folder, parameters, (*NODES, PAGE))
        self.url = f"http://127.0.0.1:{self.port}"

    def state(self, until: Callable[[dict[str, Any]], Any]) -> dict[str, Any]:
        """What the page shows once it is as wanted."""
        deadline, shown = time.monotonic() + LIMIT, {}
        while True:
            try:
                shown = httpx.get(f"{self.url}/state", timeout=LIMIT).json()
            except httpx.TransportError:
                shown = {}
            if shown and until(shown):
                return shown
            assert time.monotonic() < deadline, (shown, self.cell.log(PAGE))
            time.sleep(0.02)

    def order(self, path: str, role: str, **body: str) -> httpx.Response:
        token = yaml.safe_load(self.tokens.read_text())[role]
        headers = {"Authorization": f"Bearer {token}"}
        return httpx.post(f"{self.url}/control/{path}", json=body, headers=headers, timeout=LIMIT)


@pytest.fixture(scope="module")
def beside(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Beside]:
    found = Beside(tmp_path_factory.mktemp("beside"))
    with found.cell:
        found.cell.wait_until_active(PAGE)
        yield found


def test_a_door_is_watched_from_its_order_to_its_end(beside: Beside) -> None:
    assert "<title>" in httpx.get(beside.url, timeout=LIMIT).text
    beside.state(lambda s: s["state"] and s["control"] and not s["run_id"])
    answer = beside.order("mill", "operate", door_id=DOOR)
    assert answer.status_code == 202, answer.text
    seen: list[str] = []

    def ended(shown: dict[str, Any]) -> bool:
        if shown["door_id"] == DOOR and shown["state"] not in seen:
            seen.append(shown["state"])
        return bool(shown["history"]) and shown["picture"] is not None and not shown["run_id"]

    last = beside.state(ended)
    assert len(seen) >= 2, seen
    assert (last["history"][0]["door_id"], last["history"][0]["success"]) == (DOOR, True)
    picture = httpx.get(f"{beside.url}/picture/{last['picture']['number']}", timeout=LIMIT)
    assert picture.headers["content-type"].startswith("image/")


def test_killed_and_started_again_it_knows_what_was(beside: Beside) -> None:
    before = beside.state(lambda s: s["history"] and not s["run_id"])["history"]
    tokens = beside.tokens.read_bytes()
    assert beside.cell.stop(PAGE, signal.SIGKILL) == -signal.SIGKILL
    with pytest.raises(httpx.TransportError):
        httpx.get(beside.url, timeout=5.0)
    beside.cell.start(PAGE)
    after = beside.state(lambda s: s["state"] and s["history"])
    assert [run["run_id"] for run in after["history"]] == [run["run_id"] for run in before]
    assert beside.tokens.read_bytes() == tokens
    # The tablet goes on with the token that it was told.
    beside.cell.wait_until_active(PAGE)
    # An active page may not have found the bridge yet; it says so and takes nothing.
    beside.cell.wait(lambda: beside.order("mill", "engineer", door_id="no such door").status_code == 202)
    refused = beside.state(lambda s: len(s["history"]) > len(before) and not s["run_id"])
    assert refused["history"][0]["error_code"] == 140


def test_a_run_in_hand_is_taken_up_by_a_page_started_meanwhile(beside: Beside) -> None:
    beside.cell.stop(PAGE)
    recipes = beside.cell.subscribe(topics.DOOR_RECIPE)
    before = beside.cell.wait(lambda: recipes and recipes[-1].run_id)
    # A camera that sends nothing holds the run; a node that is stopped would be dead to DDS after a while.
    beside.cell.put("camera_simulator", pictures=False)
    with ThreadPoolExecutor(1) as pool:
        try:
            goal = pool.submit(beside.cell.mill, DOOR)
            beside.cell.wait(lambda: recipes[-1].run_id != before)
            beside.cell.start(PAGE)
            shown = beside.state(lambda s: s["run_id"])
            assert not goal.done()
        finally:
            beside.cell.put("camera_simulator", pictures=True)
        result, _ = goal.result()
    assert result.success, result.message
    assert (shown["run_id"], shown["door_id"]) == (result.run_id, DOOR)
    assert result.run_id not in {run["run_id"] for run in shown["history"]}
    ended = beside.state(lambda s: any(run["run_id"] == result.run_id for run in s["history"]))
    assert (ended["run_id"], ended["history"][0]["success"]) == ("", True)


@contextmanager
def another(folder: Path, name: str, **parameters: object) -> Iterator[tuple[subprocess.Popen[bytes], Path]]:
    """A second page under a name of its own, and its log."""
    command = [executable(PAGE), "--ros-args", "-r", f"__node:={name}"]
    for key, value in {"history": folder / name, **parameters}.items():
        command += ["-p", f"{key}:={value}"]
    log = folder / f"{name}.log"
    with log.open("wb") as stream:
        process = subprocess.Popen(command, stdout=stream, stderr=subprocess.STDOUT)
    try:
        yield process, log
    finally:
        process.kill()
        process.wait()


def test_without_a_file_of_tokens_it_only_shows(beside: Beside) -> None:
    with another(beside.folder, "shown_page", port=0) as (process, log):
        beside.cell.wait(lambda: "]: active" in log.read_text())
        url = re.search(r"operator's page at (http://127\.0\.0\.1:\d+)/", log.read_text())[1]
        assert httpx.get(f"{url}/state", timeout=LIMIT).json()["control"] is False
        assert httpx.post(f"{url}/control/cancel", timeout=LIMIT).status_code == 404
        process.send_signal(signal.SIGTERM)
        assert process.wait(LIMIT) == 0


@pytest.mark.parametrize("what", ["port", "tokens"])
def test_what_it_cannot_use_is_said_and_tried_again_until_it_can(beside: Beside, what: str) -> None:
    tokens = beside.folder / "readable.yaml"
    tokens.touch(0o644)
    with ExitStack() as stack:
        taken = stack.enter_context(socket.create_server(("127.0.0.1", 0)))
        port = taken.getsockname()[1] if what == "port" else 0
        parameters = {"port": port, "tokens": beside.folder / "new.yaml" if what == "port" else tokens}
        process, log = stack.enter_context(another(beside.folder, f"{what}_page", **parameters))
        sentence = (
            f"port {port}: Address already in use" if what == "port" else "has mode 644, allowed are 600"
        )
        beside.cell.wait(lambda: sentence in log.read_text())
        assert "]: active" not in log.read_text()
        taken.close()
        tokens.unlink()
        beside.cell.wait(lambda: "]: active" in log.read_text())
        assert "Traceback" not in log.read_text()
        process.send_signal(signal.SIGINT)
        assert process.wait(LIMIT) == 0


def test_it_ends_in_order_and_tells_no_token(beside: Beside) -> None:
    """The last test of the module: it takes the page down."""
    beside.cell.wait_until_active(PAGE)
    process = beside.cell.processes[PAGE]
    tokens = list(yaml.safe_load(beside.tokens.read_text()).values())
    shown = b"".join(Path(f"/proc/{process.pid}/{name}").read_bytes() for name in ("cmdline", "environ"))
    assert beside.cell.stop(PAGE, signal.SIGTERM) == 0, beside.cell.log(PAGE)
    log = beside.cell.log(PAGE)
    assert "Traceback" not in log
    assert len(tokens) == 2
    for token in tokens:
        assert token.encode() not in shown
        assert token not in log
    kept = [path for path in beside.folder.rglob("*") if path.is_file() and path != beside.tokens]
    assert {path.suffix for path in kept} >= {".mcap", ".jsonl", ".log"}
    assert [path for path in kept for token in tokens if token.encode() in path.read_bytes()] == []
    assert re.search(r'"order": "POST /control/mill"', (beside.folder / "audit/orders.jsonl").read_text())
