"""Answers of the web services as data, and their two spellings: XHTML and JSON."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from xml.sax.saxutils import escape, quoteattr

#: Return codes that the public documentation and bug reports name.
CODE_ACCESS_REJECTED = -1073414145
CODE_NO_MASTERSHIP = -1073414146
#: The documentation gives no number for these; a client must go by the HTTP status.
CODE_NOT_FOUND = -1073445879
CODE_BAD_REQUEST = -1073445880


@dataclass(frozen=True)
class Item:
    """One `li` of an answer.

    Attributes:
        kind: Its class, for example "ios-signal-li".
        title: Its title.
        href: Link to itself, "" for none.
        values: Its spans by class.
    """

    kind: str
    title: str
    href: str = ""
    values: dict[str, str] = field(default_factory=dict)


class RefusalError(Exception):
    """An operation the controller refuses, with HTTP status and controller return code."""

    def __init__(self, status: int, code: int, message: str) -> None:
        super().__init__(message)
        self.status = status
        self.code = code
        self.message = message


def xhtml(base: str, items: list[Item], links: list[tuple[str, str]] | None = None) -> bytes:
    """The answer as the XHTML both versions speak.

    Args:
        base: Absolute address that links are relative to.
        items: The list.
        links: Pairs of address and relation, before the list.
    """
    anchors = "".join(f"<a href={quoteattr(href)} rel={quoteattr(rel)}></a>" for href, rel in links or [])
    rows = "".join(_row(item) for item in items)
    return (
        '<?xml version="1.0" encoding="utf-8"?><html xmlns="http://www.w3.org/1999/xhtml">'
        f"<head><title>rws</title><base href={quoteattr(base)}/></head>"
        f'<body><div class="state">{anchors}<ul>{rows}</ul></div></body></html>'
    ).encode()


def xhtml_error(base: str, error: RefusalError) -> bytes:
    """A refusal as XHTML."""
    return (
        '<?xml version="1.0" encoding="utf-8"?><html xmlns="http://www.w3.org/1999/xhtml">'
        f"<head><title>error</title><base href={quoteattr(base)}/></head>"
        f'<body><div class="status"><span class="code">{error.code}</span>'
        f'<span class="msg">{escape(error.message)}</span></div></body></html>'
    ).encode()


def json_body(base: str, items: list[Item], version: int) -> bytes:
    """The answer as JSON: below `_embedded._state` in 1.0, below `state` in 2.0."""
    state = [{"_type": item.kind, "_title": item.title, **item.values} for item in items]
    links = {"base": {"href": base}}
    body = (
        {"_links": links, "_embedded": {"_state": state}}
        if version == 1
        else {"_links": links, "state": state}
    )
    return json.dumps(body).encode()


def json_error(base: str, error: RefusalError, version: int) -> bytes:
    """A refusal as JSON."""
    status = {"code": error.code, "msg": error.message}
    links = {"base": {"href": base}}
    body = (
        {"_links": links, "_embedded": {"status": status}}
        if version == 1
        else {"_links": links, "status": status}
    )
    return json.dumps(body).encode()


def _row(item: Item) -> str:
    link = f'<a href={quoteattr(item.href)} rel="self"/>' if item.href else ""
    spans = "".join(f'<span class="{name}">{escape(value)}</span>' for name, value in item.values.items())
    return f'<li class="{item.kind}" title={quoteattr(item.title)}>{link}{spans}</li>'
