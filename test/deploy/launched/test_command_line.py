"""The commands of ROS' own command line that pages tell to type, typed at a running cell."""

from __future__ import annotations

import os
import re
import signal
import subprocess
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

import httpx
import pytest

from support.cell_processes import CellProcesses, free_port
from support.shell import output_of
from support.source_tree import ROOT
from support.waiting import LIMIT

DOORS = 10
DOOR = "thesis_190_0deg"
PAGES = {path.name: path for path in (ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md")))}


def told(page: str, beginning: str) -> str:
    """The one command of a page that begins so, on one line."""
    found = re.findall(rf"`({re.escape(beginning)}[^`]*)`", PAGES[page].read_text(encoding="utf-8"))
    (command,) = {" ".join(code.split()) for code in found}
    return command


def typed(command: str, folder: Path) -> str:
    """What a command prints, in the shell of a reader."""
    return output_of(f". ./activate\n{command}", folder, LIMIT)


@pytest.fixture(scope="module")
def cell(tmp_path_factory: pytest.TempPathFactory) -> Iterator[CellProcesses]:
    """A cell whose bridge sees how the controller is."""
    port, folder = free_port(), tmp_path_factory.mktemp("cell")
    parameters: dict[str, dict[str, object]] = {
        "abb_bridge": {"transport": "rws1", "address": f"http://127.0.0.1:{port}"},
        "cell_simulator": {
            "controller_simulator:web_services": "rws1",
            "controller_simulator:web_services_port": port,
        },
    }
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("DOORMILL_CONTROLLER_USER", "Default User")
        patch.setenv("DOORMILL_CONTROLLER_PASSWORD", "robotics")
        with CellProcesses(folder, parameters) as running:
            # The command line asks a daemon of its own, which hears of the cell only after its first command.
            running.wait(
                lambda: (
                    {"/abb/controller_state", "/door/pose"} <= set(typed("ros2 topic list", folder).split())
                )
            )
            yield running
        typed("ros2 daemon stop", folder)


def test_a_goal_of_the_readme_is_milled(cell: CellProcesses, tmp_path: Path) -> None:
    said = typed(told("README.md", "ros2 action send_goal"), tmp_path)
    assert "success: true" in said
    assert "stage: milling" in said
    assert "Goal finished with status: SUCCEEDED" in said


def test_the_controller_s_state_is_seen(cell: CellProcesses, tmp_path: Path) -> None:
    said = typed(told("commissioning.md", "ros2 topic echo --once abb/controller_state"), tmp_path)
    assert "operating_mode: AUTO" in said
    assert "motors_on: true" in said


def test_the_pose_of_a_door_is_seen(cell: CellProcesses, tmp_path: Path) -> None:
    command = told("commissioning.md", "ros2 topic echo --once door/pose")
    before = cell.node.count_subscribers("door/pose")
    echo = subprocess.Popen(
        ["bash", "-c", f". {ROOT}/activate && exec {command}"], stdout=subprocess.PIPE, text=True
    )
    try:
        # Whoever listens before the picture is taken hears of the pose; the localizer may hear of it later than this.
        cell.wait(lambda: cell.node.count_subscribers("door/pose") > before)
        for _ in range(DOORS):
            result, _ = cell.mill(DOOR)
            assert result.success, result.message
            if echo.poll() is not None:
                break
        said, _ = echo.communicate(timeout=LIMIT)
    finally:
        echo.kill()
    assert "frame_id: base_link" in said
    assert "position:" in said


def test_the_operator_s_page_is_served_beside_the_cell(
    cell: CellProcesses, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path))
    port = free_port()
    command = f"{told('operators-page.md', 'ros2 run doormill_ros operator_page')} --ros-args -p port:={port}"
    page = subprocess.Popen(
        ["bash", "-c", f". {ROOT}/activate && exec {command}"], cwd=tmp_path, start_new_session=True
    )
    try:

        def shown() -> dict[str, Any]:
            with suppress(httpx.TransportError):
                return dict(httpx.get(f"http://127.0.0.1:{port}/state", timeout=LIMIT).json())
            return {}

        # It has heard of the bridge, and what that does.
        cell.wait(lambda: shown().get("state"))
        os.killpg(page.pid, signal.SIGINT)
        assert page.wait(LIMIT) == 0
    finally:
        with suppress(ProcessLookupError):
            os.killpg(page.pid, signal.SIGKILL)


def test_a_part_of_the_cell_is_stopped_alone(cell: CellProcesses, tmp_path: Path) -> None:
    typed(told("README.md", "ros2 lifecycle set /door_localizer deactivate"), tmp_path)
    assert "inactive" in typed("ros2 lifecycle get /door_localizer", tmp_path)
    assert "inactive" not in typed("ros2 lifecycle get /path_generator", tmp_path)
    typed("ros2 lifecycle set /door_localizer activate", tmp_path)


def test_keys_are_made_of_the_policies(tmp_path: Path) -> None:
    (tmp_path / "config").symlink_to(ROOT / "config")
    blocks = re.findall(r"```sh\n(.*?)```", PAGES["living.md"].read_text(encoding="utf-8"), re.DOTALL)
    (block,) = [block for block in blocks if "ros2 security" in block]
    typed(block, tmp_path)
    policies = (ROOT / "config" / "security" / "policies.xml").read_text(encoding="utf-8")
    enclaves = re.findall(r'<enclave path="([^"]+)"', policies)
    assert len(enclaves) > 10
    for path in enclaves:
        made = tmp_path / "keystore" / "enclaves" / path.strip("/")
        assert (made / "permissions.p7s").stat().st_size > 0, path
        assert (made / "key.pem").stat().st_size > 0, path
