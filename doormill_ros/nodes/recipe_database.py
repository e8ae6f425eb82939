"""Node /recipe_database: recipes by door id or bar code, and the recipe of the run in hand."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

from std_msgs.msg import Header

from doormill_interfaces.msg import DoorRecipe
from doormill_interfaces.srv import GetRecipe, ImportRecipes, ListRecipes
from doormill_ros.cell.graph.node_names import RECIPE_DATABASE
from doormill_ros.nodes.base import topics
from doormill_ros.nodes.base.managed_node import ManagedNode
from doormill_ros.nodes.base.named_door import check_named_once
from doormill_ros.nodes.base.node_parameter import NodeParameter
from doormill_ros.nodes.base.reporting_node import OK
from doormill_ros.nodes.convert.recipe import recipe_message, summary_message
from doormill_ros.nodes.milling.tool_wear import ToolWear
from doormill_ros.nodes.process.run import run_nodes
from doormill_ros.recipes.store.database import RecipeDatabase


class RecipeDatabaseNode(ManagedNode):
    """Answers recipes/get, recipes/list and recipes/import; publishes door/recipe."""

    PARAMETERS = (
        NodeParameter("database_url", "", "SQLAlchemy URL; empty: a SQLite file in the user's data folder"),
        NodeParameter(
            "ship_recipes", True, "put the recipes of config/recipes into a database that lacks them"
        ),
    )

    def __init__(self, **kwargs: Any) -> None:
        super().__init__(RECIPE_DATABASE, **kwargs)

    def setup(self) -> None:
        """Open the database and offer the services."""
        self._database = RecipeDatabase(self.value("database_url") or None)
        if self.value("ship_recipes"):
            self._database.add_shipped()
        self._in_hand = DoorRecipe()
        self._wear = ToolWear(self, self._database.tools)
        self._recipe = self.publisher(topics.DOOR_RECIPE)
        self.serve(GetRecipe, "recipes/get", self._get)
        self.serve(ListRecipes, "recipes/list", self._list)
        self.serve(ImportRecipes, "recipes/import", self._import)

    def rehearse(self) -> None:
        """Read a recipe, if there is one."""
        for record in self._database.list("", 1):
            recipe_message(self._database.get(record.door_id), "", Header())

    def teardown(self) -> None:
        """Close the database."""
        self._database.close()

    def _get(self, request: GetRecipe.Request, response: GetRecipe.Response) -> GetRecipe.Response:
        check_named_once(request)
        if request.run_id and request.run_id == self._in_hand.run_id:
            # Asked again: the answer was lost, the recipe is out already.
            response.recipe, response.success = self._in_hand, True
            return response
        if request.door_id:
            recipe = self._database.get(request.door_id, request.version or None)
        else:
            recipe = self._database.find_bar_code(request.bar_code)
        if request.run_id:
            self._database.tools.check(recipe)
        header = Header(stamp=self.get_clock().now().to_msg())
        response.recipe = recipe_message(recipe, request.run_id, header)
        response.success = True
        if request.run_id:
            self._in_hand = response.recipe
            self._wear.begin(request.run_id, recipe)
            self._recipe.publish(response.recipe)
            self.report(OK, "recipe in hand", door_id=recipe.door_id, version=recipe.version)
        return response

    def _list(self, request: ListRecipes.Request, response: ListRecipes.Response) -> ListRecipes.Response:
        records = self._database.list(request.door_id_prefix, request.limit or None)
        response.recipes = [summary_message(record) for record in records]
        return response

    def _import(
        self, request: ImportRecipes.Request, response: ImportRecipes.Response
    ) -> ImportRecipes.Response:
        report = self._database.import_file(Path(request.path), author=request.author)
        response.success = True
        response.door_ids = [record.door_id for record in report.saved]
        response.message = (
            f"{len(report.saved)} recipes imported from {request.path}, "
            f"{len(report.unchanged)} were there already"
        )
        return response


def main() -> int:
    """Run the node."""
    return run_nodes(RecipeDatabaseNode)


if __name__ == "__main__":
    sys.exit(main())
