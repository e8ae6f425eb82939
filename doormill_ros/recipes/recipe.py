"""A recipe: one door and everything that is milled into it."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from datetime import datetime
from typing import Annotated, Any

from doormill_ros.arrays import FloatArray
from doormill_ros.cell.rapid_limits import MAX_FEATURES
from doormill_ros.recipes import door as limits
from doormill_ros.recipes.checks import check_geometry
from doormill_ros.recipes.door import DoorSize, HingeSide, Material
from doormill_ros.recipes.errors import (
    DuplicateName,
    MissingField,
    NotAChoice,
    OutOfRange,
    WrongType,
)
from doormill_ros.recipes.features.base import Feature
from doormill_ros.recipes.features.registry import FEATURES
from doormill_ros.recipes.program import Program, check_program
from doormill_ros.recipes.quantities import (
    Moment,
    Name,
    Quantity,
    TextPattern,
    Whole,
)
from doormill_ros.recipes.reading import as_mapping, join, read_part, write_part
from doormill_ros.recipes.tabled_tool import TABLE, TOOLS, TabledTool, named_tools, read_tool_table
from doormill_ros.recipes.tool import Tool
from doormill_ros.values import Section

SCHEMA = "doormill/recipe/1"
BAR_CODE = TextPattern(re.compile(r"[\x21-\x7e]{1,64}"), "1 to 64 printable ASCII characters without blanks")
AUTHOR = TextPattern(re.compile(r"[^\x00-\x1f\x7f]{0,100}"), "at most 100 printable characters")


@dataclass(frozen=True)
class ClampPlacement(Section):
    """Where a simulated clamp shall put the door; a real cell ignores it.

    Attributes:
        y: Offset along base y [m].
        z: Offset along base z [m].
        rotation: About base x [rad].
    """

    y: Annotated[float, Quantity("mm", -10.0, 10.0)] = 0.0
    z: Annotated[float, Quantity("mm", -10.0, 10.0)] = 0.0
    rotation: Annotated[float, Quantity("deg", -2.0, 2.0)] = 0.0


@dataclass(frozen=True, kw_only=True)
class Recipe(Section):
    """A checked recipe; build it with `from_document`, which refuses a wrong one.

    Attributes:
        door_id: Name of the door.
        bar_code: What the reader on the handling robot's gripper reads.
        version: Number that the database gave it, from 1; 0 when it was never saved.
        author: Who saved it.
        created: When it was saved, UTC.
        width: Along y of the door frame [m].
        height: Along z [m].
        thickness: Along x [m].
        hinge_side: Where the hinges are, seen from the side to which the door opens.
        material: What the door is made of.
        mass: Mass before milling [kg].
        placement: Where a simulated clamp puts the door; None to leave it to the simulation.
        program: Which program of the robot mills it.
        features: What is milled, in the order of milling.
    """

    door_id: Name
    bar_code: Annotated[str, BAR_CODE]
    version: Annotated[int, Whole(0, 2_000_000_000)] = 0
    author: Annotated[str, AUTHOR] = ""
    created: Annotated[datetime | None, Moment()] = None
    height: Annotated[float, Quantity("mm", *limits.HEIGHT_MM)]
    width: Annotated[float, Quantity("mm", *limits.WIDTH_MM)]
    thickness: Annotated[float, Quantity("mm", *limits.THICKNESS_MM)]
    hinge_side: HingeSide
    material: Material
    mass: Annotated[float, Quantity("kg", *limits.MASS_KG)]
    placement: ClampPlacement | None = None
    program: Program = Program.GENERAL
    features: tuple[Feature, ...] = ()

    @property
    def size(self) -> DoorSize:
        """Height, width and thickness [m], and which way up the door stands."""
        return DoorSize(self.height, self.width, self.thickness, self.hinge_side is HingeSide.LEFT)

    @property
    def tools(self) -> dict[str, Tool]:
        """The tools in use by name, in the order of first use."""
        return {feature.tool.name: feature.tool for feature in self.features}

    def feature(self, feature_id: str) -> Feature:
        """The feature with this identifier; raises KeyError when there is none."""
        return {feature.id: feature for feature in self.features}[feature_id]

    def T_door_feature(self, feature: Feature) -> FloatArray:
        """Feature frame in the door frame, shape (4, 4)."""
        return feature.T_door_feature(self.size)

    def stamped(self, version: int, author: str, created: datetime) -> Recipe:
        """The same recipe with the version, author and time of its record."""
        return replace(self, version=version, author=author, created=created)

    def to_document(self) -> dict[str, Any]:
        """Plain dict of text, numbers, lists and dicts; `from_document` gives an equal recipe."""
        own = {
            n: write_part(t, without="name") for n, t in self.tools.items() if not isinstance(t, TabledTool)
        }
        table = {n: write_part(t, without="name") for n, t in self.tools.items() if isinstance(t, TabledTool)}
        features = [{"kind": feature.kind, **write_part(feature)} for feature in self.features]
        return {
            "schema": SCHEMA,
            **write_part(self, without="features"),
            TOOLS: own,
            **({TABLE: table} if table else {}),
            "features": features,
        }

    @classmethod
    def from_document(cls, document: Any) -> Recipe:
        """Read, check and build a recipe.

        Args:
            document: What `to_document` gives, or a YAML or JSON file holds.

        Raises:
            FieldError: The leaf class says what is wrong, `field` where.
        """
        recipe = cls.from_checked(document)
        check_geometry(recipe.size, recipe.mass, recipe.features)
        check_program(recipe.program, recipe.features)
        return recipe

    @classmethod
    def from_checked(cls, document: Any) -> Recipe:
        """Build a recipe of which is known that its features go with the door, its tools and its program.

        Args:
            document: What `to_document` gave of a checked recipe; whoever calls has to know that.

        Raises:
            FieldError: A field is unknown, missing or wrong by itself.
        """
        document = as_mapping(document, "")
        if "schema" not in document:
            raise MissingField("schema", f"is missing, allowed is {SCHEMA!r}", found=None)
        if document["schema"] != SCHEMA:
            raise NotAChoice("schema", f"found {document['schema']!r}, allowed is {SCHEMA!r}")
        recipe = read_part(cls, document, "", beside=("schema", TOOLS, TABLE, "features"))
        tools = _with_table(_read_tools(document.get(TOOLS)), document.get(TABLE, {}))
        return replace(recipe, features=_read_features(document.get("features"), tools))


def _read_tools(document: Any) -> dict[str, Tool]:
    if document is None:
        raise MissingField("tools", "is missing, the tools of the features must be given by name", found=None)
    return {
        name: read_part(Tool, {"name": name, **content}, path)
        for name, content, path in named_tools(document, TOOLS)
    }


def _with_table(own: dict[str, Tool], document: Any) -> dict[str, Tool]:
    table = read_tool_table(document)
    for name in own.keys() & table.keys():
        raise DuplicateName(
            join(TABLE, name), f"the recipe lists {name!r} among its own tools too, take one away"
        )
    return own | table


def _read_features(document: Any, tools: dict[str, Tool]) -> tuple[Feature, ...]:
    if document is None:
        raise MissingField("features", "is missing, a list of features must be given", found=None)
    if not isinstance(document, list | tuple):
        raise WrongType("features", f"found {document!r:.80}, allowed is a list", found=document)
    if not 1 <= len(document) <= MAX_FEATURES:
        raise OutOfRange("features", f"found {len(document)} features, allowed are 1 to {MAX_FEATURES}")
    features: list[Feature] = []
    seen: dict[str, int] = {}
    for index, content in enumerate(document):
        path = join("features", index)
        content = as_mapping(content, path)
        kind = content.get("kind")
        if kind is None:
            raise MissingField(join(path, "kind"), f"is missing, allowed is one of {list(FEATURES)}")
        if not isinstance(kind, str):
            raise WrongType(join(path, "kind"), f"found {kind!r}, allowed is one of {list(FEATURES)}")
        if kind not in FEATURES:
            raise NotAChoice(join(path, "kind"), f"found {kind!r}, allowed is one of {list(FEATURES)}")
        feature = read_part(FEATURES[kind], content, path, {"tools": tools}, beside=("kind",))
        if feature.id in seen:
            raise DuplicateName(
                join(path, "id"), f"found {feature.id!r}, which features.{seen[feature.id]} has already"
            )
        seen[feature.id] = index
        features.append(feature)
    return tuple(features)
