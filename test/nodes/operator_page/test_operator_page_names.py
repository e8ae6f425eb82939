"""Under which names the node serves the page: its parameters `host` and `names`, and what of them is refused."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import httpx
import pytest
import rclpy
from rclpy.lifecycle import TransitionCallbackReturn
from rclpy.parameter import Parameter

from doormill_ros.nodes.operator_page import OperatorPage
from support.waiting import LIMIT

NAME = "cell1.factory.example"
#: The system takes it for 127.0.0.1, but it is no IP address as written: a name of its own on every machine.
HOST = "127.1"


@pytest.fixture
def make(context: rclpy.Context, tmp_path: Path) -> Iterator[Callable[..., OperatorPage]]:
    """Makes pages on a free port."""
    made: list[OperatorPage] = []

    def page(**given: str) -> OperatorPage:
        texts = {**{name: str(tmp_path / name) for name in ("history", "audit")}, **given}
        parameters = [Parameter("port", value=0), *(Parameter(name, value=v) for name, v in texts.items())]
        made.append(OperatorPage(parameter_overrides=parameters, context=context))
        return made[-1]

    yield page
    for node in made:
        node.close()
        node.destroy_node()


@pytest.mark.parametrize(
    ("given", "host", "status"),
    [
        ({"host": "0.0.0.0"}, "evil.example:8080", 400),
        ({"host": "0.0.0.0"}, NAME, 400),
        ({"host": "0.0.0.0", "names": f"other, {NAME.upper()}"}, NAME, 200),
        ({}, HOST, 400),
        ({"host": HOST}, HOST, 200),
    ],
)
def test_the_page_answers_to_its_parameters(
    make: Callable[..., OperatorPage], given: dict[str, str], host: str, status: int
) -> None:
    page = make(**given)
    assert page.trigger_configure() == TransitionCallbackReturn.SUCCESS
    url = f"http://127.0.0.1:{httpx.URL(page.url).port}/state"
    headers = {"Host": host, "Origin": f"http://{host}"}
    assert httpx.get(url, headers=headers, timeout=LIMIT).status_code == status


@pytest.mark.parametrize("wrong", ["https://cell", "cell:8080", "a b", "*", "cell/"])
def test_what_is_no_host_name_is_said_and_nothing_is_served(
    make: Callable[..., OperatorPage], wrong: str
) -> None:
    page = make(names=f"{NAME}, {wrong}")
    assert page.trigger_configure() != TransitionCallbackReturn.SUCCESS
    assert repr(wrong) in page._health[1]
    assert "correct the parameter names" in page._health[1]
    assert page.url == ""
