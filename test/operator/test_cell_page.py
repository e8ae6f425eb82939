"""The installed tool with its page, driven as an operator drives it; the token stays where it belongs."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import cv2
import httpx
import numpy as np
import pytest
from playwright.sync_api import expect

from support.browser import open_page
from support.cell_processes import executable
from support.waiting import LIMIT

DOOR = "thesis_190_0deg"
ATTEMPTS = 5


@dataclass
class Started:
    """The tool's process, what it wrote, and a client of its page."""

    process: subprocess.Popen[bytes]
    folder: Path
    output: Path
    log: Path
    page: httpx.Client
    token: str
    engineer: str

    def state(self, until: Callable[[dict[str, Any]], Any]) -> dict[str, Any]:
        """The page's content once it is as wanted."""
        deadline = time.monotonic() + LIMIT
        while not until(content := self.page.get("/state").json()):
            assert time.monotonic() < deadline, content
            assert self.process.poll() is None, self.log.read_text()
            time.sleep(0.05)
        return content

    def order(self, path: str, **body: str) -> httpx.Response:
        return self.page.post(path, json=body, headers=bearer(self.token))


def bearer(token: str) -> dict[str, str]:
    return {"Authorization": f"Bearer {token}"}


def _wait_for(pattern: str, path: Path, process: subprocess.Popen[bytes]) -> str:
    deadline = time.monotonic() + LIMIT
    while not (found := re.search(pattern, path.read_text())):
        assert process.poll() is None, path.read_text()
        assert time.monotonic() < deadline, path.read_text()
        time.sleep(0.05)
    return found[1]


@pytest.fixture(scope="module")
def cell(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Started]:
    folder = tmp_path_factory.mktemp("page")
    output, log = folder / "output.txt", folder / "log.txt"
    command = [executable("cell"), "--door", DOOR, "--out", "run", "--ui", "0", "--control", "--engineer"]
    environment = {**os.environ, "XDG_DATA_HOME": str(folder / "data"), "ROS_LOG_DIR": str(folder / "ros")}
    with open(output, "wb") as out, open(log, "wb") as err:
        process = subprocess.Popen(command, cwd=folder, stdout=out, stderr=err, env=environment)
    try:
        token = _wait_for(r"operator's token  (\w+)", output, process)
        engineer = _wait_for(r"engineer's token  (\w+)", output, process)
        url = _wait_for(r"operator's page at (http://127\.0\.0\.1:\d+)/", log, process)
        with httpx.Client(base_url=url, timeout=LIMIT) as page:
            started = Started(process, folder, output, log, page, token, engineer)
            started.state(lambda s: s["history"] and s["history"][0]["run_id"])
            yield started
    finally:
        process.kill()
        process.wait()


def test_the_milled_door_is_shown_with_its_picture(cell: Started) -> None:
    view = cell.state(lambda s: s["picture"] and s["state"] == "done" and not s["run_id"])
    assert (view["history"][-1]["door_id"], view["history"][-1]["success"]) == (DOOR, True)
    assert view["refusal"] == ""
    assert view["faults"] == []
    assert "Take it out" in view["next_step"]
    picture = cell.page.get(f"/picture/{view['picture']['number']}").content
    pixels = cv2.imdecode(np.frombuffer(picture, np.uint8), cv2.IMREAD_COLOR).astype(int)
    # The camera is grey; only the overlay has colours.
    assert (np.ptp(pixels, axis=2) > 100).sum() > 100


def test_a_refusal_reaches_the_browser(cell: Started) -> None:
    with open_page(str(cell.page.base_url)) as (page, errors):
        expect(page.locator("#control")).to_be_visible()
        page.locator("#token").fill(cell.token)
        page.locator("#wanted").fill("<b>no such door</b>")
        page.locator("#mill").click()
        expect(page.locator("#refusal")).to_contain_text("<b>no such door</b>")
        expect(page.locator("#last")).to_contain_text("refused (140)")
        assert errors == []
    refused = cell.state(lambda s: s["refusal"])
    assert (refused["history"][0]["error_code"], refused["refusal_code"]) == (140, 140)


def test_only_the_token_starts_a_run(cell: Started) -> None:
    before = cell.state(lambda s: not s["run_id"])["history"]
    assert cell.page.post("/control/mill", json={"door_id": DOOR}).status_code == 401
    assert cell.order("/control/mill", door_id="").status_code == 422
    view = cell.page.get("/state").json()
    assert (view["history"], view["run_id"]) == (before, "")


def test_the_doors_of_the_database_are_offered(cell: Started) -> None:
    offered = cell.page.get("/doors", params={"prefix": "thesis_190"}).json()
    assert offered == ["thesis_190_0deg", "thesis_190_2deg"]


def test_an_operator_starts_and_cancels(cell: Started) -> None:
    # A run takes about a second; on a loaded machine it may be over before the second order comes.
    for _ in range(ATTEMPTS):
        before = len(cell.state(lambda s: not s["run_id"])["history"])
        assert cell.order("/control/mill", door_id=DOOR).status_code == 202
        cell.state(lambda s, n=before: s["run_id"] or len(s["history"]) > n)
        busy = cell.order("/control/mill", door_id="another")
        cell.order("/control/cancel")
        view = cell.state(lambda s, n=before: not s["run_id"] and len(s["history"]) > n)
        if busy.status_code == 409 and view["history"][0]["error_code"] == 803:
            break
    assert "wait until it is done" in busy.json()["detail"]
    assert view["history"][0]["error_code"] == 803
    assert "canceled" in view["refusal"]
    cell.state(lambda s: "stands still" in s["next_step"])


def test_the_engineer_reads_who_ordered_what(cell: Started) -> None:
    cell.order("/control/mill", door_id="no such door")
    assert cell.page.get("/control/audit", headers=bearer(cell.token)).status_code == 403
    entries = cell.page.get("/control/audit", headers=bearer(cell.engineer)).json()
    orders = [e for e in entries if e["order"] == "POST /control/mill" and e["door_id"] == "no such door"]
    assert {(e["role"], e["address"]) for e in orders} == {("operate", "127.0.0.1")}
    tries = (cell.folder / "run" / "audit" / "refused.jsonl").read_text().splitlines()
    assert json.loads(tries[0])["status"] == 401


def test_the_process_list_tells_no_token(cell: Started) -> None:
    told = b"".join(Path(f"/proc/{cell.process.pid}/{name}").read_bytes() for name in ("cmdline", "environ"))
    assert b"--control" in told
    assert cell.token.encode() not in told
    assert cell.engineer.encode() not in told


def test_it_ends_on_interrupt_and_the_token_is_nowhere(cell: Started) -> None:
    """The last test of the module: it takes the cell down."""
    cell.process.send_signal(signal.SIGINT)
    assert cell.process.wait(LIMIT) == 0, cell.log.read_text()
    for token in (cell.token, cell.engineer):
        assert cell.output.read_text().count(token) == 1
    files = [path for path in cell.folder.rglob("*") if path.is_file() and path != cell.output]
    assert {path.suffix for path in files} >= {".mcap", ".html", ".json"}
    for path in files:
        content = path.read_bytes()
        assert cell.token.encode() not in content, path
        assert cell.engineer.encode() not in content, path
    assert "Traceback" not in cell.log.read_text()
