"""What doors cut is counted in the table of tools by the running cell, which refuses broken and worn ones."""

from __future__ import annotations

import json
import math
from pathlib import Path

import pytest

from doormill_interfaces.msg import AbbStatus, RunResult, TargetArray
from doormill_interfaces.srv import GetRecipe, ListRecipes
from doormill_ros.nodes.base import topics
from doormill_ros.nodes.convert.program import program_into
from doormill_ros.pipeline.plan import load_setup, plan
from doormill_ros.recipes.documents import load_recipe
from doormill_ros.recipes.exchange.tool_file import read_tool_file
from doormill_ros.recipes.store.database import RecipeDatabase
from support.cell_processes import CellProcesses

DOOR, OWN = "tabled_door", "thesis_190_0deg"
#: Two oblong hinges, 120 mm by 30 mm, round which the middle of a 19 mm mill goes once [m].
CUT = 2 * (2 * 0.090 + math.pi * 0.011)
LIFE = 2.5 * CUT


def stock(database: RecipeDatabase, folder: Path) -> None:
    """A shipped door with its mill in the table, which lasts for two and a half of it."""
    document = load_recipe(OWN).to_document()
    figures = {**document["tools"].pop("mill_19"), "length_mm": 120, "stiffness_n_mm": 1000, "life_m": LIFE}
    tools = {"schema": "doormill/tools/1", "tools": {"mill_19": figures}}
    for name, content in (
        ("tools.json", tools),
        ("door.json", {**document, "door_id": DOOR, "bar_code": "T1"}),
    ):
        (folder / name).write_text(json.dumps(content), encoding="utf-8")
    database.tools.save_all(read_tool_file(folder / "tools.json"), "anna")
    database.import_file(folder / "door.json", "anna")


def refused(cell: CellProcesses, code: int, *words: str) -> None:
    result, _ = cell.mill(DOOR)
    assert (result.success, result.error_code, result.target_file) == (False, code, ""), result.message
    for word in words:
        assert word in result.message


def test_a_tool_is_worn_door_by_door(tmp_path: Path) -> None:
    url = f"sqlite:///{tmp_path / 'recipes.sqlite'}"
    with RecipeDatabase(url) as database:
        stock(database, tmp_path)

        def cut() -> float:
            return database.tools.get("mill_19").tool.cut

        with CellProcesses(tmp_path / "cell", {"recipe_database": {"database_url": url}}) as cell:
            for number in (1, 2):
                result, _ = cell.mill(DOOR)
                assert result.success, result.message
                cell.wait(lambda number=number: cut() > (number - 0.5) * CUT)
                assert cut() == pytest.approx(number * CUT, rel=1e-6)

            # Half a door is left: refused before anything moves, and not counted.
            refused(cell, 308, "mill_19", "recipes tools renew mill_19")
            database.tools.mark_broken("mill_19", "anna")
            refused(cell, 149, "mill_19", "broken")
            assert cut() == pytest.approx(2 * CUT, rel=1e-6)
            database.tools.renew("mill_19", "anna")
            database.tools.expect("elsewhere", {"mill_19": 2 * LIFE})
            database.tools.count("elsewhere")
            refused(cell, 148, "mill_19", "after")
            database.tools.renew("mill_19", "anna")

            # The door that lists its own mill was never asked for that; the one of the table is good again.
            for door in (OWN, DOOR):
                result, _ = cell.mill(door)
                assert result.success, result.message
            cell.wait(lambda: cut() > 0.5 * CUT)
            assert cut() == pytest.approx(CUT, rel=1e-6)


def test_a_run_counts_once_the_robot_has_its_file(tmp_path: Path) -> None:
    """The node alone hears of runs that end in every way, from somebody who tells it as the cell would."""
    url = f"sqlite:///{tmp_path / 'recipes.sqlite'}"
    setup = load_setup()
    with RecipeDatabase(url) as database:
        stock(database, tmp_path)
        recipe = database.get(DOOR)
        program = plan(recipe, setup.layout.T_base_door(recipe.width, recipe.thickness), setup).program
        parameters = {"recipe_database": {"database_url": url}}
        with CellProcesses(tmp_path / "cell", parameters, nodes=("recipe_database",)) as cell:
            publishers = {
                topic.name: cell.node.create_publisher(topic.type, topic.name, topic.offered)
                for topic in (topics.PATH_TARGETS, topics.ABB_STATUS, topics.RUN_RESULT)
            }
            cell.wait(lambda: all(one.get_subscription_count() for one in publishers.values()))

            def tell(topic: topics.Topic, message: object) -> None:
                publishers[topic.name].publish(message)
                assert publishers[topic.name].wait_for_all_acked()
                for _ in range(2):  # whatever it has received it has dealt with before it answers twice
                    assert cell.ask(ListRecipes, "recipes/list", ListRecipes.Request()).recipes

            def begin(run: str, targets_of: str = "", accepted: bool = True) -> None:
                request = GetRecipe.Request(door_id=DOOR, run_id=run)
                assert cell.ask(GetRecipe, "recipes/get", request).success
                message = TargetArray(run_id=targets_of or run, accepted=accepted)
                program_into(message, program)
                tell(topics.PATH_TARGETS, message)

            def counted(doors: int) -> None:
                cell.wait(lambda: database.tools.get("mill_19").tool.cut > (doors - 0.5) * CUT)
                assert database.tools.get("mill_19").tool.cut == pytest.approx(doors * CUT, rel=1e-6)

            # It broke off while milling: nobody knows how far it came, so all of it counts.
            begin("broken_off")
            for state in ("ready", "milling", "milling", "failed"):
                tell(topics.ABB_STATUS, AbbStatus(run_id="broken_off", state=state))
            tell(topics.RUN_RESULT, RunResult(run_id="broken_off", error_code=491))
            counted(1)
            # Nothing was cut: the file was refused, the targets were, they were another run's.
            begin("refused")
            for state in ("ready", "acknowledged", "failed"):
                tell(topics.ABB_STATUS, AbbStatus(run_id="refused", state=state))
            tell(topics.RUN_RESULT, RunResult(run_id="refused", error_code=491))
            begin("unreachable", accepted=False)
            tell(topics.ABB_STATUS, AbbStatus(run_id="unreachable", state="milling"))
            begin("mine", targets_of="another")
            for run in ("mine", "another"):
                tell(topics.ABB_STATUS, AbbStatus(run_id=run, state="milling"))
            # Only the result was seen of this one; it counts once though it is told twice.
            begin("seen_late")
            tell(topics.RUN_RESULT, RunResult(run_id="seen_late", success=True))
            counted(2)
            tell(topics.RUN_RESULT, RunResult(run_id="seen_late", success=True))
            tell(topics.ABB_STATUS, AbbStatus(run_id="broken_off", state="done"))
            begin("last")
            tell(topics.ABB_STATUS, AbbStatus(run_id="last", state="milling"))
            counted(3)
