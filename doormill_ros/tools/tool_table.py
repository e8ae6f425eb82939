"""The command `recipes tools`: the table of tools that recipes name."""

from __future__ import annotations

import argparse
from typing import Any

from doormill_ros.recipes.exchange.tool_file import format_tool, read_tool_file
from doormill_ros.recipes.store.database import RecipeDatabase
from doormill_ros.recipes.store.tool_table import ToolRecord
from doormill_ros.tools.command_line import user_name
from doormill_ros.units import m_to_mm

AUTHOR_HELP = "who says so; default is the user's name"


def add_tools_command(commands: Any) -> None:
    """Add `tools` with its own commands to the command line of `recipes`.

    Args:
        commands: What argparse gives for commands.
    """
    tools = commands.add_parser(
        "tools", help="the table of tools: figures, what they have cut, which are broken"
    )
    own = tools.add_subparsers(dest="tools_command", required=True)
    own.add_parser("list", help="list every tool with what it has cut of its life, and its state")
    command = own.add_parser("show", help="print a tool as a file to import")
    command.add_argument("name")
    command = own.add_parser("import", help="store the tools of a file that are new or have other figures")
    command.add_argument("file", help=".yaml or .json")
    command.add_argument("--author", help=AUTHOR_HELP)
    for name, purpose in (
        ("renew", "a new or sharpened tool stands in its place: it has cut nothing and is whole"),
        ("broken", "the tool must not be used until it is renewed"),
    ):
        command = own.add_parser(name, help=purpose)
        command.add_argument("name")
        command.add_argument("--author", help=AUTHOR_HELP)


def tools_command(database: RecipeDatabase, arguments: argparse.Namespace) -> None:
    """Do what the command line says; raises RecipeError."""
    table, command = database.tools, arguments.tools_command
    author = getattr(arguments, "author", None)
    author = user_name() if author is None else author
    if command == "list":
        for record in table.list():
            print(_line(record))
    elif command == "show":
        record = table.get(arguments.name)
        print(f"# {_line(record)}".replace("\t", "  "))
        print(format_tool(record.tool).rstrip("\n"))
    elif command == "import":
        tools = read_tool_file(arguments.file)
        changed = table.save_all(tools, author)
        for tool in tools:
            print(f"{'saved' if tool.name in changed else 'unchanged'} {tool.name}")
    elif command == "renew":
        table.renew(arguments.name, author)
        print(f"{arguments.name} is new")
    else:
        table.mark_broken(arguments.name, author)
        print(f"{arguments.name} is broken")


def _line(record: ToolRecord) -> str:
    tool = record.tool
    state = "broken" if record.broken else "worn" if tool.left <= 0.0 else "usable"
    size = f"{m_to_mm(tool.diameter):g} mm wide\t{m_to_mm(tool.length):g} mm long"
    return f"{tool.name}\t{size}\t{tool.cut:.1f} m of {tool.life:g} m cut\t{state}"
