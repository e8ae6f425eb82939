"""Write which node may publish, read, ask and answer what: config/security/policies.xml for SROS 2."""

from __future__ import annotations

import re
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

from rclpy.node import Node

from doormill_ros.cell.output.run_folder import RunFolder
from doormill_ros.cell.places.layout import CAMERA
from doormill_ros.localization.gige.library import Aravis
from doormill_ros.localization.sensors.registry import CELL_SENSORS
from doormill_ros.nodes.folder_camera import FolderCamera
from doormill_ros.nodes.gige_camera import GigeCamera
from doormill_ros.nodes.milling.door_inspections import GAUGE_PARAMETER
from doormill_ros.nodes.one_process.cell import GLOBAL, Cell, CellOptions
from doormill_ros.nodes.process.composition import Composition
from doormill_ros.operator.access.token import new_token
from doormill_ros.resources import share_directory
from doormill_ros.simulation.sensors.registry import SIMULATED_SENSORS

FILE = share_directory() / "config" / "security" / "policies.xml"
#: Nodes of one process share its enclave.
SIMULATORS = ("camera_simulator", "controller_simulator", "sensor_simulator")
PROCESS = {
    **dict.fromkeys(SIMULATORS, "cell_simulator"),
    **dict.fromkeys(CELL_SENSORS, "door_sensors"),
}
#: Cameras in place of the simulated one; the one on the network reaches none here, which changes none of its topics.
CAMERAS = {
    "folder_camera": FolderCamera,
    "gige_camera": partial(GigeCamera, Aravis(None, Exception)),
}
#: Stands for every sensor beside the camera: their nodes are of one class.
SENSOR = next(iter(SIMULATED_SENSORS))
#: What a node may do depends on whether its sensor is the first one, beside it, or alone.
CELLS = ((CAMERA,), (CAMERA, SENSOR), (SENSOR, CAMERA))
#: Their names hold a checksum of the controller's address.
CLAIMS, EVERY_CLAIM = re.compile(r"/_alive/controller_\w+"), "/_alive/controller_*"
#: What `health` listens to, and where the recorder takes whatever it finds.
LISTENER, RECORDER = "cell_health", "bag_recorder"
SETTLED = 3.0  # s without a change of the graph
LIMIT = 240.0  # s, after which it never will
KINDS = (
    "topics publish",
    "topics subscribe",
    "services reply",
    "services request",
    "actions execute",
    "actions call",
)

Graph = dict[str, dict[str, set[str]]]


def graph_of(node: Any, names: list[str]) -> Graph:
    """What the nodes do, by name and kind, as the ROS graph tells it to one of them."""
    asked = {
        "topics publish": node.get_publisher_names_and_types_by_node,
        "topics subscribe": node.get_subscriber_names_and_types_by_node,
        "services reply": node.get_service_names_and_types_by_node,
        "services request": node.get_client_names_and_types_by_node,
    }
    namespace, found = node.get_namespace(), Graph()
    for name in names:
        kinds = {
            kind: {one.removeprefix(namespace) for one, _ in ask(name, namespace)}
            for kind, ask in asked.items()
        }
        for kind, action in (("services reply", "actions execute"), ("services request", "actions call")):
            kinds[action] = {one.split("/_action/")[0] for one in kinds[kind] if "/_action/" in one}
        for kind in asked:
            own = {CLAIMS.sub(EVERY_CLAIM, one) for one in kinds[kind]}
            kinds[kind] = {one for one in own if "/_action/" not in one}
        # Offered only after a while: that the bridge is the first one.
        kinds["topics publish"] |= {t for t in kinds["topics subscribe"] if t.startswith(f"/_alive/{name}_")}
        found[name] = kinds
    return found


def held_by(node: Any) -> dict[str, set[str]]:
    """What a node itself says that it holds, by kind, actions apart; the ROS graph knows it only after discovery."""
    held = {
        "topics publish": {one.topic_name for one in node.publishers},
        "topics subscribe": {one.topic_name for one in node.subscriptions},
        "services reply": {one.service_name for one in node.services},
        "services request": {one.service_name for one in node.clients},
    }
    namespace = node.get_namespace()
    return {
        kind: {
            CLAIMS.sub(EVERY_CLAIM, one.removeprefix(namespace)) for one in names if "/_action/" not in one
        }
        for kind, names in held.items()
    }


def untold(node: Any, graph: Graph) -> list[str]:
    """What a node holds and the graph does not tell."""
    return [
        name for kind, held in held_by(node).items() for name in sorted(held - graph[node.get_name()][kind])
    ]


def whole_graph() -> Graph:
    """What the nodes do in any cell, whatever its sensors."""
    whole: Graph = {}
    for number, sensors in enumerate(CELLS):
        for graph in (cell_graph(sensors, f"/cell{number}"), cameras_graph(sensors, f"/cameras{number}")):
            with graph as found:
                for name, kinds in found.items():
                    for kind, names in kinds.items():
                        whole.setdefault(name, {}).setdefault(kind, set()).update(names)
    one = whole.pop(SENSOR)
    # Whoever watches one sensor's sign of life watches those of the others in their cells.
    for kinds in whole.values():
        for names in kinds.values():
            if _alive(SENSOR) in names:
                names.update(map(_alive, CELL_SENSORS))
    for sensor in CELL_SENSORS:
        whole[sensor] = {kind: {_renamed(name, sensor) for name in names} for kind, names in one.items()}
    return whole


def _alive(sensor: str) -> str:
    return f"/_alive/{sensor}"


def _renamed(name: str, sensor: str) -> str:
    """What one sensor's node calls its own, for another one's."""
    return re.sub(rf"(?<=/){SENSOR}(?=/|$)", sensor, name)


@contextmanager
def cell_graph(sensors: tuple[str, ...], namespace: str) -> Iterator[Graph]:
    """The graph of the nodes of a cell with these sensors, brought up for it.

    In a namespace of its own: DDS remembers for a while what nodes of the same names did that are gone.
    """
    with tempfile.TemporaryDirectory(prefix="policies-", ignore_cleanup_errors=True) as folder:
        run = RunFolder(Path(folder))
        run.prepare()
        # With page and bridge in modes in which they ask for most.
        options = CellOptions(
            {"operator_page": {"port": 0}, "abb_bridge": {GAUGE_PARAMETER.name: True}},
            page=True,
            token=new_token(),
            namespace=namespace,
            sensors=sensors,
        )
        with Cell(run, options) as cell:
            yield settled(cell._composition)


@contextmanager
def cameras_graph(sensors: tuple[str, ...], namespace: str) -> Iterator[Graph]:
    """The same of the cameras that stand in place of the simulated one."""
    with tempfile.TemporaryDirectory(prefix="policies-") as folder:
        parameters = {"sensors": ",".join(sensors), "folder": folder}
        remapped = [("__ns", namespace), *((f"/{name}", name) for name in GLOBAL)]
        arguments = ["policies", "--ros-args"]
        arguments += [one for name, to in remapped for one in ("-r", f"{name}:={to}")]
        arguments += [one for name, to in parameters.items() for one in ("-p", f"{name}:={to}")]
        with Composition(arguments, list(CAMERAS.values()), lambda: Node("driver")) as composition:
            yield settled(composition)


def settled(composition: Composition[Any]) -> Graph:
    """The graph of its nodes, once it tells everything that they hold.

    Raises:
        TimeoutError: It does not.
    """
    names = [node.get_name() for node in composition.nodes]
    found, since = graph_of(composition.driver, names), time.monotonic()
    deadline = since + LIMIT
    while time.monotonic() - since < SETTLED:
        time.sleep(0.2)
        again = graph_of(composition.driver, names)
        missing = [name for node in composition.nodes for name in untold(node, again)]
        if again != found or missing:
            found, since = again, time.monotonic()
        if time.monotonic() > deadline:
            raise TimeoutError(f"after {LIMIT:g} s the graph has not settled; it does not tell {missing}")
    return found


def policies(graph: Graph) -> str:
    """The text of the policy file."""
    root = ElementTree.Element("policy", version="0.2.0")
    root.append(ElementTree.Comment(" Written by python -m scripts.list_policies from a running cell. "))
    enclaves = ElementTree.SubElement(root, "enclaves")
    listener = {kind: set[str]() for kind in KINDS}
    listener["topics subscribe"] = {"/diagnostics"}
    all_nodes = {**graph, LISTENER: listener}
    for process in sorted({PROCESS.get(name, name) for name in all_nodes}):
        path = "health" if process == LISTENER else process
        enclave = ElementTree.SubElement(enclaves, "enclave", path=f"/doormill/{path}")
        profiles = ElementTree.SubElement(enclave, "profiles")
        for name in sorted(n for n in all_nodes if PROCESS.get(n, n) == process):
            profile = ElementTree.SubElement(profiles, "profile", ns="/", node=name)
            for kind in KINDS:
                names = {"*"} if (name, kind) == (RECORDER, "topics subscribe") else all_nodes[name][kind]
                if names:
                    tag, does = kind.split()
                    listed = ElementTree.SubElement(profile, tag, {does: "ALLOW"})
                    for one in sorted(names):
                        ElementTree.SubElement(listed, tag.rstrip("s")).text = one
    ElementTree.indent(root)
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{ElementTree.tostring(root, encoding="unicode")}\n'


def main() -> int:
    """Write the file anew."""
    FILE.write_text(policies(whole_graph()), encoding="utf-8")
    print(FILE)
    return 0


if __name__ == "__main__":
    sys.exit(main())
