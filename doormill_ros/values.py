"""What the models of configurations are made of: sections without strange keys, numbers, arrays and names.

What a type allows stands in words in its `what`, for the sentence about a value that is wrong.
"""

from __future__ import annotations

import dataclasses
import math
import re
import types
import typing
from typing import Annotated, Any, ClassVar, Literal, NamedTuple

import numpy as np
from pydantic import ConfigDict, GetCoreSchemaHandler, StringConstraints
from pydantic_core import CoreSchema, PydanticCustomError, core_schema

from doormill_ros.arrays import FloatArray

# YAML 1.1 takes 1e-5 and 2.4e6 for text: a number with an exponent needs a point and a sign there.
_EXPONENT = re.compile(r"[-+]?([0-9]+\.?[0-9]*|\.[0-9]+)[eE][-+]?[0-9]+")


class Section:
    """Base of the models, frozen dataclasses: beside its fields a mapping holds nothing.

    `class Part(Section, extra="ignore")` passes by what else the mapping holds.
    """

    __pydantic_config__: ClassVar[ConfigDict]

    def __init_subclass__(cls, extra: Literal["forbid", "ignore"] = "forbid") -> None:
        """Let pydantic read the class; the names in the document are looked up once all fields are known."""
        cls.__pydantic_config__ = ConfigDict(
            extra=extra,
            arbitrary_types_allowed=True,
            alias_generator=lambda name: next(key for key, field in keys(cls).items() if field.name == name),
        )


class Field(NamedTuple):
    """A field of a section: the attribute and its annotated type."""

    name: str
    kind: Any


_keys: dict[type, dict[str, Field]] = {}


def keys(section: type) -> dict[str, Field]:
    """Key in the document to field, in order, of a dataclass.

    The key is the attribute's name, unless an annotation of the field has a method `key` that makes another of it.
    """
    if section not in _keys:
        kinds = typing.get_type_hints(section, include_extras=True)
        names = [item.name for item in dataclasses.fields(section)]
        _keys[section] = {_key(name, kinds[name]): Field(name, kinds[name]) for name in names}
    return _keys[section]


def _key(name: str, kind: Any) -> str:
    for part in getattr(kind, "__metadata__", ()):
        if hasattr(part, "key"):
            return str(part.key(name))
    return name


def plain(kind: Any) -> Any:
    """A type without its annotations and without None."""
    if typing.get_origin(kind) is Annotated:
        return plain(typing.get_args(kind)[0])
    if typing.get_origin(kind) in (typing.Union, types.UnionType):
        parts = [part for part in typing.get_args(kind) if part is not type(None)]
        return plain(parts[0]) if len(parts) == 1 else kind
    return kind


def refused(allowed: str) -> PydanticCustomError:
    """What a validator raises: the place and what was found there are added by whoever reads."""
    return PydanticCustomError("allowed", "{allowed}", {"allowed": allowed})


def contradiction(sentence: str) -> PydanticCustomError:
    """What a validator raises that knows the whole sentence, the place included."""
    return PydanticCustomError("sentence", "{sentence}", {"sentence": sentence})


@dataclasses.dataclass(frozen=True)
class FiniteNumber:
    """A finite number in a model; `low` and `high` are allowed themselves unless `above` is set."""

    what: str
    low: float = -math.inf
    high: float = math.inf
    above: bool = False
    whole: bool = False

    def check(self, value: object) -> float:
        """The number; raises what pydantic expects of a validator."""
        if isinstance(value, str) and _EXPONENT.fullmatch(value):
            value = float(value)
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise refused(self.what)
        try:
            number = float(value)
        except OverflowError:
            raise refused(self.what) from None
        low_enough = self.low < number if self.above else self.low <= number
        if not (math.isfinite(number) and low_enough and number <= self.high):
            raise refused(self.what)
        if self.whole and number != int(number):
            raise refused(self.what)
        return int(number) if self.whole else number

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(self.check)


Finite = Annotated[float, FiniteNumber("a finite number")]
Positive = Annotated[float, FiniteNumber("a positive number", 0.0, above=True)]
NotNegative = Annotated[float, FiniteNumber("a number from 0 up", 0.0)]
Count = Annotated[int, FiniteNumber("a positive whole number", 1.0, whole=True)]


@dataclasses.dataclass(frozen=True)
class Array:
    """Nested lists of finite numbers of one shape in a model, a read-only float array in Python."""

    shape: tuple[int, ...]
    positive: bool = False

    @property
    def what(self) -> str:
        """What is allowed, in words."""
        size = " x ".join(str(extent) for extent in self.shape)
        return f"{size} finite numbers{', all positive' if self.positive else ''}"

    def check(self, value: object) -> FloatArray:
        """The array of the declared shape, read-only; raises what pydantic expects of a validator."""
        kind = Positive if self.positive else Finite
        (entry,) = (part for part in typing.get_args(kind) if isinstance(part, FiniteNumber))
        numbers: list[float] = []
        if isinstance(value, np.ndarray):  # from Python, where a document has lists
            value = value.tolist()
        if not self._gather(value, self.shape, entry, numbers):
            raise refused(self.what)
        array = np.array(numbers, dtype=np.float64).reshape(self.shape)
        array.setflags(write=False)
        return array

    def _gather(
        self, value: object, shape: tuple[int, ...], entry: FiniteNumber, numbers: list[float]
    ) -> bool:
        if not shape:
            try:
                numbers.append(entry.check(value))
            except PydanticCustomError:
                return False
            return True
        if not isinstance(value, list | tuple) or len(value) != shape[0]:
            return False
        return all(self._gather(part, shape[1:], entry, numbers) for part in value)

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(self.check)


@dataclasses.dataclass(frozen=True)
class Exactly:
    """One text in a model, such as the name of the file's form."""

    what: str

    def check(self, value: object) -> str:
        """The text; raises what pydantic expects of a validator."""
        if value != self.what:
            raise refused(self.what)
        return self.what

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(self.check)


Vector3 = Annotated[FloatArray, Array((3,))]
Name = Annotated[str, StringConstraints(strict=True, min_length=1)]
