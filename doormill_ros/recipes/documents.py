"""Read and write recipe documents as YAML and JSON text, and find the recipes that ship."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import yaml

from doormill_ros.files import NotUtf8, read_utf8
from doormill_ros.recipes.errors import DuplicateField, FieldError, UnreadableFile
from doormill_ros.recipes.reading import located
from doormill_ros.recipes.recipe import Recipe
from doormill_ros.resources import resource
from doormill_ros.yaml_text import DuplicateKey, NotYaml, parse

SHIPPED = "config/recipes"


def parse_yaml(text: str, name: str = "document") -> Any:
    """The value of a YAML text.

    Raises:
        UnreadableFile: The text is not YAML; the message has line and column.
        DuplicateField: A field is given twice.
    """
    try:
        return parse(text)
    except DuplicateKey as error:
        twice = DuplicateField(error.key, f"is given twice, the second time in line {error.line}")
        raise located(twice, name) from error
    except NotYaml as error:
        raise UnreadableFile(f"{name}{error.where}: not YAML, {error.problem}") from error


def parse_json(text: str, name: str = "document") -> Any:
    """The value of a JSON text.

    Raises:
        UnreadableFile: The text is not JSON; the message has line and column.
        DuplicateField: A field is given twice.
    """
    try:
        return json.loads(text, object_pairs_hook=_unique)
    except DuplicateField as error:
        raise located(error, name) from error
    except json.JSONDecodeError as error:
        raise UnreadableFile(
            f"{name} line {error.lineno}, column {error.colno}: not JSON, {error.msg}"
        ) from error
    except RecursionError as error:
        raise UnreadableFile(f"{name}: not a recipe, nested too deeply") from error
    except ValueError as error:  # an integer of thousands of digits
        raise UnreadableFile(f"{name} line {_line_of_longest(text)}: not a recipe, {error}") from error


def _line_of_longest(text: str) -> int:
    """The line with the longest row of digits, counted from 1."""
    longest = max(re.finditer(r"\d+", text), key=lambda digits: len(digits[0]))
    return text.count("\n", 0, longest.start()) + 1


def _unique(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    document: dict[str, Any] = {}
    for key, value in pairs:
        if key in document:
            raise DuplicateField(key, "is given twice")
        document[key] = value
    return document


def to_yaml(recipe: Recipe) -> str:
    """YAML text of a recipe."""
    return yaml.safe_dump(recipe.to_document(), sort_keys=False, allow_unicode=True, width=110)


def to_json(recipe: Recipe) -> str:
    """JSON text of a recipe, one line."""
    return json.dumps(recipe.to_document(), ensure_ascii=False, allow_nan=False, separators=(",", ":"))


def read_text(path: Path) -> str:
    """The text of a file.

    Raises:
        UnreadableFile: Absent, no regular file, or not UTF-8.
    """
    try:
        return read_utf8(path)
    except OSError as error:
        raise UnreadableFile(f"{path}: cannot be read, {error.strerror}") from error
    except NotUtf8 as error:
        raise UnreadableFile(f"{path}: {error}, save it as UTF-8") from error


def load_recipe(name_or_path: str | Path) -> Recipe:
    """A recipe from a YAML or JSON file, or a shipped one by its door id.

    Raises:
        UnreadableFile: No such file, or not YAML or JSON.
        FieldError: The recipe is wrong; see `Recipe.from_document`.
    """
    path = Path(name_or_path)
    if path.suffix.lower() not in (".yaml", ".yml", ".json"):
        try:
            path = resource(f"{SHIPPED}/{name_or_path}.yaml")
        except FileNotFoundError as error:
            raise UnreadableFile(
                f"{name_or_path}: no such recipe file, and no recipe of that name ships"
            ) from error
    read = parse_json if path.suffix.lower() == ".json" else parse_yaml
    document = read(read_text(path), str(path))
    try:
        return Recipe.from_document(document)
    except FieldError as error:
        raise located(error, str(path)) from error


def shipped_recipes() -> dict[str, Recipe]:
    """Every recipe of config/recipes by door id."""
    paths = sorted(resource(SHIPPED).glob("*.yaml"))
    return {recipe.door_id: recipe for recipe in map(load_recipe, paths)}
