"""Answers of the web services as data, and their two spellings: XHTML and JSON."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from xml.sax.saxutils import escape, quoteattr

# Return codes as controllers with RobotWare 6.16 and 7.21 sent them; source: the captured answers in
# github.com/ichbinmeraj/abb-rws-client, tests/fixtures/errors.
CODE_REJECTED = -1073445881  #: a write that access level or operating mode forbids
CODE_HELD = -1073445862  #: somebody else holds mastership
CODE_NO_MASTERSHIP = -1073445859  #: mastership is needed
CODE_UNKNOWN_SIGNAL = -1073445866
CODE_INVALID = -1073445879  #: a value that is not allowed; also "the queue is there already"
CODE_WRONG_STATE = -1073442809  #: not in this state of execution
CODE_NO_RESOURCE = -1073414146  #: 1.0: file, module, symbol; 2.0 has a code for each
CODE_NO_FILE = -1073438713  #: 2.0
CODE_NO_VOLUME = -1073438716  #: 2.0
CODE_NO_SYMBOL = -1073442816  #: 2.0
CODE_NO_MODULE = -1073442813  #: 2.0
CODE_NO_STATION = (
    -1073435871
)  #: RobotWare 8, from 8.1.1 in the same place: the session has no control station
CODE_NO_WRITE_ACCESS = -1073435873  #: its station may not write
CODE_WRITE_ACCESS_TAKEN = -1073435870  #: another station holds the write access


@dataclass(frozen=True)
class Item:
    """One `li` of an answer.

    Attributes:
        kind: Its class, for example "ios-signal-li".
        title: Its title.
        href: Link to itself, "" for none.
        values: Its spans by class.
        arguments: Numbered spans "arg1", "arg2"; in JSON the list "argv".
    """

    kind: str
    title: str
    href: str = ""
    values: dict[str, str] = field(default_factory=dict)
    arguments: tuple[str, ...] = ()


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
    state = [_object(item) for item in items]
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


def _object(item: Item) -> dict[str, object]:
    found: dict[str, object] = {"_type": item.kind, "_title": item.title, **item.values}
    if item.arguments:
        found["argv"] = [{"type": "string", "value": text} for text in item.arguments]
    return found


def _row(item: Item) -> str:
    link = f'<a href={quoteattr(item.href)} rel="self"/>' if item.href else ""
    values = {**item.values, **{f"arg{number}": text for number, text in enumerate(item.arguments, 1)}}
    spans = "".join(f'<span class="{name}">{escape(value)}</span>' for name, value in values.items())
    return f'<li class="{item.kind}" title={quoteattr(item.title)}>{link}{spans}</li>'
