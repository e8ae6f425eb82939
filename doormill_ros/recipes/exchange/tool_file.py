"""Tools for the table of tools from a YAML or JSON file, and one of them as text."""

from __future__ import annotations

from pathlib import Path

import yaml

from doormill_ros.recipes.documents import parse_json, parse_yaml, read_text
from doormill_ros.recipes.errors import (
    FieldError,
    MissingField,
    NotAChoice,
    UnknownField,
)
from doormill_ros.recipes.exchange.ending import ending_of
from doormill_ros.recipes.reading import as_mapping, located
from doormill_ros.recipes.tabled_tool import TOOLS, TabledTool, figures_of, read_tool_table

TOOL_SCHEMA = "doormill/tools/1"
TOOL_ENDINGS = (".yaml", ".yml", ".json")
KEYS = ("schema", TOOLS)


def read_tool_file(path: str | Path) -> list[TabledTool]:
    """The tools of a file, in its order.

    Raises:
        UnknownFileType: The ending stands for no format.
        UnreadableFile: The file cannot be read.
        FieldError: A tool is wrong; the message says where.
    """
    path = Path(path)
    parse = parse_json if ending_of(path, TOOL_ENDINGS) == ".json" else parse_yaml
    content = parse(read_text(path), str(path))
    try:
        document = as_mapping(content, "")
        for key in document:
            if key not in KEYS:
                raise UnknownField(key, f"is not a field, allowed are {', '.join(KEYS)}", found=key)
        for key in KEYS:
            if key not in document:
                raise MissingField(
                    key, f"is missing, allowed is a file of the form {TOOL_SCHEMA}", found=None
                )
        if document["schema"] != TOOL_SCHEMA:
            raise NotAChoice("schema", f"found {document['schema']!r:.80}, allowed is {TOOL_SCHEMA!r}")
        return list(read_tool_table(document[TOOLS], TOOLS, counted=False).values())
    except FieldError as error:
        raise located(error, str(path)) from error


def format_tool(tool: TabledTool) -> str:
    """YAML text of a file with one tool; `read_tool_file` gives an equal one."""
    document = {"schema": TOOL_SCHEMA, TOOLS: {tool.name: figures_of(tool)}}
    return yaml.safe_dump(document, sort_keys=False, allow_unicode=True, width=110)
