"""The service recipes/get: a door by one of its two names."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
import rclpy
from rclpy.parameter import Parameter

from doormill_interfaces.srv import GetRecipe
from doormill_ros.abb.link_errors import DoorNameError
from doormill_ros.nodes.recipe_database import RecipeDatabaseNode
from doormill_ros.recipes.documents import load_recipe

DOOR = "standard_door"
CODE = load_recipe(DOOR).bar_code

Ask = Callable[..., GetRecipe.Response]


@pytest.fixture
def ask(context: rclpy.Context, tmp_path: Path) -> Iterator[Ask]:
    url = Parameter("database_url", value=f"sqlite:///{tmp_path / 'recipes.db'}")
    node = RecipeDatabaseNode(context=context, parameter_overrides=[url])
    node.bring_up()
    (service,) = (service for service in node.services if service.srv_name == "recipes/get")
    yield lambda **fields: service.callback(GetRecipe.Request(**fields), GetRecipe.Response())
    node.close()
    node.destroy_node()


def test_a_recipe_is_found_by_either_name(ask: Ask) -> None:
    for name in ({"door_id": DOOR}, {"bar_code": CODE}):
        answer = ask(**name)
        assert (answer.success, answer.error_code, answer.recipe.door_id) == (True, 0, DOOR)


@pytest.mark.parametrize("run_id", ["", "r1"])
@pytest.mark.parametrize(
    "names",
    [
        {},
        {"door_id": DOOR, "bar_code": CODE},
        {"door_id": "thesis_190_0deg", "bar_code": CODE},
        {"door_id": DOOR, "bar_code": "0000000000000"},
    ],
)
def test_two_names_or_none_are_refused(ask: Ask, names: dict[str, str], run_id: str) -> None:
    answer = ask(**names, run_id=run_id)
    assert (answer.success, answer.error_code) == (False, DoorNameError.code)
    for name in ("door_id", "bar_code"):
        assert f"{name} {'is ' if name == 'door_id' else ''}{names.get(name, '')!r}" in answer.message
    assert answer.message.endswith("exactly one of them is wanted")
    assert answer.recipe.door_id == ""
