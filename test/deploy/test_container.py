"""The recipe of the container against what it names; no container was built here."""

from __future__ import annotations

import re
import shlex

import yaml

from doormill_ros.cell.readiness import BESIDE, NEEDED
from support.source_tree import ROOT

FOLDER = ROOT / "deploy" / "container"
FILE = (FOLDER / "Containerfile").read_text()
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
    assert set(services) == {*NEEDED, *BESIDE, "cell_simulator"}
    assert all(service["command"] == [name] for name, service in services.items())
    for name in (*NEEDED, *BESIDE, "cell_simulator"):
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
