"""What the controller's web services answer, and the function of ours that reads it."""

from __future__ import annotations

import json
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx

from doormill_ros.abb.transports.rws_controller import RwsController
from doormill_ros.abb.transports.rws_dialect import RWS1, RWS2, Dialect
from doormill_ros.abb.transports.rws_events import RwsEvents
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
FRAME = "".join(
    f'<li class="ios-signalstate-ev"><a href="/rw/iosystem/signals/diRequest;state" rel="self"/>\n'
    f'<span class="lvalue">{level}</span></li>\n'
    for level in (1, 0, 1)
)


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


def _frame(path: Path) -> object:
    events = RwsEvents(None, RWS1, "diRequest", threading.Event())  # type: ignore[arg-type]  # connects to nothing
    events._take(path.read_text(encoding="utf-8", errors="replace"))
    return events.next_edge()


def controller_answers(folder: Path) -> Iterator[Subject]:
    """Answers of both versions, a refusal and a message of the event stream."""
    answers = {
        "rws1": (RWS1, {"_embedded": {"_state": STATES, "status": REFUSAL}}),
        "rws2": (RWS2, {"state": STATES, "status": REFUSAL}),
    }
    for name, (dialect, document) in answers.items():
        place = text_folder(folder / name, "answer.json", json.dumps(document))
        yield Subject(f"{name} answer", place, "answer.json", _reader(dialect), False)
    place = text_folder(folder / "frame", "frame.txt", FRAME)
    yield Subject("event frame", place, "frame.txt", _frame, False)
