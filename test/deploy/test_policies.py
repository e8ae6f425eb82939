"""The policies of SROS 2 against the graph of a running cell."""

from __future__ import annotations

import ast
import re
from xml.etree import ElementTree

import pytest
import yaml

from doormill_ros.cell.graph.readiness import BESIDE, NEEDED
from doormill_ros.localization.sensors.registry import CELL_SENSORS
from scripts.list_policies import CAMERAS, FILE, KINDS, SIMULATORS, Graph, policies, whole_graph
from support.source_tree import ROOT


@pytest.fixture(scope="module")
def graph() -> Graph:
    return whole_graph()


def allowed(enclave: str) -> set[tuple[str, str, str]]:
    """Node, kind and name, of one enclave of the file."""
    found = set()
    for profile in (
        ElementTree.parse(FILE).getroot().findall(f"enclaves/enclave[@path='{enclave}']/profiles/profile")
    ):
        for kind in KINDS:
            tag, does = kind.split()
            for listed in profile.findall(f"{tag}[@{does}='ALLOW']"):
                found |= {(profile.get("node", ""), kind, str(one.text)) for one in listed}
    return found


def test_the_file_is_the_one_made_from_the_running_cell(graph: Graph) -> None:
    assert FILE == ROOT / "config" / "security" / "policies.xml"
    assert set(graph) == {*NEEDED, *BESIDE, *SIMULATORS, *CELL_SENSORS, *CAMERAS}
    assert FILE.read_text(encoding="utf-8") == policies(graph), "run python -m scripts.list_policies"


def test_only_the_bridge_takes_goals_and_only_the_path_generator_sends_targets() -> None:
    enclaves = [
        f"/doormill/{name}"
        for name in (*NEEDED, *BESIDE, *CAMERAS, "cell_simulator", "door_sensors", "health")
    ]
    said = [(enclave, *row) for enclave in enclaves for row in allowed(enclave)]
    assert [e for e, _, kind, name in said if (kind, name) == ("actions execute", "/mill_door")] == [
        "/doormill/abb_bridge"
    ]
    assert [e for e, _, kind, name in said if (kind, name) == ("topics publish", "/path/targets")] == [
        "/doormill/path_generator"
    ]
    assert allowed("/doormill/health") == {("cell_health", "topics subscribe", "/diagnostics")}
    assert ("bag_recorder", "topics subscribe", "*") in allowed("/doormill/bag_recorder")


def test_every_node_that_a_launch_file_or_a_container_starts_has_a_policy() -> None:
    launch = (ROOT / "launch" / "cell.launch.py").read_text(encoding="utf-8")
    (nodes,) = re.findall(r"^NODES = (\(.*?^\))", launch, re.MULTILINE | re.DOTALL)
    services = yaml.safe_load((ROOT / "deploy" / "container" / "compose.yaml").read_text())["services"]
    started = {*ast.literal_eval(nodes), *services}
    assert "gige_camera" in started
    enclaves = ElementTree.parse(FILE).getroot().findall("enclaves/enclave")
    assert started <= {enclave.get("path", "").removeprefix("/doormill/") for enclave in enclaves}
