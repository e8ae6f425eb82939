"""A tool of the table of tools: one that recipes name, with its life."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Annotated, Any

from doormill_ros.recipes.errors import DuplicateName, UnknownField, UnknownTool
from doormill_ros.recipes.quantities import NAME, Quantity
from doormill_ros.recipes.reading import as_mapping, join, read_part, read_value, write_part
from doormill_ros.recipes.tool import Tool

TOOLS, TABLE = "tools", "tool_table"  #: keys of a recipe: tools of its own, and copies of those of the table
COUNTED = "cut_m"


@dataclass(frozen=True, kw_only=True)
class TabledTool(Tool):
    """A mill that the table knows, one that exists once.

    Attributes:
        length: How far it stands out of the spindle [m].
        corner: Radius of its corners, 0 for sharp ones [m].
        stiffness: Of the mill in its holder, across, at the tip [N/m].
        life: How far it cuts until it is worn [m].
        cut: How far it has cut since it was new [m]. Tools that differ by that alone are equal: whatever was worked
            out for one of them holds for the other.
    """

    length: Annotated[float, Quantity("mm", 5.0, 400.0)]
    corner: Annotated[float, Quantity("mm", 0.0, 30.0)] = 0.0
    stiffness: Annotated[float, Quantity("n_mm", 1.0, 1e6)]
    life: Annotated[float, Quantity("m", 0.1, 1e6)]
    cut: Annotated[float, Quantity("m", 0.0, 1e9)] = field(default=0.0, compare=False)

    @property
    def left(self) -> float:
        """How far it still cuts [m]."""
        return max(self.life - self.cut, 0.0)


#: Gives those of some tools that the table has, by name.
LookUp = Callable[[Collection[str]], Mapping[str, TabledTool]]


def figures_of(tool: TabledTool) -> dict[str, Any]:
    """The document of a tool, without its name and without what it has cut."""
    written = write_part(tool, without="name")
    written.pop(COUNTED)
    return written


def read_tool_table(document: Any, path: str = TABLE, counted: bool = True) -> dict[str, TabledTool]:
    """The tools of a mapping of names to figures.

    Args:
        document: The mapping.
        path: Dotted path of it, for messages.
        counted: It says what they have cut; a file that somebody wrote must not.

    Raises:
        FieldError: The leaf class says what is wrong, `field` where.
    """
    tools = {}
    for name, content, here in named_tools(document, path):
        if COUNTED in content and not counted:
            raise UnknownField(
                join(here, COUNTED), "is counted by the database, leave it out", found=content[COUNTED]
            )
        tools[name] = read_part(TabledTool, {"name": name, **content}, here)
    return tools


def named_tools(document: Any, path: str) -> Iterator[tuple[str, Mapping[str, Any], str]]:
    """Names of the tools of a mapping of names to figures, those figures and their dotted path, one tool at a time.

    Raises:
        FieldError: It is no mapping, or a name is wrong or given twice.
    """
    for name, content in as_mapping(document, path).items():
        here = join(path, name)
        read_value(NAME.read, name, here)
        content = as_mapping(content, here)
        if "name" in content:
            raise DuplicateName(join(here, "name"), f"the name {name!r} is already given, leave it out")
        yield name, content, here


def completed(document: Any, look_up: LookUp | None) -> Any:
    """A recipe's document with the present figures of the tools that its features take from the table.

    Args:
        document: What shall become a recipe; what is wrong with it otherwise is left to whoever reads it.
        look_up: Gives those of some tools that the table has, by name; None where there is no table, and a document
            is taken with the copies that it brings.

    Raises:
        UnknownTool: A feature names one that neither the recipe nor the table has.
    """
    wanted = dict(_named_beside(document))
    if not wanted or look_up is None:
        return document
    found = look_up(wanted)
    for name, path in wanted.items():
        if name not in found:
            raise UnknownTool(
                path,
                f"found {name!r}, which neither the recipe's tools nor the table of tools has; correct the name, or "
                "import the tool (recipes tools import)",
                found=name,
            )
    table = {name: {**figures_of(tool), COUNTED: tool.cut} for name, tool in found.items()}
    return {**document, TABLE: table}


def _named_beside(document: Any) -> Iterator[tuple[str, str]]:
    """Names of the tools that features take and the recipe does not list, with the dotted path of one such feature."""
    if not isinstance(document, Mapping) or not isinstance(document.get(TOOLS), Mapping):
        return
    features = document.get("features")
    for index, feature in enumerate(features if isinstance(features, list | tuple) else ()):
        name = feature.get("tool") if isinstance(feature, Mapping) else None
        if isinstance(name, str) and name not in document[TOOLS]:
            yield name, join("features", index, "tool")
