"""What nodes leave in a site is what they use, a backup takes it, and a restored site goes on with it."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import httpx
import pytest
import rclpy
import yaml
from rclpy.lifecycle import TransitionCallbackReturn
from std_msgs.msg import Header

from doormill_interfaces.srv import AcceptModel
from doormill_ros.models.store import ModelStore
from doormill_ros.nodes.base.managed_node import ManagedNode
from doormill_ros.nodes.convert.recipe import recipe_message
from doormill_ros.nodes.model_monitor import ModelMonitor
from doormill_ros.nodes.operator_page import OperatorPage
from doormill_ros.nodes.path_generator import PathGenerator
from doormill_ros.recipes.documents import shipped_recipes
from doormill_ros.resources import resource
from doormill_ros.robot.description import load_robot
from doormill_ros.robot_model.extended_document import model_document
from doormill_ros.tools import backup, restore
from support.waiting import LIMIT

DOOR = "thesis_190_0deg"
WHO = ("Kari", "door 15 to 30 say so")
#: A site has a file of parameters of its own, or none and the shipped one counts.
OWN = {"/**/abb_bridge": {"ros__parameters": {"address": "controller"}}}


@pytest.fixture(params=["shipped parameters", "own parameters"])
def site(request: pytest.FixtureRequest, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The site that nodes are started in, as a service's folder."""
    folder = tmp_path / "site"
    folder.mkdir()
    if request.param == "own parameters":
        (folder / "config").mkdir()
        (folder / "config" / "nodes.yaml").write_text(yaml.safe_dump(OWN))
    monkeypatch.setenv("DOORMILL_SITE", str(folder))
    monkeypatch.chdir(folder)
    return folder


@contextmanager
def started(make: Callable[..., ManagedNode], *arguments: str) -> Iterator[Any]:
    """A node with the parameters that its executable has, configured."""
    context = rclpy.Context()
    parameters = ["--ros-args", "--params-file", str(resource("config/nodes.yaml")), *arguments]
    rclpy.init(args=parameters, context=context)
    node = make(context=context)
    try:
        assert node.trigger_configure() == TransitionCallbackReturn.SUCCESS
        yield node
    finally:
        node.close()
        node.destroy_node()
        rclpy.shutdown(context=context)


def model() -> bytes:
    robot = load_robot("irb6600_175_255")
    return yaml.safe_dump(model_document(robot.name, robot.stiffness, [], "test")).encode()


def accept(site: Path) -> None:
    """The monitor's own store gets a proposal, which a person accepts by the monitor's service."""
    with started(ModelMonitor) as monitor:
        assert monitor._watch._store.propose(model(), "doors") == 1
        asked = AcceptModel.Request(version=1, who=WHO[0], why=WHO[1])
        answer = monitor._accept(asked, AcceptModel.Response())
        assert (answer.success, answer.error_code) == (True, 0), answer.message


def used_for_next_door() -> tuple[int, str]:
    """Version and file of the model that the next recipe is planned with."""
    with started(PathGenerator) as generator:
        generator._take_recipe(recipe_message(shipped_recipes()[DOOR], "r1", Header()))
        assert generator._unfit is None
        return generator._setup.version, generator._setup.setup.model_name


def test_an_accepted_model_is_milled_with(site: Path) -> None:
    assert used_for_next_door()[0] == 0
    accept(site)
    assert used_for_next_door()[0] == 1


def test_what_stops_milling_stops_the_path_generator(site: Path) -> None:
    with started(ModelMonitor) as monitor:
        monitor._watch._store.stop("the next door is expected to be 0.9 mm off")
    with started(PathGenerator) as generator:
        generator._take_recipe(recipe_message(shipped_recipes()[DOOR], "r1", Header()))
        assert getattr(generator._unfit, "code", 0) == 834


def test_a_path_generator_can_do_without_a_store(site: Path) -> None:
    accept(site)
    with started(PathGenerator, "-p", "models:=none") as generator:
        generator._take_recipe(recipe_message(shipped_recipes()[DOOR], "r1", Header()))
        assert (generator._setup.version, generator._unfit) == (0, None)


def order_something(site: Path) -> None:
    """Somebody tries to start a door at the page."""
    tokens = site / "page-tokens.yaml"
    with started(OperatorPage, "-p", "port:=0", "-p", f"tokens:={tokens}") as page:
        token = yaml.safe_load(tokens.read_text())["operate"]
        header = {"Authorization": f"Bearer {token}"}
        httpx.post(f"{page.url}control/cancel", headers=header, timeout=LIMIT)


def test_a_restored_site_mills_with_the_accepted_model_and_knows_who_ordered_what(
    site: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    accept(site)
    order_something(site)
    assert backup.main([str(tmp_path / "b.tar")]) == 0
    other = tmp_path / "other"
    monkeypatch.setenv("DOORMILL_SITE", str(other))
    assert restore.main([str(tmp_path / "b.tar")]) == 0, capsys.readouterr().err
    version, name = used_for_next_door()
    assert (version, Path(name).is_relative_to(other)) == (1, True)
    (order,) = ModelStore(other / "models").record().orders
    assert (order.who, order.why) == WHO
    (line,) = (other / "audit" / "orders.jsonl").read_text().splitlines()
    assert json.loads(line)["order"] == "POST /control/cancel"
