"""Read and write recipe files; the ending of the name chooses the format."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import yaml

from doormill_ros.files import NotUtf8, read_regular, text_of_utf8, write_atomically
from doormill_ros.recipes.documents import parse_json, parse_yaml, read_text
from doormill_ros.recipes.errors import (
    DuplicateName,
    FieldError,
    NotExpressible,
    UnreadableFile,
)
from doormill_ros.recipes.exchange.csv_file import RECORD, format_csv, parse_csv
from doormill_ros.recipes.exchange.ending import ending_of
from doormill_ros.recipes.exchange.thesis_text import decode, format_thesis_text, parse_thesis_text
from doormill_ros.recipes.reading import located
from doormill_ros.recipes.recipe import Recipe
from doormill_ros.recipes.tabled_tool import LookUp, completed

ENDINGS = (".xlsx", ".csv", ".txt", ".yaml", ".yml", ".json")


def read_file(path: str | Path, look_up: LookUp | None = None) -> list[Recipe]:
    """The checked recipes of a file, in its order.

    Args:
        path: The file.
        look_up: Gives those of some tools that the table of tools has, by name; None where there is none.

    Raises:
        UnknownFileType: The ending stands for no format.
        ExchangeError: The file cannot be read; the message says where.
        FieldError: A recipe is wrong; the message says where.
    """
    path = Path(path)
    ending = ending_of(path, ENDINGS)
    if ending == ".xlsx":
        if not path.is_file():
            raise UnreadableFile(f"{path}: no such file")
        from doormill_ros.recipes.exchange.xlsx_file import read_xlsx  # late: a node rarely meets one

        recipes = read_xlsx(path, look_up)
    elif ending == ".txt":
        recipes = [parse_thesis_text(decode(_bytes(path), str(path)), str(path), path.stem)]
    elif ending == ".csv":
        content = _bytes(path)
        text = decode(content, str(path))
        if RECORD not in text:
            # A guess of what the bytes mean was wrong where no column is found in it.
            _check_utf8(content, path)
        recipes = parse_csv(text, str(path), look_up)
    else:
        parse = parse_json if ending == ".json" else parse_yaml
        recipes = _documents(parse(read_text(path), str(path)), path, look_up)
    seen: set[str] = set()
    for recipe in recipes:
        if recipe.door_id in seen:
            raise DuplicateName("door_id", f"{path}: door {recipe.door_id!r} is there twice")
        seen.add(recipe.door_id)
    return recipes


def write_file(path: str | Path, recipes: Sequence[Recipe]) -> None:
    """Write recipes so that `read_file` gives equal ones.

    Raises:
        UnknownFileType: The ending stands for no format.
        NotExpressible: The thesis' text table cannot hold a recipe; nothing is written.
        UnreadableFile: The file cannot be written; one that was there stays as it was.
    """
    path = Path(path)
    ending = ending_of(path, ENDINGS)
    try:
        content = _sheet(recipes) if ending == ".xlsx" else _text(ending, path, recipes)
        write_atomically(path, content)
    except OSError as error:
        raise UnreadableFile(f"{path}: cannot be written, {error.strerror}") from error


def _sheet(recipes: Sequence[Recipe]) -> bytes:
    from doormill_ros.recipes.exchange.xlsx_file import format_xlsx  # late, as above

    return format_xlsx(recipes)


def _text(ending: str, path: Path, recipes: Sequence[Recipe]) -> str:
    if ending == ".csv":
        return format_csv(recipes)
    if ending == ".txt":
        if len(recipes) != 1:
            raise NotExpressible(f"{path}: found {len(recipes)} doors, the thesis' text table holds one")
        return format_thesis_text(recipes[0])
    documents: Any = [recipe.to_document() for recipe in recipes]
    if len(documents) == 1:
        documents = documents[0]
    if ending == ".json":
        return json.dumps(documents, ensure_ascii=False, allow_nan=False, indent=1) + "\n"
    return yaml.safe_dump(documents, sort_keys=False, allow_unicode=True, width=110)


def _documents(document: Any, path: Path, look_up: LookUp | None) -> list[Recipe]:
    """A file holds one document or a list of them."""
    many = document if isinstance(document, list) else [document]
    recipes = []
    for index, item in enumerate(many):
        try:
            recipes.append(Recipe.from_document(completed(item, look_up)))
        except FieldError as error:
            where = f"{path} document {index + 1}" if len(many) > 1 else str(path)
            raise located(error, where) from error
    return recipes


def _bytes(path: Path) -> bytes:
    try:
        return read_regular(path)
    except OSError as error:
        raise UnreadableFile(f"{path}: cannot be read, {error.strerror}") from error


def _check_utf8(content: bytes, path: Path) -> None:
    try:
        text_of_utf8(content)
    except NotUtf8 as error:
        raise UnreadableFile(f"{path}: {error}, save it as UTF-8") from error
