"""A door that two tools of the shipped rack mill, and its recipe with the figures of config/tools.yaml."""

from pathlib import Path

import yaml

from doormill_ros.recipes.documents import parse_yaml
from doormill_ros.recipes.recipe import Recipe
from doormill_ros.recipes.tabled_tool import completed, read_tool_table
from doormill_ros.resources import resource

FILE = Path(__file__).resolve().parent.parent / "data" / "two_tool_door.yaml"


def table():
    """The shipped tools by name."""
    return read_tool_table(yaml.safe_load(resource("config/tools.yaml").read_text())["tools"])


def two_tool_door(**tools):
    """The recipe; `tools` gives features other tools of the table, by identifier."""
    document = parse_yaml(FILE.read_text())
    for feature in document["features"]:
        feature["tool"] = tools.get(feature["id"], feature["tool"])
    return Recipe.from_document(
        completed(document, lambda names: {n: t for n, t in table().items() if n in names})
    )
