"""The one way to read a configuration: a YAML file into a model, or one sentence about what is wrong in it.

A model is a frozen dataclass below `values.Section`, its fields annotated with what they allow; pydantic reads it.
"""

from __future__ import annotations

import functools
import reprlib
import typing
from collections.abc import Mapping
from pathlib import Path
from typing import Any, TypeVar

from pydantic import TypeAdapter, ValidationError
from pydantic_core import ErrorDetails

from doormill_ros.errors import DoormillError
from doormill_ros.files import read_utf8
from doormill_ros.values import keys, plain
from doormill_ros.yaml_text import NotYaml, parse

Model = TypeVar("Model")
Place = tuple[int | str, ...]  #: of a value in a document: keys and numbers of entries, outermost first


def read_document(path: Path, error: type[DoormillError], advice: str = "correct the file") -> Any:
    """The plain value of a YAML file, for whoever looks at it before choosing a model.

    Args:
        path: The file.
        error: Leaf that is raised.
        advice: What to do, the sentence's end.

    Raises:
        DoormillError: `error`; there is no such file, no text in it or no YAML.
    """
    return _parsed(_text(path, error, advice), path, error, advice)


def _text(path: Path, error: type[DoormillError], advice: str) -> str:
    try:
        return read_utf8(path)
    except OSError as cause:
        reason = cause.strerror or str(cause)
        raise error(
            f"{path} cannot be read, {reason}; allowed is a YAML file, {advice}", path=str(path)
        ) from cause
    except ValueError as cause:  # not UTF-8, with line and column, or a NUL in the path
        raise error(
            f"{path} cannot be read, {cause}; allowed is text in UTF-8, save it so", path=str(path)
        ) from cause


def _parsed(text: str, path: Path, error: type[DoormillError], advice: str) -> Any:
    try:
        return parse(text)
    except NotYaml as cause:
        raise error(
            f"{path} cannot be read, not YAML{cause.where}: {cause.problem}; {advice}", path=str(path)
        ) from cause


def read(
    path: Path, model: type[Model], error: type[DoormillError], advice: str = "correct the file"
) -> Model:
    """A YAML file as a model; the same one as long as the text stays, so what was made of it can be kept.

    Args:
        path: The file.
        model: A dataclass below `Section`.
        error: Leaf that is raised.
        advice: What to do, the sentence's end.

    Raises:
        DoormillError: `error`; the sentence names the file, the key, what was found and what is allowed.
    """
    kept: Model = _kept(_text(path, error, advice), path, model, error, advice)
    return kept


def _model(text: str, path: Path, model: type[Model], error: type[DoormillError], advice: str) -> Model:
    return check(_parsed(text, path, error, advice), model, error, str(path), advice)


_kept: Any = functools.lru_cache(maxsize=64)(_model)


def check(
    document: object,
    model: type[Model],
    error: type[DoormillError],
    name: str,
    advice: str = "correct the file",
) -> Model:
    """A parsed document as a model.

    Args:
        document: What `parse` gives.
        model: A dataclass below `Section`.
        error: Leaf that is raised.
        name: Where the document comes from, for the sentence's beginning.
        advice: What to do, the sentence's end.

    Raises:
        DoormillError: `error`, as for `read`.
    """
    try:
        return adapter(model).validate_python(document)
    except ValidationError as cause:
        details = first_error(cause)
        raise error(
            f"{name}: {_sentence(model, details)}; {advice}",
            path=name,
            key=".".join(map(str, details["loc"])),
        ) from cause


_adapters: dict[type, TypeAdapter[Any]] = {}


def adapter(model: type[Model]) -> TypeAdapter[Model]:
    """The validator of a model that pydantic makes, built once."""
    if model not in _adapters:
        _adapters[model] = TypeAdapter(model)
    return _adapters[model]


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


def keys_at(model: type, place: Place) -> tuple[str, ...]:
    """Keys that the mapping at a place of a model may have; empty where it is not a section."""
    kind = plain(_kind_at(model, place))
    return tuple(keys(kind)) if hasattr(kind, "__dataclass_fields__") else ()


def _kind_at(model: type, place: Place) -> Any:
    """Annotated type of what a place of a model may hold, None where it does not say."""
    kind: Any = model
    for step in place:
        kind = _inside(plain(kind), step)
    return kind


def _what(kind: Any) -> str:
    """What a type allows in words, empty where only its validator can tell."""
    for part in getattr(kind, "__metadata__", ()):
        if hasattr(part, "what"):
            return str(part.what)
    kind = plain(kind)
    return f"a mapping of {', '.join(keys(kind))}" if hasattr(kind, "__dataclass_fields__") else ""


def _inside(kind: Any, step: int | str) -> Any:
    """Type of one entry of a list or mapping, or of one field of a section."""
    if hasattr(kind, "__dataclass_fields__"):
        field = keys(kind).get(str(step))
        return field.kind if field else None
    arguments = typing.get_args(kind)
    if not arguments:
        return None
    origin = typing.get_origin(kind)
    if origin is tuple and isinstance(step, int) and Ellipsis not in arguments:
        return arguments[step] if step < len(arguments) else None
    return arguments[1] if isinstance(origin, type) and issubclass(origin, Mapping) else arguments[0]
