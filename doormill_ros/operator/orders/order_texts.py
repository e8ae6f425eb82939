"""Texts that an order may carry: printable ones, and what is answered to one that carries another."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Any

from fastapi import Request
from fastapi.exceptions import RequestValidationError
from fastapi.responses import JSONResponse
from pydantic import BeforeValidator
from pydantic_core import PydanticCustomError

_NOT_PRINTABLE = "not_printable"
_SHOWN = 60  # characters


def _printable(value: Any) -> Any:
    """The value, where it is no text with a character that cannot be printed."""
    if isinstance(value, str) and not value.isprintable():
        # ROS cuts a text at its first NUL, and half a surrogate pair can be sent to nobody.
        sentence = (
            f"the text {value[:_SHOWN]!a} has a character that cannot be printed; "
            "type it again with letters, digits, signs and blanks alone"
        )
        raise PydanticCustomError(_NOT_PRINTABLE, "{sentence}", {"sentence": sentence})
    return value


#: A text without control characters, line breaks, marks of direction and halves of surrogate pairs.
Printable = Annotated[str, BeforeValidator(_printable)]


async def no_order(request: Request, error: Exception) -> JSONResponse:
    """Answer 422 to what is no order, without what was sent: that may be nothing that can be answered.

    `detail` is one sentence; `fields` names the fields it is about, unless it says all by itself.
    """
    found = error.errors() if isinstance(error, RequestValidationError) else []
    for one in found:
        if one["type"] == _NOT_PRINTABLE:
            return JSONResponse({"detail": one["msg"]}, 422)
    wrong = {_field(one["loc"]): one["msg"] for one in found}
    each = "; ".join(f"{field}: {words[:1].lower()}{words[1:]}" for field, words in wrong.items())
    return JSONResponse(
        {
            "detail": f"what was sent cannot be used ({each}); put it right and send it again",
            "fields": [*wrong],
        },
        422,
    )


def _field(where: Sequence[str | int]) -> str:
    """The name of a field; the part of the request where there is none (no body, no JSON)."""
    named = [part for part in where[1:] if isinstance(part, str) and part.isprintable()]
    return ".".join(named)[:_SHOWN] or f"the {where[0]}"
