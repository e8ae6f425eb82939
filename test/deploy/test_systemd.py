"""The units: systemd itself reads them where it is installed, and what they name is there."""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path

import pytest

from doormill_ros.cell.graph.readiness import BESIDE, NEEDED
from doormill_ros.tools.catalogue import parser
from support.source_tree import ROOT
from support.waiting import LIMIT

UNITS = ROOT / "deploy" / "systemd"
NODES = [f"doormill@{name}.service" for name in (*NEEDED, *BESIDE, "cell_simulator")]
TIMED = ["doormill-backup", "doormill-retain"]
OTHERS = ["doormill.target", *(f"{name}.{kind}" for name in TIMED for kind in ("service", "timer"))]
SERVICES = ["doormill@.service", *(f"{name}.service" for name in TIMED)]
INSTALLED = "/opt/doormill"
MOST_EXPOSED = 2.0  # of 10, as systemd-analyze counts


@pytest.fixture(scope="module")
def units(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The units of an installation in this folder."""
    folder = tmp_path_factory.mktemp("units")
    for path in UNITS.iterdir():
        (folder / path.name).write_text(path.read_text().replace(INSTALLED, str(ROOT)))
    return folder


def analyze(units: Path, *arguments: str) -> str:
    """What systemd-analyze complains of; nothing where there is none."""
    program = shutil.which("systemd-analyze")
    if program is None:
        return ""
    environment = {"SYSTEMD_UNIT_PATH": f"{units}:", "PATH": "/usr/bin:/bin", "SYSTEMD_COLORS": "0"}
    done = subprocess.run(
        [program, *arguments], cwd=units, env=environment, capture_output=True, text=True, timeout=LIMIT
    )
    return "" if done.returncode == 0 and not done.stderr else done.stdout[-3000:] + done.stderr


@pytest.mark.parametrize("unit", [*NODES, *OTHERS])
def test_systemd_finds_nothing_wrong(units: Path, unit: str) -> None:
    assert analyze(units, "verify", "--man=no", unit) == ""


def test_systemd_would_find_something_wrong(units: Path, tmp_path: Path) -> None:
    text = (units / "doormill-backup.service").read_text().replace("Type=oneshot", "Type=never\nFoo=bar")
    (tmp_path / "wrong.service").write_text(text)
    said = analyze(tmp_path, "verify", "--man=no", "wrong.service")
    assert ("Foo" in said) == (shutil.which("systemd-analyze") is not None)


@pytest.mark.parametrize("service", SERVICES)
def test_services_are_little_exposed(units: Path, service: str) -> None:
    threshold = f"--threshold={10 * MOST_EXPOSED:.0f}"
    assert analyze(units, "security", "--offline=true", threshold, f"./{service}") == ""
    # What every service must say of itself, also where no systemd judges it.
    text = (UNITS / service).read_text()
    for line in (
        "User=doormill",
        "NoNewPrivileges=yes",
        "ProtectSystem=strict",
        "CapabilityBoundingSet=",
        "SystemCallFilter=@system-service",
    ):
        assert f"\n{line}\n" in text


def test_nodes_come_back_and_come_at_start_up() -> None:
    node = (UNITS / "doormill@.service").read_text()
    for line in (
        "Restart=always",
        "StartLimitIntervalSec=0",
        "RestartPreventExitStatus=2",
        "WantedBy=doormill.target",
    ):
        assert f"\n{line}\n" in node
    target = (UNITS / "doormill.target").read_text()
    assert "WantedBy=multi-user.target" in target
    assert set(re.findall(r"doormill@(\w+)\.service", target.split("[Unit]")[1])) == {*NEEDED, *BESIDE}


def test_what_is_started_is_there() -> None:
    commands = {
        command
        for path in UNITS.glob("*.service")
        for command in re.findall(rf"{INSTALLED}/(\S+)", path.read_text())
    }
    assert {"deploy/doormill-run", "docs/living.md", "docs/catalogue.md"} == commands
    assert all((ROOT / command).is_file() for command in commands)


def test_bags_go_by_the_catalogue_alone() -> None:
    """Not by their age: some are needed for ever."""
    tmpfiles = (UNITS / "doormill.tmpfiles").read_text()
    aged = {Path(path).name for path in re.findall(r"^[a-zA-Z!]+ (\S+) .* \d+d$", tmpfiles, re.MULTILINE)}
    assert "targets" in aged
    assert aged.isdisjoint({"bags", "out"})
    command = re.search(
        r"^ExecStart=\S+ (.*)$", (UNITS / "doormill-retain.service").read_text(), re.MULTILINE
    )
    assert command is not None
    assert parser().parse_args(command[1].split()[1:]).command == "retain"


def test_what_comes_every_night_is_enabled_by_the_page() -> None:
    page = (ROOT / "docs" / "living.md").read_text()
    (enabled,) = re.findall(r"^systemctl enable --now (.*)$", page, re.MULTILINE)
    assert {f"{name}.timer" for name in TIMED} <= set(enabled.split())
    assert all("WantedBy=timers.target" in (UNITS / f"{name}.timer").read_text() for name in TIMED)


def test_the_log_is_bounded() -> None:
    text = (UNITS / "journald@doormill.conf").read_text()
    assert re.search(r"^SystemMaxUse=\d+M$", text, re.MULTILINE)
    assert re.search(r"^MaxRetentionSec=\d+day$", text, re.MULTILINE)
    assert all("LogNamespace=doormill" in (UNITS / service).read_text() for service in SERVICES)
