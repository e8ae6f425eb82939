"""The plan of the house, read from the imports: what stands above what, and that no room is walled up."""

from __future__ import annotations

import ast
import functools
import re
from collections.abc import Iterable, Mapping
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

from doormill_ros.recipes.features import registry as features
from support.source_tree import PACKAGE, ROOT, SOURCES, imports_of

NAME = PACKAGE.name
#: What takes part in milling a real door; none of it may need the laboratory or the simulation.
PRODUCTION = ("door_localizer", "recipe_database", "path_generator", "abb_bridge", "bag_recorder")
#: What judge, truth and the world of a simulated shift judge, and everything that is made of it.
JUDGED = (
    "toolpath",
    "correction",
    "diagnosis",
    "robot",
    "robot_model",
    "localization",
    "collision",
    "workspace",
    "pipeline",
    "identification",
    "measurements",
    "thesis",
)
LABORATORY = ("diagnosis", "thesis", "identification", "measurements", "simulation")


def module_name(path: Path) -> str:
    """Dotted name of a source file."""
    parts = path.relative_to(PACKAGE.parent).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


MODULES = {module_name(path): path for path in SOURCES}


def imported_modules(path: Path) -> set[str]:
    """Modules of the package that a file imports anywhere, `from package import module` resolved."""
    found = imports_of(path)
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and node.module:
            found |= {f"{node.module}.{alias.name}" for alias in node.names}
    return {name for name in found if name in MODULES and MODULES[name].name != "__init__.py"}


@functools.cache
def graph() -> dict[str, set[str]]:
    """Which module imports which."""
    return {
        name: imported_modules(path) - {name} for name, path in MODULES.items() if path.name != "__init__.py"
    }


def cycle_of(arrows: Mapping[str, Iterable[str]]) -> list[str]:
    """The nodes of one cycle, or nothing."""
    try:
        TopologicalSorter(arrows).prepare()
    except CycleError as error:
        return list(error.args[1])
    return []


def rooms_of(folder: str, arrows: Mapping[str, set[str]]) -> dict[str, set[str]]:
    """Which folder below a folder imports from which other one; `folder` is a dotted name."""
    depth = folder.count(".") + 2
    inside = {
        m: ".".join(m.split(".")[:depth])
        for m in arrows
        if m.startswith(f"{folder}.") and m.count(".") >= depth
    }
    rooms: dict[str, set[str]] = {}
    for module, room in inside.items():
        rooms.setdefault(room, set()).update(
            inside[m] for m in arrows[module] if m in inside and inside[m] != room
        )
    return rooms


def reach(starts: Iterable[str], arrows: Mapping[str, set[str]]) -> set[str]:
    """Everything that the starts need, themselves included."""
    seen: set[str] = set()
    todo = list(starts)
    while todo:
        name = todo.pop()
        if name not in seen:
            seen.add(name)
            todo.extend(arrows.get(name, ()))
    return seen


def test_cycles_and_ways_are_seen() -> None:
    """The tools of this file, on plans whose faults are known."""
    arrows = {"p.a.x": {"p.b.y"}, "p.b.y": {"p.c.z"}, "p.c.z": set(), "p.b.w": {"p.a.v"}, "p.a.v": set()}
    assert not cycle_of(arrows)
    assert set(cycle_of(rooms_of("p", arrows))) == {"p.a", "p.b"}
    assert reach(["p.b.y"], arrows) == {"p.b.y", "p.c.z"}
    assert len(graph()) > 200
    assert f"{NAME}.frames" in graph()[f"{NAME}.cell.places.layout"]


def test_no_two_files_import_each_other() -> None:
    """Also not for the type checker alone, nor inside a function."""
    assert cycle_of(graph()) == []


FOLDERS = sorted(
    {".".join(module.split(".")[:n]) for module in graph() for n in range(1, module.count(".") + 1)}
)


@pytest.mark.parametrize("folder", FOLDERS)
def test_rooms_stand_on_top_of_each_other(folder: str) -> None:
    assert cycle_of(rooms_of(folder, graph())) == []


def test_milling_a_door_needs_no_laboratory() -> None:
    needed = reach([f"{NAME}.nodes.{node}" for node in PRODUCTION], graph())
    assert len(needed) > 80
    assert {m for m in needed if m.split(".")[1] in LABORATORY} == set()


@pytest.mark.parametrize(
    ("room", "arm"), [("world", "truth.chain"), ("judge", "judge.links"), ("truth", "truth.chain")]
)
def test_who_judges_shares_no_model_with_what_is_judged(room: str, arm: str) -> None:
    """Neither itself nor through what it needs."""
    judges = [module for module in graph() if module.startswith(f"{NAME}.simulation.{room}.")]
    assert len(judges) >= 5
    needed = reach(judges, graph())
    assert f"{NAME}.simulation.{arm}" in needed
    assert {module for module in needed if module.split(".")[1] in JUDGED} == set()


def executables() -> set[str]:
    """Modules whose `main` a command or node of setup.py starts."""
    text = (ROOT / "setup.py").read_text(encoding="utf-8")
    return {
        f"{NAME}.{folder.lower()}.{item}"
        for folder, items in re.findall(r"^(NODES|TOOLS) = \[(.*?)\]", text, re.DOTALL | re.MULTILINE)
        for item in re.findall(r'"(\w+)"', items)
    }


def test_every_module_is_reached_from_an_executable() -> None:
    """What only tests, benches or bag making need stands in test/support or bags."""
    starts = executables()
    assert starts <= set(graph())
    # What setup.py has start the nodes.
    starts |= {f"{NAME}.nodes.process.executable"}
    # Migrations are found by alembic in their folder.
    starts |= {m for m in graph() if ".migrations." in m}
    # Features are imported by their registry, by the names that it lists.
    starts |= {f"{NAME}.recipes.features.{module}" for module in features.MODULES}
    assert sorted(set(graph()) - reach(starts, graph())) == []


def test_the_architecture_page_lists_the_rooms_from_the_ground_up() -> None:
    text = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
    table = text[text.index("## Rooms") : text.index("Beside the package")]
    listed = [
        room
        for row in re.findall(r"^\| (`\w+/`.*?) \|", table, re.MULTILINE)
        for room in re.findall(r"`(\w+)/`", row)
    ]
    rooms = {
        room.split(".")[1]: {below.split(".")[1] for below in others}
        for room, others in rooms_of(NAME, graph()).items()
    }
    assert sorted(listed) == sorted(rooms)
    for place, room in enumerate(listed):
        assert rooms[room] <= set(listed[:place]), f"{room} stands too low in docs/architecture.md"


#: Called by others than the package's own lines.
CALLED_FROM_OUTSIDE = {
    # rclpy calls the states of a managed node, alembic the steps of a migration, pickle the finder of its classes.
    *("on_configure", "on_activate", "on_deactivate", "on_cleanup", "on_shutdown", "downgrade", "find_class"),
    # What a person does at the simulated controller, who is somebody else in every test.
    *(
        "reload_modules",
        "set_mode",
        "emergency_stop",
        "release_emergency_stop",
        "open_guard",
        "close_guard",
        "lose",
    ),
    *("fail_power", "restore_power", "warm_start", "expire_sessions"),
    *("give_locally", "take_locally"),
    "compose_document",  # by the YAML reader
    # The README says whom these are for.
    *("load_motion_model", "cannot_see"),
}
#: Decorators that hand a function to nobody.
PLAIN = {"property", "cached_property", "staticmethod", "classmethod", "abstractmethod", "cache", "dataclass"}


def names_in(tree: ast.AST) -> set[str]:
    """What a file mentions: names, attributes, keywords and strings that could be one of them."""
    found = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Name):
            found.add(node.id)
        elif isinstance(node, ast.Attribute):
            found.add(node.attr)
        elif isinstance(node, ast.keyword) and node.arg:
            found.add(node.arg)
        elif isinstance(node, ast.Constant) and isinstance(node.value, str) and len(node.value) < 60:
            found.update(re.findall(r"\w+", node.value))
    return found


def defined_in(tree: ast.Module) -> set[str]:
    """Functions and methods that somebody has to call: none that a decorator registers or a library calls by name."""
    registered = {
        child
        for node in ast.walk(tree)
        if isinstance(node, ast.ClassDef) and any("Transformer" in ast.unparse(base) for base in node.bases)
        for child in node.body
    }
    return {
        node.name
        for node in ast.walk(tree)
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)
        and node not in registered
        and not (node.name.startswith("__") and node.name.endswith("__"))
        and {re.split(r"\W", ast.unparse(one).split(".")[-1])[0] for one in node.decorator_list} <= PLAIN
    }


def uncalled(sources: Mapping[str, str], others: Iterable[str] = ()) -> dict[str, list[str]]:
    """Functions of some files that no file mentions, nor any of the others, by file."""
    trees = {name: ast.parse(text) for name, text in sources.items()}
    mentioned: set[str] = set().union(
        *map(names_in, trees.values()), *(names_in(ast.parse(t)) for t in others)
    )
    found = {name: sorted(defined_in(tree) - mentioned) for name, tree in trees.items()}
    return {name: functions for name, functions in found.items() if functions}


def test_a_function_that_nobody_calls_is_seen() -> None:
    sources = {
        "a.py": "def used(): ...\nclass A:\n    def lost(self): ...\n    @route('x')\n    def served(self): ...\n",
        "b.py": "from a import used\nused()\n@cache\ndef kept(): ...\ndef alone(): ...\n",
    }
    assert uncalled(sources) == {"a.py": ["lost"], "b.py": ["alone", "kept"]}
    assert uncalled(sources, ["kept()"]) == {"a.py": ["lost"], "b.py": ["alone"]}


def test_every_function_is_called_by_the_product() -> None:
    """What only tests or benches call stands with them."""
    sources = {
        str(path.relative_to(ROOT)): path.read_text(encoding="utf-8")
        for path in SOURCES
        if "migrations" not in path.parts
    }
    makers = [path.read_text(encoding="utf-8") for path in sorted((ROOT / "scripts").glob("*.py"))]
    found = uncalled(sources, makers)
    assert {one for functions in found.values() for one in functions} <= CALLED_FROM_OUTSIDE, found
