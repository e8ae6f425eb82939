"""Declare the fields of a recipe document once; reading, checking and writing follow from it.

A dataclass field carries a codec in its metadata. The codec knows the field's name in the
document (with its unit: `width` [m] is `width_mm` there), its limits, and both conversions.
Numbers live on a grid of 1e-6 document units (1 nm for lengths), so that a value survives
any number of trips through every exchange format bit by bit.
"""

from __future__ import annotations

import dataclasses
import functools
import math
import re
from collections.abc import Mapping
from enum import Enum
from typing import Any, TypeVar

from doormill_ros.recipes.errors import (
    BadText,
    MissingField,
    NotAChoice,
    NotFinite,
    OutOfRange,
    UnknownField,
    WrongType,
)
from doormill_ros.units import DEG, MM, RPM

GRID_DECIMALS = 6
SCALES = {"mm": MM, "deg": DEG, "rpm": RPM, "mm_s": MM, "m_min": 1.0 / 60.0, "kg": 1.0, "n_nm": 1.0}
T = TypeVar("T")


def join(path: str, name: str | int) -> str:
    """Dotted path of a part of `path`."""
    return f"{path}.{name}" if path else str(name)


def number(value: Any, path: str, what: str = "a number") -> float:
    """A finite number on the grid, or the error that says why not."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise WrongType(path, f"found {value!r}, allowed is {what}", found=value)
    if not math.isfinite(value):
        raise NotFinite(path, f"found {value}, allowed is {what} that is finite", found=value)
    return round(float(value), GRID_DECIMALS) + 0.0


@dataclasses.dataclass(frozen=True)
class Codec:
    """How one field is read from and written to a document; the base takes any text."""

    def key(self, name: str) -> str:
        """Name of the field in the document."""
        return name

    def read(self, value: Any, path: str, context: Mapping[str, Any]) -> Any:
        """The checked value in SI; raises a FieldError that names `path`."""
        raise NotImplementedError

    def load(self, value: Any, context: Mapping[str, Any]) -> Any:
        """The value in SI of what `write` gave of a checked one: converted, not checked again."""
        return value

    def write(self, value: Any) -> Any:
        """The document's value, made of dict, list, str, int and float."""
        return value


@dataclasses.dataclass(frozen=True)
class Quantity(Codec):
    """A number with a unit between two limits, both in the document's unit."""

    unit: str
    low: float
    high: float

    def key(self, name: str) -> str:
        """The name with the unit behind it."""
        return f"{name}_{self.unit}"

    def read(self, value: Any, path: str, context: Mapping[str, Any]) -> float:
        """See the base class."""
        found = number(value, path)
        if not self.low <= found <= self.high:
            unit = self.unit.replace("_", "/")
            raise OutOfRange(
                path,
                f"found {found:g} {unit}, allowed are {self.low:g} to {self.high:g} {unit}",
                found=found,
                low=self.low,
                high=self.high,
            )
        return found * SCALES[self.unit]

    def load(self, value: float, context: Mapping[str, Any]) -> float:
        """See the base class."""
        return value * SCALES[self.unit]

    def write(self, value: float) -> float:
        """See the base class."""
        return round(value / SCALES[self.unit], GRID_DECIMALS) + 0.0


@dataclasses.dataclass(frozen=True)
class Whole(Codec):
    """A whole number between two limits."""

    low: int
    high: int

    def read(self, value: Any, path: str, context: Mapping[str, Any]) -> int:
        """See the base class."""
        found = number(value, path, "a whole number")
        if found != int(found):
            raise WrongType(path, f"found {value!r}, allowed is a whole number", found=value)
        if not self.low <= found <= self.high:
            raise OutOfRange(
                path, f"found {value}, allowed are {self.low} to {self.high}", found=value, low=self.low
            )
        return int(found)


@dataclasses.dataclass(frozen=True)
class Text(Codec):
    """A text that matches a pattern from end to end."""

    pattern: str
    what: str

    def read(self, value: Any, path: str, context: Mapping[str, Any]) -> str:
        """See the base class."""
        if not isinstance(value, str):
            raise WrongType(path, f"found {value!r}, allowed is text: {self.what}", found=value)
        if not re.fullmatch(self.pattern, value):
            raise BadText(path, f"found {value!r}, allowed is {self.what}", found=value)
        return value


NAME = Text(r"[A-Za-z0-9][A-Za-z0-9_.\-]{0,63}", "1 to 64 letters, digits, '_', '-' or '.', no '.' first")


@dataclasses.dataclass(frozen=True)
class Choice(Codec):
    """One member of an enumeration of words or numbers."""

    members: type[Enum]

    def read(self, value: Any, path: str, context: Mapping[str, Any]) -> Enum:
        """See the base class."""
        allowed = [member.value for member in self.members]
        if isinstance(value, bool) or not isinstance(value, type(allowed[0])):
            raise WrongType(path, f"found {value!r}, allowed is one of {allowed}", found=value)
        if value not in allowed:
            raise NotAChoice(path, f"found {value!r}, allowed is one of {allowed}", found=value)
        return self.members(value)

    def load(self, value: Any, context: Mapping[str, Any]) -> Enum:
        """See the base class."""
        return self.members(value)

    def write(self, value: Enum) -> Any:
        """See the base class."""
        return value.value


@dataclasses.dataclass(frozen=True)
class Flag(Codec):
    """True or false."""

    def read(self, value: Any, path: str, context: Mapping[str, Any]) -> bool:
        """See the base class."""
        if not isinstance(value, bool):
            raise WrongType(path, f"found {value!r}, allowed is true or false", found=value)
        return value


@dataclasses.dataclass(frozen=True)
class Nested(Codec):
    """A document inside the document, read by a dataclass with codecs of its own."""

    content: type

    def read(self, value: Any, path: str, context: Mapping[str, Any]) -> Any:
        """See the base class."""
        return read_object(self.content, value, path, context)

    def load(self, value: Any, context: Mapping[str, Any]) -> Any:
        """See the base class."""
        return load_object(self.content, value, context)

    def write(self, value: Any) -> dict[str, Any]:
        """See the base class."""
        return write_object(value)


def entry(codec: Codec, **arguments: Any) -> Any:
    """A dataclass field with its codec; keyword arguments go to `dataclasses.field`."""
    return dataclasses.field(metadata={"codec": codec}, **arguments)


@functools.cache
def codecs(content: type) -> dict[str, tuple[str, Codec, bool]]:
    """Document key to (attribute, codec, required) of a dataclass."""
    found = {}
    for item in dataclasses.fields(content):
        codec = item.metadata.get("codec")
        if codec is not None:
            required = item.default is dataclasses.MISSING and item.default_factory is dataclasses.MISSING
            found[codec.key(item.name)] = (item.name, codec, required)
    return found


def as_mapping(document: Any, path: str) -> Mapping[str, Any]:
    """The document when it is a mapping with text keys; raises WrongType."""
    if not isinstance(document, Mapping):
        raise WrongType(path, f"found {document!r:.80}, allowed are fields with names", found=document)
    for key in document:
        if not isinstance(key, str):
            raise WrongType(path, f"found the field name {key!r}, allowed is text", found=key)
    return document


def read_object(
    content: type[T], document: Any, path: str, context: Mapping[str, Any], ignore: tuple[str, ...] = ()
) -> T:
    """Build a dataclass with codecs from its document.

    Args:
        content: Dataclass whose fields were made with `entry`.
        document: Mapping of field names to values.
        path: Dotted path of the document, for messages.
        context: Named objects that references resolve to.
        ignore: Keys that somebody else reads.

    Raises:
        FieldError: A field is unknown, missing or wrong.
    """
    document = as_mapping(document, path)
    known = codecs(content)
    for key in document:
        if key not in known and key not in ignore:
            allowed = ", ".join([*ignore, *known])
            raise UnknownField(join(path, key), f"is not a field, allowed are {allowed}", found=key)
    values = {}
    for key, (name, codec, required) in known.items():
        if document.get(key) is not None:
            values[name] = codec.read(document[key], join(path, key), context)
        elif required or (key in document and not accepts_none(content, name)):
            raise MissingField(join(path, key), "is missing, a value must be given", found=None)
    check = getattr(content, "check_fields", None)
    if check is not None:
        check(values, path)
    return content(**values)


def load_object(content: type[T], document: Mapping[str, Any], context: Mapping[str, Any]) -> T:
    """Build a dataclass from what `write_object` gave of a checked one; nothing is checked again.

    Args:
        content: Dataclass whose fields were made with `entry`.
        document: Mapping of field names to values.
        context: Named objects that references resolve to.
    """
    known = codecs(content)
    values = {}
    for key, value in document.items():
        if key in known:
            name, codec, _ = known[key]
            values[name] = codec.load(value, context)
    return content(**values)


def accepts_none(content: type, name: str) -> bool:
    """True when None is the default of the attribute."""
    return any(item.name == name and item.default is None for item in dataclasses.fields(content))


def write_object(value: Any) -> dict[str, Any]:
    """The document of a dataclass with codecs; attributes that are None are left out."""
    document = {}
    for key, (name, codec, _) in codecs(type(value)).items():
        attribute = getattr(value, name)
        if attribute is not None:
            document[key] = codec.write(attribute)
    return document
