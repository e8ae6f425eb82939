"""What the page's server gives, and to whom."""

from __future__ import annotations

import json
import re
import socket
from functools import partial
from typing import Any

import cv2
import httpx
import numpy as np
import pytest

from doormill_ros.operator.access.token import authorizes, new_token
from doormill_ros.operator.errors import PageAddressError
from doormill_ros.operator.serving.page_server import PageServer
from doormill_ros.operator.serving.server import create_app
from doormill_ros.operator.views.view_store import ViewStore
from doormill_ros.pages.picture import LONGEST_SIDE, encode_picture
from support.source_tree import PACKAGE
from support.waiting import LIMIT

PAGE = PACKAGE / "operator" / "browser"
get, post = partial(httpx.get, timeout=LIMIT), partial(httpx.post, timeout=LIMIT)
ORDERS = [("/control/mill", {"door_id": "oak"}), ("/control/cancel", {})]


def bearer(token: str) -> dict[str, str]:
    return {"Authorization": f"Bearer {token}"}


@pytest.mark.parametrize("path", ["/", "/page.js", "/page.css", "/icon.svg", "/state"])
def test_every_answer_forbids_foreign_content(either: Any, path: str) -> None:
    answer = get(either.url + path[1:])
    assert answer.status_code == 200
    policy = dict(rule.strip().split(" ", 1) for rule in answer.headers["content-security-policy"].split(";"))
    assert policy["default-src"] == "'none'"
    assert policy["script-src"] == "'self'"
    assert policy["frame-ancestors"] == "'none'"
    assert answer.headers["x-content-type-options"] == "nosniff"


_FULL = {
    "x-content-type-options": "nosniff",
    "x-frame-options": "DENY",
    "referrer-policy": "no-referrer",
    "cache-control": "no-store",
    "cross-origin-opener-policy": "same-origin",
    "cross-origin-resource-policy": "same-origin",
}


@pytest.mark.parametrize(
    ("status", "path", "body", "headers"),
    [
        (202, "control/mill", {"door_id": "oak"}, {}),
        (400, "control/mill", {"door_id": "oak"}, {"Host": "a.example"}),
        (401, "control/mill", {"door_id": "oak"}, {"Authorization": ""}),
        (403, "control/mill", {"door_id": "oak"}, {"Origin": "null"}),
        (404, "nothing", {}, {}),
        (405, "state", {}, {}),
        (409, "control/mill", {"door_id": "busy"}, {}),
        (422, "control/mill", {}, {}),
        (500, "control/mill", {"door_id": "bug"}, {}),
    ],
)
def test_answers_to_orders_are_kept_nowhere_and_shown_in_no_frame(
    controlled: Any, status: int, path: str, body: dict[str, str], headers: dict[str, str]
) -> None:
    answer = post(controlled.url + path, json=body, headers={**bearer(controlled.token), **headers})
    assert answer.status_code == status
    assert {name: answer.headers.get(name) for name in _FULL} == _FULL
    assert "frame-ancestors 'none'" in answer.headers["content-security-policy"]
    assert "server" not in answer.headers


#: Everything that a browser gets of the page, page.html at the root.
PAGE_FILES = [
    path.relative_to(PAGE).as_posix()
    for path in sorted(PAGE.rglob("*"))
    if path.suffix in (".html", ".css", ".js", ".json", ".svg")
]
#: What makes markup or a program of a text.
MAKERS = (
    "innerHTML",
    "outerHTML",
    "insertAdjacentHTML",
    "document.write",
    "createContextualFragment",
    "DOMParser",
)


def test_every_file_of_the_page_is_looked_at() -> None:
    assert len(PAGE_FILES) >= 11
    assert {"page.html", "door.js", "model.js", "monitor_words.js", "texts/de.json"} < set(PAGE_FILES)


@pytest.mark.parametrize("name", PAGE_FILES)
def test_the_page_needs_nothing_from_elsewhere_and_makes_no_markup_of_text(read_only: Any, name: str) -> None:
    answer = get(read_only.url + ("" if name == "page.html" else name))
    assert answer.status_code == 200
    text = answer.text.replace('xmlns="http://www.w3.org/2000/svg"', "")  # names a format, fetches nothing
    assert text == (PAGE / name).read_text(encoding="utf-8").replace('xmlns="http://www.w3.org/2000/svg"', "")
    assert "//" not in text.replace("// ", "")
    assert not [word for word in (*MAKERS, " style=", "onclick", "eval(", "javascript:") if word in text]


@pytest.mark.parametrize(("path", "body"), ORDERS)
def test_a_page_that_only_shows_has_no_control(read_only: Any, path: str, body: dict[str, str]) -> None:
    answer = post(read_only.url + path[1:], json=body, headers=bearer(read_only.token))
    assert answer.status_code == 404
    assert get(read_only.url + "state").json()["control"] is False


@pytest.mark.parametrize(("path", "body"), ORDERS)
@pytest.mark.parametrize(
    "scheme", ["", "Bearer", "Bearer ", "Bearer wrong", "Basic {token}", "{token}", "Bearer {token}x"]
)
def test_without_the_token_nothing_happens(
    controlled: Any, path: str, body: dict[str, str], scheme: str
) -> None:
    headers = {"Authorization": scheme.format(token=controlled.token).strip()} if scheme else {}
    for content in (body, {"door_id": 5}, None):
        answer = post(controlled.url + path[1:], json=content, headers=headers)
        assert answer.status_code == 401
        assert controlled.token not in answer.text
    assert controlled.control.orders == []


def test_the_token_counts_in_no_address_and_no_cookie(controlled: Any) -> None:
    for query in ("token", "access_token", "authorization"):
        answer = post(
            f"{controlled.url}control/mill?{query}={controlled.token}",
            json={"door_id": "oak", query: controlled.token},
            cookies={query: controlled.token},
        )
        assert answer.status_code == 401
    assert controlled.control.orders == []


def test_with_the_token_orders_are_carried_out(controlled: Any) -> None:
    for path, body in ORDERS:
        answer = post(controlled.url + path[1:], json=body, headers=bearer(controlled.token))
        assert answer.status_code == 202
        assert answer.json()["message"]
        assert controlled.token not in answer.text
    assert controlled.control.orders == ["mill oak", "cancel"]


@pytest.mark.parametrize(
    ("body", "field"),
    [
        ({}, "door_id"),
        ({"door_id": ""}, "door_id"),
        ({"door_id": "x" * 101}, "door_id"),
        ({"door_id": 5}, "door_id"),
        ([], "the body"),
    ],
)
def test_a_senseless_order_is_refused_in_one_sentence(controlled: Any, body: object, field: str) -> None:
    answer = post(controlled.url + "control/mill", json=body, headers=bearer(controlled.token))
    assert answer.status_code == 422
    assert answer.json()["fields"] == [field]
    sentence = answer.json()["detail"]
    assert re.fullmatch(rf"what was sent cannot be used \({field}: .{{5,80}}\); put it right .*", sentence)
    assert "xxx" not in sentence
    assert controlled.control.orders == []


def test_whether_the_page_is_there_can_be_asked_without_reading_it(either: Any) -> None:
    for path in ("", "page.js", "state"):
        whole, head = get(either.url + path), httpx.head(either.url + path, timeout=LIMIT)
        assert (head.status_code, head.content) == (200, b"")
        assert head.headers["content-type"] == whole.headers["content-type"]


def test_what_the_cell_refuses_is_answered_with_the_reason(controlled: Any) -> None:
    answer = post(controlled.url + "control/mill", json={"door_id": "busy"}, headers=bearer(controlled.token))
    assert (answer.status_code, answer.json()) == (409, {"detail": "another door is being milled"})


@pytest.mark.parametrize("path", ["control/mill", "control/cancel"])
def test_reading_an_order_does_not_give_it(controlled: Any, path: str) -> None:
    assert get(controlled.url + path, headers=bearer(controlled.token)).status_code == 405
    assert controlled.control.orders == []


def test_doors_are_offered_by_the_beginning_of_their_id(controlled: Any) -> None:
    assert get(controlled.url + "doors", params={"prefix": "oak"}).json() == ["oak", "oak_2"]
    assert len(get(controlled.url + "doors").json()) == 3
    assert get(controlled.url + "doors", params={"prefix": "x" * 101}).status_code == 422
    silent = get(controlled.url + "doors", params={"prefix": "silent"})
    assert (silent.status_code, silent.json()["detail"]) == (409, "the recipe database does not answer")


def test_a_page_that_only_shows_offers_no_doors(read_only: Any) -> None:
    assert get(read_only.url + "doors").status_code == 404


def test_a_foreign_name_pointed_at_this_machine_reads_nothing(either: Any) -> None:
    answer = get(either.url + "state", headers={"Host": "attacker.example"})
    assert answer.status_code == 400
    assert "history" not in answer.text


def test_control_without_a_token_is_not_served() -> None:
    for token in (None, ""):
        with pytest.raises(ValueError, match="token"):
            create_app(ViewStore(), object(), token)


def test_events_tell_every_change(read_only: Any) -> None:
    with httpx.stream("GET", read_only.url + "events", timeout=LIMIT) as stream:
        lines = (line.removeprefix("data: ") for line in stream.iter_lines() if line.startswith("data: {"))
        assert json.loads(next(lines))["door_id"] == ""
        read_only.store.update(lambda view: view.with_run("r1", "oak"))
        assert json.loads(next(lines))["door_id"] == "oak"
        read_only.store.update(lambda view: view.with_stage("milling", 0.7))
        assert json.loads(next(lines))["stage"] == "milling"


def test_a_line_break_in_a_text_does_not_break_the_stream(read_only: Any) -> None:
    read_only.store.update(lambda view: view.with_run("r1", "oak\n\nevent: alive\ndata: {}\r\n"))
    with httpx.stream("GET", read_only.url + "events", timeout=LIMIT) as stream:
        line = next(line for line in stream.iter_lines() if line.startswith("data: "))
    assert json.loads(line.removeprefix("data: "))["door_id"].startswith("oak\n\nevent")


def test_the_newest_picture_alone_is_given(read_only: Any) -> None:
    for data in (b"first", b"second"):
        read_only.store.update(lambda view, data=data: view.with_picture(data, "image/jpeg", ""))
    answer = get(read_only.url + "picture/2")
    assert (answer.content, answer.headers["content-type"]) == (b"second", "image/jpeg")
    assert get(read_only.url + "picture/1").status_code == 404
    assert get(read_only.url + "picture/x").status_code == 422


def test_a_taken_port_is_refused_with_what_to_do() -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        with pytest.raises(PageAddressError, match=f"{port}.*choose another"):
            PageServer(create_app(ViewStore()), "127.0.0.1", port)
    with pytest.raises(PageAddressError, match=r"no host.*0\.0\.0\.0"):
        PageServer(create_app(ViewStore()), "", 0)
    with pytest.raises(PageAddressError, match="no-such-host"):
        PageServer(create_app(ViewStore()), "no-such-host.invalid", 0)


def test_stopping_ends_live_connections() -> None:
    server = PageServer(create_app(ViewStore()), "127.0.0.1", 0).start()
    with httpx.stream("GET", server.url + "events", timeout=LIMIT) as stream:
        lines = stream.iter_lines()
        next(lines)
        server.stop()
        with pytest.raises(httpx.HTTPError):
            list(lines)
    with pytest.raises(httpx.ConnectError):
        get(server.url)


def test_tokens_are_random_and_long() -> None:
    tokens = {new_token() for _ in range(200)}
    assert len(tokens) == 200
    # At least 80 bits, whatever the alphabet seen.
    alphabet = set("".join(tokens))
    assert min(map(len, tokens)) * np.log2(len(alphabet)) > 80


@pytest.mark.parametrize(
    "header", [None, "", "Bearer", "Bearer ", "bearer a", "Bearer \u00fc\u20ac", "Bearer abc d"]
)
def test_only_the_token_authorizes(header: str | None) -> None:
    assert not authorizes(header, "abcd")
    assert authorizes("Bearer abcd", "abcd")


def test_pictures_keep_their_colours_and_fit_a_tablet() -> None:
    picture = np.zeros((2000, 3000, 3), dtype=np.uint8)
    picture[..., 0] = 200
    shown = cv2.imdecode(np.frombuffer(encode_picture(picture), np.uint8), cv2.IMREAD_COLOR)
    assert max(shown.shape) <= LONGEST_SIDE
    assert abs(shown.shape[0] - shown.shape[1] / 1.5) <= 1  # pixel
    blue, green, red = shown.reshape(-1, 3).mean(axis=0)
    assert red > 190
    assert max(blue, green) < 10
    grey = cv2.imdecode(np.frombuffer(encode_picture(picture[..., 0]), np.uint8), cv2.IMREAD_UNCHANGED)
    assert grey.ndim == 2


def test_a_line_of_one_pixel_keeps_its_colour() -> None:
    picture = np.full((100, 100, 3), 90, dtype=np.uint8)
    picture[50] = (255, 50, 40)
    shown = cv2.imdecode(np.frombuffer(encode_picture(picture), np.uint8), cv2.IMREAD_COLOR)
    _, green, red = shown[50].astype(int).mean(axis=0)
    assert red - green > 150
