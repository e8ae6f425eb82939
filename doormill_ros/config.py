"""The one way to read a configuration: a YAML file into a model, or one sentence about what is wrong in it.

A model is a frozen dataclass below `Section`, its fields annotated with what they allow; pydantic does the rest.
"""

from __future__ import annotations

import dataclasses
import functools
import math
import re
import reprlib
import types
import typing
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, ClassVar, TypeVar

import numpy as np
import yaml
from pydantic import ConfigDict, Field, GetCoreSchemaHandler, TypeAdapter, ValidationError
from pydantic_core import CoreSchema, ErrorDetails, PydanticCustomError, core_schema

from doormill_ros.arrays import FloatArray
from doormill_ros.errors import DoormillError

Model = TypeVar("Model")
Place = tuple[int | str, ...]  #: of a value in a document: keys and numbers of entries, outermost first

# YAML 1.1 takes 1e-5 and 2.4e6 for text: a number with an exponent needs a point and a sign there.
_EXPONENT = re.compile(r"[-+]?([0-9]+\.?[0-9]*|\.[0-9]+)[eE][-+]?[0-9]+")


class Section:
    """Base of the models: beside its fields a mapping holds nothing."""

    __pydantic_config__: ClassVar[ConfigDict] = ConfigDict(extra="forbid", arbitrary_types_allowed=True)


def refused(allowed: str) -> PydanticCustomError:
    """What a validator raises: the place and what was found there are added by whoever reads."""
    return PydanticCustomError("allowed", "{allowed}", {"allowed": allowed})


def contradiction(sentence: str) -> PydanticCustomError:
    """What a validator raises that knows the whole sentence, the place included."""
    return PydanticCustomError("sentence", "{sentence}", {"sentence": sentence})


@dataclasses.dataclass(frozen=True)
class Number:
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


Finite = Annotated[float, Number("a finite number")]
Positive = Annotated[float, Number("a positive number", 0.0, above=True)]
NotNegative = Annotated[float, Number("a number from 0 up", 0.0)]
Share = Annotated[float, Number("a number from 0 to 1", 0.0, 1.0)]
Count = Annotated[int, Number("a positive whole number", 1.0, whole=True)]


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
        """The array; raises what pydantic expects of a validator."""
        kind = Positive if self.positive else Finite
        (entry,) = (part for part in typing.get_args(kind) if isinstance(part, Number))
        numbers: list[float] = []
        if not self._gather(value, self.shape, entry, numbers):
            raise refused(self.what)
        array = np.array(numbers, dtype=np.float64).reshape(self.shape)
        array.setflags(write=False)
        return array

    def _gather(self, value: object, shape: tuple[int, ...], entry: Number, numbers: list[float]) -> bool:
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
Name = Annotated[str, Field(strict=True, min_length=1)]


class NotYaml(ValueError):
    """A text that is no YAML document.

    Attributes:
        where: Line and column, empty where the parser does not say; begins with a blank.
        problem: What the parser says, one line.
    """

    def __init__(self, problem: str, mark: yaml.Mark | None = None) -> None:
        self.where = f" line {mark.line + 1}, column {mark.column + 1}" if mark else ""
        self.problem = " ".join(problem.split())
        super().__init__(f"not YAML{self.where}: {self.problem}")


class DuplicateKey(NotYaml):
    """A key that a mapping has twice.

    Attributes:
        key: The key.
        line: Line of the second one, from 1.
    """

    def __init__(self, key: str, mark: yaml.Mark) -> None:
        super().__init__(f"the key {key!r} is given twice", mark)
        self.key = key
        self.line = mark.line + 1


class _Loader(yaml.SafeLoader):
    """Refuses a key that is given twice, and leaves times as text.

    The parser in Python, not the faster one in C: that one ends the process where lists are nested deeply.
    """


def _mapping(loader: _Loader, node: yaml.MappingNode) -> dict[Any, Any]:
    seen = set()
    for key, _ in node.value:
        if not isinstance(key, yaml.ScalarNode):
            raise yaml.constructor.ConstructorError(
                None, None, "a field name must be plain text", key.start_mark
            )
        if key.value in seen:
            raise DuplicateKey(str(key.value), key.start_mark)
        seen.add(key.value)
    return loader.construct_mapping(node, deep=True)


_Loader.add_constructor(yaml.resolver.BaseResolver.DEFAULT_MAPPING_TAG, _mapping)
_Loader.add_constructor("tag:yaml.org,2002:timestamp", lambda loader, node: node.value)


def parse(text: str) -> Any:
    """The plain value of a YAML text: dict, list, str, int, float, bool and None.

    Raises:
        NotYaml: It is none, or names Python objects.
        DuplicateKey: A mapping has a key twice.
    """
    try:
        return yaml.load(text, Loader=_Loader)
    except NotYaml:
        raise
    except yaml.MarkedYAMLError as error:
        raise NotYaml(str(error.problem), error.problem_mark) from error
    except RecursionError as error:
        raise NotYaml("nested too deeply") from error
    # A wrong value behind a tag, such as !!int x, ends in whatever Python says to it.
    except (yaml.YAMLError, ValueError, ArithmeticError, LookupError, TypeError, AttributeError) as error:
        raise NotYaml(str(error)) from error


def read_document(path: Path, error: type[DoormillError], form: str = "") -> Any:
    """The plain value of a YAML file, for whoever looks at it before choosing a model.

    Args:
        path: The file.
        error: Leaf that is raised.
        form: A file of the same form that ships, for the sentence's end.

    Raises:
        DoormillError: `error`; there is no such file, no text in it or no YAML.
    """
    try:
        text = path.read_text(encoding="utf-8-sig")
    except OSError as cause:
        reason = cause.strerror or str(cause)
        raise error(
            f"{path} cannot be read, {reason}; allowed is a YAML file, {_advice(form)}", path=str(path)
        ) from cause
    except ValueError as cause:  # not UTF-8, or a NUL in the path
        raise error(
            f"{path} cannot be read, {cause}; allowed is text in UTF-8, save it so", path=str(path)
        ) from cause
    try:
        return parse(text)
    except NotYaml as cause:
        raise error(
            f"{path}{cause.where} is not YAML, {cause.problem}; {_advice(form)}", path=str(path)
        ) from cause


def read(path: Path, model: type[Model], error: type[DoormillError], form: str = "") -> Model:
    """A YAML file as a model.

    Args:
        path: The file.
        model: A dataclass below `Section`.
        error: Leaf that is raised.
        form: A file of the same form that ships, for the sentence's end.

    Raises:
        DoormillError: `error`; the sentence names the file, the key, what was found and what is allowed.
    """
    return check(read_document(path, error, form), model, error, str(path), form)


def check(
    document: object, model: type[Model], error: type[DoormillError], name: str, form: str = ""
) -> Model:
    """A parsed document as a model.

    Args:
        document: What `parse` gives.
        model: A dataclass below `Section`.
        error: Leaf that is raised.
        name: Where the document comes from, for the sentence's beginning.
        form: A file of the same form that ships, for the sentence's end.

    Raises:
        DoormillError: `error`, as for `read`.
    """
    try:
        return typing.cast(Model, adapter(typing.cast(Any, model)).validate_python(document))
    except ValidationError as cause:
        details = first_error(cause)
        raise error(
            f"{name}: {_sentence(model, details)}; {_advice(form)}",
            path=name,
            key=".".join(map(str, details["loc"])),
        ) from cause


@functools.cache
def adapter(model: type[Model]) -> TypeAdapter[Model]:
    """Pydantic's validator of a model, built once."""
    return TypeAdapter(model)


def first_error(error: ValidationError) -> ErrorDetails:
    """What to say of several mistakes: the first, but before it an unknown key beside it or further out."""
    errors = error.errors(include_url=False)
    first = errors[0]
    for other in errors:
        place = other["loc"][:-1]
        if other["type"] == "unexpected_keyword_argument" and first["loc"][: len(place)] == place:
            return other
    return first


_SHORT = reprlib.Repr()
_SHORT.maxlevel, _SHORT.maxdict, _SHORT.maxlist = 3, 6, 6
_SHORT.maxstring, _SHORT.maxlong, _SHORT.maxother = 80, 40, 80


def found(value: object) -> str:
    """A value in a sentence, on one line and cut where it is long."""
    return _SHORT.repr(value)


_ALLOWED = {
    "dataclass_type": "a mapping",
    "dict_type": "a mapping",
    "list_type": "a list",
    "tuple_type": "a list",
    "string_type": "text",
    "string_too_short": "text that is not empty",
    "bool_type": "true or false",
    "invalid_key": "text as key",
}


def _sentence(model: type, details: ErrorDetails) -> str:
    kind, place, context = details["type"], details["loc"], details.get("ctx", {})
    key, value = ".".join(map(str, place)), found(details["input"])
    if kind == "sentence":
        return str(context["sentence"])
    if kind == "unexpected_keyword_argument":
        return f"{key} is unknown, allowed are {', '.join(keys_at(model, place[:-1]))}"
    if kind == "missing":
        what = _what(_kind_at(model, place))
        return f"{key} is missing{what and f', allowed {_verb(what)} {what}'}"
    if kind == "too_long":
        return f"{key} has {context['actual_length']} entries, allowed are {context['max_length']}"
    if kind == "too_short":
        return f"{key} has {context['actual_length']} entries, allowed are at least {context['min_length']}"
    allowed = str(context.get("allowed") or context.get("expected") or _ALLOWED.get(kind, details["msg"]))
    if not place:
        value = "nothing" if details["input"] is None else value
    return f"{key or 'it'} {'is' if place else 'holds'} {value}, allowed {_verb(allowed)} {allowed}"


def _verb(allowed: str) -> str:
    return "are" if allowed[0].isdigit() else "is"


def _advice(form: str) -> str:
    return f"compare it with {form}" if form else "correct the file"


def keys_at(model: type, place: Place) -> tuple[str, ...]:
    """Keys that the mapping at a place of a model may have; empty where it is not a section."""
    kind = _plain(_kind_at(model, place))
    return tuple(keys(kind)) if hasattr(kind, "__dataclass_fields__") else ()


def _kind_at(model: type, place: Place) -> Any:
    """Annotated type of what a place of a model may hold, None where it does not say."""
    kind: Any = model
    for step in place:
        kind = _inside(_plain(kind), step)
    return kind


def _what(kind: Any) -> str:
    """What a type allows in words, empty where only its validator can tell."""
    for part in getattr(kind, "__metadata__", ()):
        if hasattr(part, "what"):
            return str(part.what)
    kind = _plain(kind)
    return f"a mapping of {', '.join(keys(kind))}" if hasattr(kind, "__dataclass_fields__") else ""


@functools.cache
def keys(section: Any) -> dict[str, Any]:
    """Key in the document to annotated type of the attribute, in order, of a dataclass."""
    hints = typing.get_type_hints(section, include_extras=True)
    return {_key(f.name, hints[f.name]): hints[f.name] for f in dataclasses.fields(section)}


def _key(name: str, hint: Any) -> str:
    aliases = [getattr(part, "alias", None) for part in getattr(hint, "__metadata__", ())]
    return next((alias for alias in aliases if alias), name)


def _plain(kind: Any) -> Any:
    """The type without its annotations and without None."""
    if typing.get_origin(kind) is Annotated:
        return _plain(typing.get_args(kind)[0])
    if typing.get_origin(kind) in (typing.Union, types.UnionType):
        parts = [part for part in typing.get_args(kind) if part is not type(None)]
        return _plain(parts[0]) if len(parts) == 1 else kind
    return kind


def _inside(kind: Any, step: int | str) -> Any:
    """Type of one entry of a list or mapping, or of one field of a section."""
    if hasattr(kind, "__dataclass_fields__"):
        return keys(kind).get(str(step))
    arguments = typing.get_args(kind)
    if not arguments:
        return None
    origin = typing.get_origin(kind)
    if origin is tuple and isinstance(step, int) and Ellipsis not in arguments:
        return arguments[step] if step < len(arguments) else None
    return arguments[1] if isinstance(origin, type) and issubclass(origin, Mapping) else arguments[0]
