"""recipes: import, list, show, export, draw and check the recipes of the factory, and keep its table of tools."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from doormill_ros.errors import DoormillError
from doormill_ros.interrupts import interruptible
from doormill_ros.recipes.documents import to_json, to_yaml
from doormill_ros.recipes.drawing import draw_recipe
from doormill_ros.recipes.errors import UnknownFileType
from doormill_ros.recipes.recipe import Recipe
from doormill_ros.recipes.store.database import RecipeDatabase, RecipeRecord
from doormill_ros.recipes.store.engine import ENVIRONMENT, check_file
from doormill_ros.tools.command_line import add_database, user_name
from doormill_ros.tools.one_line_parser import OneLineParser
from doormill_ros.tools.tool_table import add_tools_command, tools_command


def parser() -> argparse.ArgumentParser:
    """The command line."""
    top = OneLineParser(prog="recipes", description=__doc__)
    add_database(top, ENVIRONMENT)
    commands = top.add_subparsers(dest="command", required=True)
    command = commands.add_parser("import", help="store the recipes of a file that are new or changed")
    command.add_argument("file", help=".xlsx, .csv, .txt (the thesis' table), .yaml or .json")
    command.add_argument("--author", help="who imports; default is the user's name")
    command = commands.add_parser("list", help="list the newest recipe of every door")
    command.add_argument("--prefix", default="", help="only door ids that start so")
    for name, purpose in (
        ("show", "print a recipe"),
        ("draw", "draw a door with its features, and with its tool path"),
        ("check", "print a door's cutting data, generate its tool path, print its margins and times"),
    ):
        command = commands.add_parser(name, help=purpose)
        command.add_argument("id", help="door id, or bar code with --bar-code")
        command.add_argument("--bar-code", action="store_true", help="ID is a bar code")
        command.add_argument("--version", type=int, help="default is the newest")
        if name == "show":
            command.add_argument("--json", action="store_true", help="JSON instead of YAML")
            continue
        command.add_argument(
            "--robot-model", metavar="NAME", help="robot, or model.yaml of a diagnosis; default is the cell's"
        )
        if name == "check":
            command.add_argument("--robots", type=int, choices=(1, 2), default=1, help="default is 1")
            continue
        command.add_argument("--path", action="store_true", help="with the tool path and its corrections")
        command.add_argument("--factor", type=float, default=30.0, help="exaggerates them; default is 30")
        command.add_argument("--out", help="file to write, .svg, or .png with --path; default is ID.svg")
    command = commands.add_parser("export", help="write recipes to a file, without loss")
    command.add_argument("file", help=".xlsx, .csv, .txt (one thesis door), .yaml or .json")
    command.add_argument("ids", nargs="*", help="door ids; default is all")
    command = commands.add_parser("history", help="list every version of a door")
    command.add_argument("id")
    add_tools_command(commands)
    return top


@interruptible
def main(argv: list[str] | None = None) -> int:
    """Run the tool.

    Returns:
        0; 2 with one line on stderr when something asked for is wrong or absent.
    """
    arguments = parser().parse_args(argv)
    try:
        if arguments.database is not None and "import" not in _words(arguments):
            check_file(arguments.database)
        with RecipeDatabase(arguments.database) as database:
            if arguments.database is None:
                database.add_shipped()
            COMMANDS[arguments.command](database, arguments)
    except DoormillError as error:
        print(f"recipes: {' '.join(str(error).split())}", file=sys.stderr)
        return 2
    except BrokenPipeError:
        sys.stderr.close()  # the reader, such as head, has had enough
    return 0


def _words(arguments: argparse.Namespace) -> tuple[str, ...]:
    """The command, and of `tools` its own."""
    return (arguments.command, getattr(arguments, "tools_command", ""))


def _import(database: RecipeDatabase, arguments: argparse.Namespace) -> None:
    author = arguments.author if arguments.author is not None else user_name()
    report = database.import_file(arguments.file, author)
    for record in report.saved:
        print(f"saved {record.door_id} version {record.version}")
    for door_id in report.unchanged:
        print(f"unchanged {door_id}")


def _list(database: RecipeDatabase, arguments: argparse.Namespace) -> None:
    _print_records(database.list(arguments.prefix))


def _history(database: RecipeDatabase, arguments: argparse.Namespace) -> None:
    _print_records(database.history(arguments.id))


def _show(database: RecipeDatabase, arguments: argparse.Namespace) -> None:
    recipe = _chosen(database, arguments)
    print(to_json(recipe) if arguments.json else to_yaml(recipe).rstrip("\n"))


def _draw(database: RecipeDatabase, arguments: argparse.Namespace) -> None:
    recipe = _chosen(database, arguments)
    path = Path(arguments.out or f"{recipe.door_id}.svg")
    endings = (".svg", ".png") if arguments.path else (".svg",)
    if path.suffix.lower() not in endings:
        more = "" if arguments.path else ", and .png with --path"
        raise UnknownFileType(
            f"found the ending {path.suffix!r}, allowed is {' or '.join(endings)}{more}", found=path.suffix
        )
    if not arguments.path:
        print(draw_recipe(recipe).save(path))
        return
    # What draws takes a second to import, and only this asks for it.
    from doormill_ros.pipeline.plan import load_setup
    from doormill_ros.pipeline.preview import preview
    from doormill_ros.toolpath.drawing import draw_program, draw_ways, save_png

    (robot,) = preview(recipe, model=arguments.robot_model)
    if path.suffix.lower() == ".svg":
        drawing = draw_program(recipe, robot.program, robot.T_base_door, arguments.factor)
        setup = load_setup()
        draw_ways(drawing, robot.program, robot.T_base_door, setup.robot, setup.layout.T_flange_tool)
        print(drawing.save(path))
    else:
        print(save_png(path, recipe, robot.program, robot.T_base_door, arguments.factor))


def _check(database: RecipeDatabase, arguments: argparse.Namespace) -> None:
    from doormill_ros.pipeline.preview import preview
    from doormill_ros.recipes.cutting_advice import cutting_table
    from doormill_ros.toolpath.door_checks import cycle_budget, text_table
    from doormill_ros.toolpath.errors import PathError

    recipe = _chosen(database, arguments)
    robots = preview(recipe, arguments.robots, arguments.robot_model)
    for robot in robots:
        print(f"{robot.robot} robot")
        print(text_table(robot.check))
    print(cutting_table(recipe.features))
    whole = cycle_budget([robot.check for robot in robots])
    if len(robots) > 1:
        print(whole)
    elif not whole.kept:
        try:
            both = preview(recipe, 2, arguments.robot_model)
        except PathError as error:
            print(f"two robots cannot mill it: {error.message}")
        else:
            print(f"two robots: {cycle_budget([robot.check for robot in both])}")


def _export(database: RecipeDatabase, arguments: argparse.Namespace) -> None:
    recipes = database.export_file(arguments.file, arguments.ids or None)
    print(f"wrote {len(recipes)} recipes to {arguments.file}")


def _chosen(database: RecipeDatabase, arguments: argparse.Namespace) -> Recipe:
    door_id = database.find_bar_code(arguments.id).door_id if arguments.bar_code else arguments.id
    return database.get(door_id, arguments.version)


def _print_records(records: tuple[RecipeRecord, ...]) -> None:
    for record in records:
        moment = record.created.strftime("%Y-%m-%dT%H:%M:%SZ")
        print(f"{record.door_id}\t{record.version}\t{record.bar_code}\t{record.author}\t{moment}")


COMMANDS = {
    "import": _import,
    "list": _list,
    "show": _show,
    "export": _export,
    "history": _history,
    "draw": _draw,
    "check": _check,
    "tools": tools_command,
}

if __name__ == "__main__":
    sys.exit(main())
