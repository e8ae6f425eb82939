"""Texts that an order may carry: printable ones, and what is answered to one that carries another."""

from __future__ import annotations

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
    """Answer 422 to what is no order, without what was sent: that may be nothing that can be answered."""
    found = error.errors() if isinstance(error, RequestValidationError) else []
    for one in found:
        if one["type"] == _NOT_PRINTABLE:
            return JSONResponse({"detail": one["msg"]}, 422)
    return JSONResponse({"detail": [{key: one[key] for key in ("type", "loc", "msg")} for one in found]}, 422)
