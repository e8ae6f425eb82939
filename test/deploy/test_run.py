"""The starter of services and containers, from a shell that knows nothing."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

import pytest
import yaml

from doormill_ros.backup.archive import PARTS
from doormill_ros.cell.graph.readiness import BESIDE, NEEDED
from doormill_ros.models.store import store_folder
from doormill_ros.nodes.model_monitor import ModelMonitor
from doormill_ros.nodes.path_generator import PathGenerator
from doormill_ros.resources import MODELS, site_folder
from support.source_tree import ROOT
from support.waiting import LIMIT

RUN = ROOT / "deploy" / "doormill-run"


def run(folder: Path, *arguments: str, **environment: str) -> subprocess.CompletedProcess[str]:
    known = {name: os.environ[name] for name in ("HOME", "ROS_DOMAIN_ID") if name in os.environ}
    if "ROS_DISTRO" in os.environ and "DOORMILL_WHEELS" not in os.environ:
        known["PATH"] = os.environ["PATH"]
    return subprocess.run(
        [RUN, *arguments],
        cwd=folder,
        env={"PATH": "/usr/local/bin:/usr/bin:/bin", **known, **environment},
        capture_output=True,
        text=True,
        timeout=LIMIT,
    )


def test_a_tool_runs_on_the_site(tmp_path: Path) -> None:
    done = run(tmp_path, "recipes", "list", DOORMILL_SITE=str(tmp_path / "site"))
    assert done.returncode == 0, done.stderr
    assert "standard_door" in done.stdout
    assert (tmp_path / "site" / "recipes.sqlite").is_file()


#: Of every node that a service or a container starts, a parameter and a value that it cannot have.
WRONG = {
    "recipe_database": ("ship_recipes", 77),
    "door_localizer": ("overlay_step", 77),
    "path_generator": ("frames", 77),
    "abb_bridge": ("limit.recipe", 0.0),
    "bag_recorder": ("queue_size", 1),
    "model_monitor": ("doors", 0),
    "operator_page": ("port", 70000),
    "cell_simulator": ("web_services_port", 70000),
    "folder_camera": ("retry_period", 0.0),
    "gige_camera": ("packet_size", -1),
}


@pytest.mark.parametrize("node", WRONG)
def test_a_node_takes_the_parameters_of_the_site_and_says_what_is_wrong_with_them(
    tmp_path: Path, node: str
) -> None:
    """With the status after which the service does not start it again."""
    name, value = WRONG[node]
    (tmp_path / "config").mkdir()
    document = {"/**": {"ros__parameters": {name: value}}}
    (tmp_path / "config" / "nodes.yaml").write_text(yaml.safe_dump(document))
    done = run(tmp_path, node, DOORMILL_SITE=str(tmp_path))
    assert done.returncode == 2, done.stdout + done.stderr
    assert f"parameter {name} of /" in done.stdout + done.stderr
    assert f"is {value}, allowed is" in done.stdout + done.stderr


def test_who_mills_with_a_model_and_who_proposes_it_have_one_store_by_default() -> None:
    """Neither a service nor the README names it, and a site's nodes.yaml need not."""
    declared = {p.default for n in (PathGenerator, ModelMonitor) for p in n.PARAMETERS if p.name == "models"}
    assert declared == {""}
    assert store_folder("") == site_folder() / MODELS
    assert MODELS in PARTS
    shipped = yaml.safe_load((ROOT / "config" / "nodes.yaml").read_text(encoding="utf-8"))
    assert not [node for node, values in shipped.items() if "models" in values["ros__parameters"]]


def test_every_node_is_started_so() -> None:
    assert set(WRONG) == {*NEEDED, *BESIDE, "cell_simulator", "folder_camera", "gige_camera"}


def test_what_is_not_there_is_named(tmp_path: Path) -> None:
    assert run(tmp_path).returncode == 2
    done = run(tmp_path, "no_such_node")
    assert (done.returncode, done.stderr) == (2, "doormill-run: there is no node or tool no_such_node\n")
