"""Every order and every refused try is found again, with who, when, what and what came of it."""

from __future__ import annotations

import json
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import httpx
import pytest

from doormill_ros.operator.access.token import Holder, Keys, Role, new_token
from doormill_ros.operator.errors import AuditError
from doormill_ros.operator.orders.audit import LONGEST_TEXT, ORDERS, REFUSED, AuditEntry, AuditLog
from doormill_ros.operator.serving.page_server import PageServer
from doormill_ros.operator.serving.server import create_app
from doormill_ros.operator.views.view_store import ViewStore
from support.waiting import LIMIT

NASTY = "<img src=x>\n\x1b[31m{}\u202e"


def lines(path: Path) -> list[dict[str, Any]]:
    return [json.loads(line) for line in path.read_text().splitlines()]


def entry(message: str, time: str = "2026-01-01T00:00:00.000+00:00") -> AuditEntry:
    return AuditEntry(time, "operate", "", "10.0.0.1", "POST /control/mill", "oak", "accepted", 202, message)


def test_orders_are_written_with_who_when_what_and_outcome(guarded: Any) -> None:
    before = datetime.now(UTC)
    operate, engineer = guarded.keys.operate, guarded.keys.engineer
    guarded.order(operate, "control/mill", json={"door_id": "oak"})
    guarded.order(engineer, "control/cancel")
    guarded.order(operate, "control/mill", json={"door_id": "busy"})
    guarded.order(operate, "control/mill", json={"door_id": ""})
    guarded.order(operate, "control/mill", json={"door_id": "bug"})
    guarded.order(operate, "control/mill", json={"door_id": NASTY})
    found = lines(guarded.folder / ORDERS)
    assert [(e["role"], e["order"], e["door_id"], e["outcome"], e["status"]) for e in found] == [
        ("operate", "POST /control/mill", "oak", "accepted", 202),
        ("engineer", "POST /control/cancel", "", "accepted", 202),
        ("operate", "POST /control/mill", "busy", "refused", 409),
        ("operate", "POST /control/mill", "", "refused", 422),
        ("operate", "POST /control/mill", "bug", "refused", 500),
        ("operate", "POST /control/mill", "", "refused", 422),
    ]
    assert (found[0]["message"], found[2]["message"]) == (
        "door oak is started",
        "another door is being milled",
    )
    assert all(e["address"] == "127.0.0.1" for e in found)
    for told in (datetime.fromisoformat(e["time"]) for e in found):
        assert -0.001 <= (told - before).total_seconds() < 600.0
    assert not (guarded.folder / REFUSED).exists()
    assert (guarded.folder / ORDERS).read_text().isprintable() is False  # its line ends
    assert all(
        line.isprintable() and line.isascii() for line in (guarded.folder / ORDERS).read_text().split("\n")
    )


def test_an_order_with_a_persons_token_is_written_with_the_name(guarded: Any, tmp_path: Path) -> None:
    people = {Holder(Role.OPERATE, "Kari"): new_token(), Holder(Role.ENGINEER, "Jörg"): new_token()}
    keys = Keys(new_token(), None, people)
    app = create_app(ViewStore(), guarded.control, keys, audit=AuditLog(tmp_path))
    headers = [{"Authorization": f"Bearer {token}"} for token in (*people.values(), keys.operate)]
    with PageServer(app, "127.0.0.1", 0) as server:
        answers = [httpx.post(f"{server.url}control/cancel", headers=h, timeout=LIMIT) for h in headers]
        read = httpx.get(f"{server.url}control/audit", headers=headers[1], timeout=LIMIT)
        refused = httpx.get(f"{server.url}control/audit", headers=headers[0], timeout=LIMIT)
    assert [answer.status_code for answer in (*answers, read, refused)] == [202, 202, 202, 200, 403]
    found = lines(tmp_path / ORDERS)
    assert [(e["role"], e["who"]) for e in found] == [
        ("operate", "Kari"),
        ("engineer", "Jörg"),
        ("operate", ""),
        ("engineer", "Jörg"),
        ("operate", "Kari"),
    ]
    assert [e["who"] for e in read.json()[::-1]] == ["Kari", "Jörg", ""]


def test_refused_tries_are_written_apart_and_no_token_is(guarded: Any) -> None:
    guess = "a-guess-that-may-be-nearly-right"
    guarded.order(None)
    for _ in range(6):
        guarded.order(guess, f"control/mill?token={guess}", json={"door_id": "oak"})
    guarded.now[0] += 1000.0
    guarded.order(guarded.keys.operate, headers={"Origin": "http://a.example"})
    guarded.order(guarded.keys.operate, headers={"Host": "a.example"})
    found = lines(guarded.folder / REFUSED)
    assert [e["status"] for e in found] == [401] * 6 + [429, 403, 400]
    assert {(e["role"], e["outcome"], e["address"]) for e in found} == {("look", "refused", "127.0.0.1")}
    assert "a.example" in found[7]["message"]
    assert not (guarded.folder / ORDERS).exists()
    guarded.order(guarded.keys.operate)
    text = (guarded.folder / REFUSED).read_text() + (guarded.folder / ORDERS).read_text()
    for secret in (guess, guarded.keys.operate, guarded.keys.engineer):
        assert secret not in text


def test_looking_is_not_written(guarded: Any) -> None:
    for path in ("", "state", "doors", "controls"):
        guarded.order(None, path, "GET")
    assert not guarded.folder.exists()


def test_nothing_is_started_that_cannot_be_written_down_but_a_run_is_canceled(guarded: Any) -> None:
    guarded.folder.write_text("a file where the folder belongs")
    refused = guarded.order(guarded.keys.operate, "control/mill", json={"door_id": "oak"})
    assert refused.status_code == 409
    assert f"{guarded.folder / ORDERS} cannot be written" in refused.json()["detail"]
    assert guarded.control.orders == []
    assert guarded.order(guarded.keys.operate, "control/cancel").status_code == 202
    assert guarded.control.orders == ["cancel"]
    fault = guarded.store.view.faults["the audit log"]
    assert ("cannot be written" in fault.message, fault.error_code) == (True, AuditError.code)
    guarded.folder.unlink()
    assert guarded.order(guarded.keys.operate, "control/cancel").status_code == 202
    assert guarded.store.view.faults == {}


def test_full_files_are_kept_and_the_oldest_go(tmp_path: Path) -> None:
    log = AuditLog(tmp_path, largest=1000, kept=3)
    for number in range(100):
        log.write(entry(f"no. {number}"), True)
    files = sorted(tmp_path.iterdir())
    assert [path.name for path in files] == [ORDERS, *(f"{ORDERS}.{n}" for n in (1, 2, 3))]
    assert all(0 < path.stat().st_size <= 1000 for path in files)
    told = [e["message"] for path in (files[3], files[2], files[1], files[0]) for e in lines(path)]
    assert told == [f"no. {n}" for n in range(100 - len(told), 100)]


def test_tries_push_no_order_out(tmp_path: Path) -> None:
    log = AuditLog(tmp_path, largest=1000, kept=1)
    log.write(entry("an order"), True)
    for _ in range(50):
        log.write(entry("a try"), False)
    assert [e["message"] for e in lines(tmp_path / ORDERS)] == ["an order"]


def test_damaged_and_long_lines_cost_nothing_but_themselves(tmp_path: Path) -> None:
    log = AuditLog(tmp_path)
    log.write(entry("first", "2026-01-01"), True)
    with (tmp_path / ORDERS).open("ab") as stream:
        stream.write(b'{"time": \xff\n[1]\n' + b"[" * 100_000 + b"\n")
    log.write(entry("x" * 5000, "2026-01-02"), False)
    assert [len(e["message"]) for e in log.last(10)] == [LONGEST_TEXT, 5]
    assert len(log.last(1)) == 1


def test_a_folder_that_cannot_be_made_is_named(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(AuditError, match=r"file/audit.*choose another folder"):
        AuditLog(tmp_path / "file" / "audit").require()
