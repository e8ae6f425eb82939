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
    return _recipe(document)


def with_face_plate():
    """The document of the same door with a face plate round its lock case: that edge takes two tools."""
    document = parse_yaml(FILE.read_text())
    case = next(feature for feature in document["features"] if feature["kind"] == "lock_case")
    plate = {
        **case,
        **{"kind": "face_plate", "id": "face_plate", "lock_case": case["id"], "tool": "rack_mill_12"},
        **{"width_mm": 26, "length_mm": 180, "depth_mm": 3, "corner_radius_mm": 10},
        **{"passes": {"depth_step_mm": 3, "finish_allowance_mm": 0.3}},
    }
    plate["cutting"] = {"spindle_speed_rpm": 15000, "feed_mm_s": 60, "plunge_feed_mm_s": 20}
    return {**document, "features": [*document["features"], plate]}


def face_plate_door():
    """The recipe of `with_face_plate`."""
    return _recipe(with_face_plate())


def _recipe(document):
    return Recipe.from_document(
        completed(document, lambda names: {n: t for n, t in table().items() if n in names})
    )
