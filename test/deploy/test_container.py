"""The recipe of the container against what it names; it is built by hand, on a machine with an engine."""

from __future__ import annotations

import os
import re
import shlex
import subprocess
from fnmatch import fnmatch
from pathlib import Path

import pytest
import yaml

from doormill_ros.cell.graph.readiness import BESIDE, NEEDED
from support.source_tree import ROOT

FOLDER = ROOT / "deploy" / "container"
FILE = (FOLDER / "Containerfile").read_text()
SHELL = ["/bin/bash", "-euo", "pipefail", "-c"]
COMMANDS = [
    command.replace("\\\n", "").strip()
    for command in re.findall(r"^RUN ((?:.*\\\n)*.*)$", FILE, re.MULTILINE)
]
COMPOSE = yaml.safe_load((FOLDER / "compose.yaml").read_text())


def installed() -> set[str]:
    (line,) = re.findall(r"--no-install-recommends \\\n\s+(.*?) \\\n", FILE)
    return set(shlex.split(line))


def test_it_installs_what_the_bootstrap_asks_for() -> None:
    asked = set(
        re.findall(
            r"missing \S+ (\S+)$|missing \"[^\"]+\" (\S+)$", (ROOT / "scripts/bootstrap.sh").read_text(), re.M
        )
    )
    wanted = {name for pair in asked for name in pair if name} | {"cmake", "g++", "git", "python3"}
    # A ROS image brings colcon.
    assert wanted - {"python3-colcon-common-extensions"} <= installed()
    assert "python3-venv" in installed()


def test_what_it_copies_and_starts_is_there() -> None:
    assert re.search(r'^ENTRYPOINT \["/opt/doormill/deploy/doormill-run"\]$', FILE, re.MULTILINE)
    assert re.search(r"^WORKDIR /opt/doormill\nCOPY \. \.$", FILE, re.MULTILINE)
    assert (ROOT / "deploy" / "doormill-run").stat().st_mode & 0o111
    ignored = (ROOT / ".dockerignore").read_text().split()
    assert not {"deploy", "scripts", "doormill_ros", "requirements", "activate"} & set(ignored)


def test_every_node_has_its_container_a_bounded_log_and_no_privileges() -> None:
    services = COMPOSE["services"]
    assert set(services) == {*NEEDED, *BESIDE, "door_sensors", "cell_simulator", "gige_camera"}
    # Where its library is missing it says so and ends; a real fault brings it back.
    assert services["gige_camera"]["restart"] == "on-failure:5"
    assert services["gige_camera"]["profiles"] == ["gige"]
    assert all(service["command"] == [name] for name, service in services.items())
    for name in (*NEEDED, *BESIDE, "door_sensors", "cell_simulator"):
        service = services[name]
        assert service["logging"]["options"] == {"max-size": "10m", "max-file": "5"}
        assert (service["cap_drop"], service["restart"]) == (["ALL"], "unless-stopped")
    build = (FOLDER / services["abb_bridge"]["build"]["context"]).resolve()
    assert build == ROOT
    assert (build / services["abb_bridge"]["build"]["dockerfile"]).is_file()
    assert services["abb_bridge"]["healthcheck"]["test"][1:] == [
        "/opt/doormill/deploy/doormill-run",
        "health",
    ]


def test_what_is_told_by_variables_reaches_the_containers() -> None:
    sources = (path.read_text(encoding="utf-8") for path in (ROOT / "doormill_ros").rglob("*.py"))
    read = {name for text in sources for name in re.findall(r"\bDOORMILL_[A-Z_]+", text)}
    told = set(re.findall(r"`((?:DOORMILL|ROS)_[A-Z_]+)(?:=\w+)?`", (ROOT / "docs/living.md").read_text()))
    secret = {name for name in read if name.startswith("DOORMILL_CONTROLLER_")}
    assert len(secret) == 4
    assert "ROS_SECURITY_KEYSTORE" in told
    # The image says where the site is; wheels are found by themselves, and containers share the host's network.
    wanted = (read | told) - {"DOORMILL_SITE", "DOORMILL_WHEELS", "ROS_AUTOMATIC_DISCOVERY_RANGE"}
    for name, service in COMPOSE["services"].items():
        given = set(service["environment"])
        assert given & secret == (secret if name == "abb_bridge" else set()), name
        assert wanted - secret <= given, name
        assert all(value is None for value in service["environment"].values())  # as the shell has them


def ignored(name: str) -> bool:
    """Whether .dockerignore keeps a file out of the image."""
    patterns = (ROOT / ".dockerignore").read_text(encoding="utf-8").split()
    parts = Path(name).parts
    above = ["/".join(parts[: number + 1]) for number in range(len(parts))]
    return any(
        fnmatch(Path(folder).name, pattern[3:]) if pattern.startswith("**/") else fnmatch(folder, pattern)
        for pattern in patterns
        for folder in above
    )


def test_every_file_of_the_repository_reaches_the_image_and_nothing_of_this_machine_does() -> None:
    """So the image is built from what `.ci/run` builds from in a new empty folder."""
    listed = subprocess.run(
        ["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=True
    ).stdout.split("\n")
    tracked = [name for name in listed if name]
    assert len(tracked) > 500
    assert [name for name in tracked if ignored(name)] == []
    for name in (
        ".venv/bin/python",
        "install/lib/x",
        "build/x",
        "out/runs/x",
        "test/__pycache__/x.pyc",
        ".git/HEAD",
    ):
        assert ignored(name), name


@pytest.mark.parametrize("command", COMMANDS)
def test_its_shell_reads_the_commands(command: str) -> None:
    assert re.search(rf"^SHELL {re.escape(str(SHELL).replace(chr(39), chr(34)))}$", FILE, re.MULTILINE)
    done = subprocess.run([SHELL[0], "-n", "-c", command], capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "")


def test_the_way_to_the_build_runs_where_ros_is_and_where_it_is_not(tmp_path: Path) -> None:
    """All before and after the build itself changes the machine; a ROS image's set-up asks for variables nobody set."""
    (command,) = (command for command in COMMANDS if "bootstrap.sh" in command)
    before = command.split("scripts/bootstrap.sh")[0]
    assert (ROOT / "scripts" / "bootstrap.sh").stat().st_mode & 0o111
    found = re.search(r" in (\S+/)\*/setup\.bash", before)
    assert found
    for distro in ("", "kilted"):
        root = tmp_path / f"ros{distro}"
        (root / distro).mkdir(parents=True)
        if distro:
            (root / distro / "setup.bash").write_text("export ROS_DISTRO=kilted; : $NOBODY_SET_THIS\n")
        script = before.replace(found[1], f"{root}/") + 'printf "%s" "${ROS_DISTRO:-none}"; : $NOR_THIS'
        done = subprocess.run(
            [*SHELL, script], cwd=tmp_path, env={"PATH": os.environ["PATH"]}, capture_output=True, text=True
        )
        assert done.stdout == (distro or "none")
        assert "NOR_THIS: unbound variable" in done.stderr  # what comes after is strict again
