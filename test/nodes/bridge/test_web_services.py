"""A thesis door is milled with the bridge on Robot Web Services of the simulated controller."""

from __future__ import annotations

import hashlib
from pathlib import Path
from typing import Any

import pytest
import yaml

from doormill_ros.abb import signals
from doormill_ros.abb.target_file.target_file import read_target_file
from doormill_ros.abb.transports.simulated_folder import LOCK_FILE
from doormill_ros.nodes.base import topics
from doormill_ros.resources import resource
from doormill_ros.simulation.spindle_load import IDLE, NOISE
from support.cell_processes import NODES, CellProcesses, free_port

DOOR = "thesis_190_2deg"


def shipped(node: str) -> dict[str, Any]:
    """Parameters of a node in the file that goes with the documented command."""
    document = yaml.safe_load(resource("config/nodes-rws1.yaml").read_text(encoding="utf-8"))
    return dict(document[f"/{node}"]["ros__parameters"])


@pytest.mark.parametrize(("name", "scheme"), [("rws1", "http"), ("rws2", "https")])
def test_a_door_is_milled_over_the_web_services(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str, scheme: str
) -> None:
    monkeypatch.setenv("DOORMILL_CONTROLLER_USER", "Default User")
    monkeypatch.setenv("DOORMILL_CONTROLLER_PASSWORD", "robotics")
    port, certificates = free_port(), tmp_path / "certificates"
    bridge, controller = shipped("abb_bridge"), shipped("controller_simulator")
    assert bridge == {"transport": "rws1", "address": f"http://127.0.0.1:{controller['web_services_port']}"}
    bridge |= {"transport": name, "address": f"{scheme}://127.0.0.1:{port}", "spindle_load_period": 0.05}
    controller |= {"web_services": name, "web_services_port": port, "time_scale": 8.0}
    if name == "rws2":
        bridge["certificate"] = certificates / "controller.crt"
        controller["web_services_certificates"] = certificates
    parameters = {
        "abb_bridge": bridge,
        "cell_simulator": {f"controller_simulator:{key}": value for key, value in controller.items()},
    }
    nodes = tuple(node for node in NODES if node != "bag_recorder")
    with CellProcesses(tmp_path, parameters, nodes) as cell:
        milled, loads = cell.subscribe(topics.MILLED_DOOR), cell.subscribe(topics.SPINDLE_LOAD)
        result, _ = cell.mill(DOOR)
        assert result.success, result.message
        part = cell.wait(lambda: next((m for m in milled if m.run_id == result.run_id), None))
        assert part.corrected_max < part.tolerance
        # The analog input came over the wire as well, while the door was milled.
        assert {message.run_id for message in loads} == {result.run_id}
        assert max(message.load for message in loads) > IDLE + 2.0 * NOISE
        data = Path(result.target_file).read_bytes()
        assert hashlib.sha256(data).hexdigest() == result.sha256
        assert (read_target_file(data).door_id, read_target_file(data).run_id) == (DOOR, result.run_id)
        # The door was milled from the file that came over the wire: nobody took the folder for the bridge.
        assert not (tmp_path / "HOME" / LOCK_FILE).exists()
        assert {process: cell.stop(process) for process in list(cell.processes)} == dict.fromkeys(nodes, 0)
    assert not (tmp_path / "HOME" / signals.TARGET_FILE).exists()
    assert (tmp_path / "HOME" / "io" / signals.READY).read_text() == "0"
