"""A recipe: one door and everything that is milled into it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime
from typing import Any

from doormill_ros.arrays import FloatArray
from doormill_ros.recipes import door as limits
from doormill_ros.recipes.checks import check_geometry
from doormill_ros.recipes.door import DoorSize, HingeSide, Material
from doormill_ros.recipes.errors import (
    BadText,
    DuplicateName,
    MissingField,
    NotAChoice,
    OutOfRange,
    WrongType,
)
from doormill_ros.recipes.features.base import Feature
from doormill_ros.recipes.features.registry import FEATURES
from doormill_ros.recipes.fields import (
    NAME,
    Choice,
    Codec,
    Nested,
    Quantity,
    Text,
    Whole,
    as_mapping,
    entry,
    join,
    load_object,
    read_object,
    write_object,
)
from doormill_ros.recipes.program import Program, check_program
from doormill_ros.recipes.tool import Tool

SCHEMA = "doormill/recipe/1"
MAX_FEATURES = 40


@dataclass(frozen=True)
class Moment(Codec):
    """A moment in time, ISO 8601 with an offset in the document, UTC inside."""

    def read(self, value: Any, path: str, context: Mapping[str, Any]) -> datetime:
        """See the base class."""
        if not isinstance(value, str | datetime):
            raise WrongType(path, f"found {value!r}, allowed is a time such as 2026-01-31T12:00:00Z")
        try:
            moment = value if isinstance(value, datetime) else datetime.fromisoformat(value)
        except ValueError:
            raise BadText(path, f"found {value!r}, allowed is a time such as 2026-01-31T12:00:00Z") from None
        if moment.tzinfo is None:
            raise BadText(path, f"found {value!r}, allowed is a time with its offset from UTC, such as Z")
        return moment.astimezone(UTC)

    def load(self, value: str, context: Mapping[str, Any]) -> datetime:
        """See the base class."""
        return datetime.fromisoformat(value).astimezone(UTC)

    def write(self, value: datetime) -> str:
        """See the base class."""
        return value.isoformat()


@dataclass(frozen=True)
class Placement:
    """Where a simulated clamp shall put the door; a real cell ignores it.

    Attributes:
        y: Offset along base y [m].
        z: Offset along base z [m].
        rotation: About base x [rad].
    """

    y: float = entry(Quantity("mm", -10.0, 10.0), default=0.0)
    z: float = entry(Quantity("mm", -10.0, 10.0), default=0.0)
    rotation: float = entry(Quantity("deg", -2.0, 2.0), default=0.0)


@dataclass(frozen=True, kw_only=True)
class Recipe:
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

    door_id: str = entry(NAME)
    bar_code: str = entry(Text(r"[\x21-\x7e]{1,64}", "1 to 64 printable ASCII characters without blanks"))
    version: int = entry(Whole(0, 2_000_000_000), default=0)
    author: str = entry(Text(r"[^\x00-\x1f\x7f]{0,100}", "at most 100 printable characters"), default="")
    created: datetime | None = entry(Moment(), default=None)
    height: float = entry(Quantity("mm", *limits.HEIGHT_MM))
    width: float = entry(Quantity("mm", *limits.WIDTH_MM))
    thickness: float = entry(Quantity("mm", *limits.THICKNESS_MM))
    hinge_side: HingeSide = entry(Choice(HingeSide))
    material: Material = entry(Choice(Material))
    mass: float = entry(Quantity("kg", *limits.MASS_KG))
    placement: Placement | None = entry(Nested(Placement), default=None)
    program: Program = entry(Choice(Program), default=Program.GENERAL)
    features: tuple[Feature, ...] = field(default=())

    @property
    def size(self) -> DoorSize:
        """Height, width and thickness [m]."""
        return DoorSize(self.height, self.width, self.thickness)

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
        document = {"schema": SCHEMA, **write_object(self)}
        document["tools"] = {}
        for name, tool in self.tools.items():
            document["tools"][name] = {k: v for k, v in write_object(tool).items() if k != "name"}
        document["features"] = [{"kind": item.kind, **write_object(item)} for item in self.features]
        return document

    @classmethod
    def from_document(cls, document: Any) -> Recipe:
        """Read, check and build a recipe.

        Args:
            document: What `to_document` gives, or a YAML or JSON file holds.

        Raises:
            FieldError: The leaf class says what is wrong, `field` where.
        """
        document = as_mapping(document, "")
        if "schema" not in document:
            raise MissingField("schema", f"is missing, allowed is {SCHEMA!r}", found=None)
        if document["schema"] != SCHEMA:
            raise NotAChoice("schema", f"found {document['schema']!r}, allowed is {SCHEMA!r}")
        recipe = read_object(cls, document, "", {}, ignore=("schema", "tools", "features"))
        tools = _read_tools(document.get("tools"))
        recipe = replace(recipe, features=_read_features(document.get("features"), tools))
        check_geometry(recipe)
        check_program(recipe)
        return recipe

    @classmethod
    def from_checked(cls, document: Mapping[str, Any]) -> Recipe:
        """Build a recipe from what `to_document` gave of a checked one, without checking it again.

        Args:
            document: Unchanged since it was checked; whoever calls has to know that.
        """
        tools = {
            name: load_object(Tool, {"name": name, **content}, {})
            for name, content in document["tools"].items()
        }
        context = {"tools": tools}
        features = tuple(load_object(FEATURES[f["kind"]], f, context) for f in document["features"])
        return replace(load_object(cls, document, {}), features=features)


def _read_tools(document: Any) -> dict[str, Tool]:
    if document is None:
        raise MissingField("tools", "is missing, the tools of the features must be given by name", found=None)
    tools = {}
    for name, content in as_mapping(document, "tools").items():
        path = join("tools", name)
        NAME.read(name, path, {})
        content = as_mapping(content, path)
        if "name" in content:
            raise DuplicateName(join(path, "name"), f"the name {name!r} is already given, leave it out")
        tools[name] = read_object(Tool, {"name": name, **content}, path, {})
    return tools


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
        feature = read_object(FEATURES[kind], content, path, {"tools": tools}, ignore=("kind",))
        if feature.id in seen:
            raise DuplicateName(
                join(path, "id"), f"found {feature.id!r}, which features.{seen[feature.id]} has already"
            )
        seen[feature.id] = index
        features.append(feature)
    return tuple(features)
