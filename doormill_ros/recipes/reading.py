"""Read and write the parts of a recipe document with pydantic, each mistake as the error that names its field."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, TypeVar

from pydantic import ValidationError
from pydantic_core import ErrorDetails, PydanticCustomError

from doormill_ros.config import adapter, keys_at
from doormill_ros.errors import one_line
from doormill_ros.recipes.errors import FieldError, MissingField, UnknownField, WrongType

T = TypeVar("T")


def join(path: str, *names: str | int) -> str:
    """Dotted path of a part of `path`."""
    return ".".join([path, *map(str, names)] if path else map(str, names))


def located(error: FieldError, place: str) -> FieldError:
    """The same error with the place in the file in front of its message."""
    error.message = one_line(f"{place}: {error.message}")
    error.args = (error.message,)
    return error


def as_mapping(document: Any, path: str) -> Mapping[str, Any]:
    """The document when it is a mapping with text keys; raises WrongType."""
    mistake = no_mapping(document)
    if mistake is not None:
        raise WrongType(path, mistake[0], found=mistake[1])
    fields: Mapping[str, Any] = document
    return fields


def no_mapping(document: Any) -> tuple[str, Any] | None:
    """Why a document is no mapping with text keys, and what was found instead; None when it is one."""
    if not isinstance(document, Mapping):
        return f"found {document!r:.80}, allowed are fields with names", document
    for key in document:
        if not isinstance(key, str):
            return f"found the field name {key!r}, allowed is text", key
    return None


def read_part(
    model: type[T],
    document: Mapping[str, Any],
    path: str,
    context: Mapping[str, Any] | None = None,
    beside: tuple[str, ...] = (),
) -> T:
    """Build a section of a recipe from its document.

    Args:
        model: Dataclass below `values.Section`.
        document: Mapping of field names to values.
        path: Dotted path of the document, for messages.
        context: Named objects that references resolve to.
        beside: Keys of the document that somebody else reads.

    Raises:
        FieldError: A field is unknown, missing or wrong.
    """
    content = dict(document)
    for key in beside:
        content.pop(key, None)
    try:
        return adapter(model).validate_python(content, context=context)
    except ValidationError as error:
        raise _leaf(model, _first(error.errors(include_url=False)), path, beside) from None


def read_value(read: Callable[[Any], T], value: Any, path: str) -> T:
    """What a reader of one value makes of it; raises the FieldError that it complains with."""
    try:
        return read(value)
    except PydanticCustomError as error:
        raise _said(error.context or {}, path) from None


def write_part(part: object, without: str = "") -> dict[str, Any]:
    """The document of a section; attributes that are None are left out, and the one named."""
    writer = adapter(type(part))
    written: dict[str, Any] = writer.dump_python(part, by_alias=True, exclude_none=True, exclude={without})
    return written


def _said(context: Mapping[str, Any], path: str) -> FieldError:
    leaf: type[FieldError] = context["leaf"]
    return leaf(join(path, *context["inside"]), context["text"], **context["data"])


def _first(errors: list[ErrorDetails]) -> ErrorDetails:
    """The first mistake; a strange key in the mappings round it comes before, the outermost first of all."""
    first = errors[0]
    for depth in range(len(first["loc"])):
        here = [e for e in errors if len(e["loc"]) == depth + 1 and e["loc"][:depth] == first["loc"][:depth]]
        for kind in ("invalid_key", "unexpected_keyword_argument"):
            strange = [e for e in here if e["type"] == kind]
            if strange:
                return strange[0]
    return first


def _leaf(model: type, error: ErrorDetails, path: str, beside: tuple[str, ...]) -> FieldError:
    place, kind, found = error["loc"], error["type"], error["input"]
    if kind == "invalid_key":
        return WrongType(
            join(path, *place[:-1]), f"found the field name {place[-1]!r}, allowed is text", found=place[-1]
        )
    where = join(path, *place)
    if kind == "unexpected_keyword_argument":
        known = dict.fromkeys((*(beside if len(place) == 1 else ()), *keys_at(model, place[:-1])))
        return UnknownField(where, f"is not a field, allowed are {', '.join(known)}", found=place[-1])
    context = error.get("ctx", {})
    inside = context.get("inside", ())
    if kind == "missing" or (found is None and not inside and place[-1] in keys_at(model, place[:-1])):
        return MissingField(where, "is missing, a value must be given", found=None)
    if kind == "leaf":
        return _said(context, where)
    if kind == "bool_type":
        return WrongType(where, f"found {found!r}, allowed is true or false", found=found)
    return WrongType(where, f"found {found!r:.80}, allowed are fields with names", found=found)
