"""What the controller's web services answer, and the function of ours that reads it."""

from __future__ import annotations

import json
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import httpx

from doormill_ros.abb.link_errors import SubscriptionError
from doormill_ros.abb.transports.rws_controller import RwsController
from doormill_ros.abb.transports.rws_dialect import RWS1, RWS2, Dialect
from doormill_ros.abb.transports.rws_events import RwsEvents
from support.hostile.frames import CLOSE, EVENT, frame, heard
from support.hostile.subject import Subject, text_folder

STATES: list[dict[str, Any]] = [
    {"_title": "/rw/elog/0/17", "msgtype": "1", "code": "10011", "title": "Motors ON", "desc": "by a key"},
    {
        "opmode": "AUTO",
        "speedratio": "100",
        "ctrlstate": "motoron",
        "ctrlexecstate": "running",
        "lvalue": "1",
    },
]
REFUSAL = {
    "code": -1073442809,
    "msg": "Operation rejected by the controller safety access restriction mechanism.",
}
_SIGNALS = "/rw/iosystem/signals/"


class _Answers:
    """Stands for the session: whatever is asked for, the file's bytes are the answer."""

    def __init__(self, content: bytes) -> None:
        self._content = content

    def request(self, *_: object, **__: object) -> httpx.Response:
        return httpx.Response(200, content=self._content)


def _reader(dialect: Dialect) -> Any:
    def read(path: Path) -> object:
        content = path.read_bytes()
        dialect.error_code(content)
        controller = RwsController(_Answers(content), dialect)  # type: ignore[arg-type]  # all that is asked of it
        return controller.events(), controller.events(), controller.read()

    return read


def _event(path: Path) -> object:
    events = RwsEvents(None, RWS1, "diRequest", threading.Event())  # type: ignore[arg-type]  # connects to nothing
    text = path.read_text(encoding="utf-8", errors="replace")
    events._take(text)
    edges = list(iter(events.next_edge, None))
    told = _told(text)
    if told is not None and edges != told:
        raise AssertionError(f"edges {edges} of a message that tells {told}")
    return edges


def _told(text: str) -> list[bool] | None:
    """The edges that a parser of XML finds in a message; None where it is not well formed."""
    try:
        root = ElementTree.fromstring(f"<x>{text}</x>")
    except (ElementTree.ParseError, ValueError):
        return None
    edges = []
    for item in root:
        spans = [span.text or "" for span in item.findall("span") if span.get("class") == "lvalue"]
        paths = [str(a.get("href")) for a in item.findall("a") if str(a.get("href")).startswith(_SIGNALS)]
        signals = [
            path.removeprefix(_SIGNALS).removesuffix(";state") for path in paths if path.endswith(";state")
        ]
        if (
            signals
            and spans
            and signals[0].rsplit("/", 1)[-1] == "diRequest"
            and spans[0].strip() in ("0", "1")
        ):
            edges.append(spans[0].strip() == "1")
    return edges[-100:]


def _stream(path: Path) -> object:
    """Edges of a stream of frames; refused is one that ends with a warning."""
    edges, warnings = heard([path.read_bytes()])
    if warnings:
        raise SubscriptionError(" ".join(warnings))
    return edges


def controller_answers(folder: Path) -> Iterator[Subject]:
    """Answers of both versions, a refusal, a message of the event stream and a stream of frames."""
    answers = {
        "rws1": (RWS1, {"_embedded": {"_state": STATES, "status": REFUSAL}}),
        "rws2": (RWS2, {"state": STATES, "status": REFUSAL}),
    }
    for name, (dialect, document) in answers.items():
        place = text_folder(folder / name, "answer.json", json.dumps(document))
        yield Subject(f"{name} answer", place, "answer.json", _reader(dialect), False)
    place = text_folder(folder / "event", "event.txt", EVENT)
    yield Subject("event", place, "event.txt", _event, False)
    middle, event = len(EVENT) // 2, EVENT.encode()
    stream = frame(event) + frame(event[:middle], final=False) + frame(event[middle:], opcode=0)
    place = text_folder(folder / "frames", "frames.bin", stream + frame(b"", opcode=CLOSE))
    yield Subject("event stream's frames", place, "frames.bin", _stream, False)
