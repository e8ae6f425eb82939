"""No order carries a text that another part of the cell would read as another one."""

from __future__ import annotations

import json
from typing import Any

import httpx
import pytest

from doormill_ros.operator.orders.audit import ORDERS

UNPRINTABLE = ["oak\0x", "\0", "\ud800", "oak\n", "oak\x1b[31m", "oak\x7f", "oak\u202e", "oak\u2028"]
ORDER = {"version": 3, "who": "Kari", "why": "seen on 15 doors"}
PLACES = [
    ("control/mill", {}, "door_id"),
    *(("control/" + name, ORDER, field) for name in ("accept", "revert") for field in ("who", "why")),
]


def refused(answer: httpx.Response) -> str:
    """The sentence of a refused order."""
    assert answer.status_code == 422
    sentence = answer.json()["detail"]
    assert isinstance(sentence, str)
    assert "cannot be printed; type it again" in sentence
    assert sentence.isprintable()
    return sentence


@pytest.mark.parametrize("text", UNPRINTABLE, ids=ascii)
@pytest.mark.parametrize(("path", "body", "field"), PLACES)
def test_an_order_with_an_unprintable_text_is_refused_and_written_down(
    guarded: Any, path: str, body: dict[str, Any], field: str, text: str
) -> None:
    # As ASCII with escapes: that is how half a surrogate pair gets through.
    content = json.dumps({**body, field: text}).encode()
    answer = guarded.order(
        guarded.keys.engineer, path, content=content, headers={"Content-Type": "application/json"}
    )
    sentence = refused(answer)
    assert ascii(text) in sentence
    assert guarded.control.orders == []
    (line,) = (guarded.folder / ORDERS).read_text(encoding="ascii").splitlines()
    entry = json.loads(line)
    assert (entry["door_id"], entry["status"], entry["message"]) == ("", 422, sentence)
    shown = guarded.order(guarded.keys.engineer, "control/audit", "GET").json()
    assert [one["message"] for one in shown] == [sentence]


@pytest.mark.parametrize("prefix", ["%00", "oak%00x", "oak%0A", "%1B"])
def test_no_doors_are_looked_up_by_an_unprintable_beginning(guarded: Any, prefix: str) -> None:
    refused(guarded.order(None, f"doors?prefix={prefix}", "GET"))


def test_letters_of_every_language_are_printable(guarded: Any) -> None:
    body = {**ORDER, "who": "Jörg Ødegård", "why": "dør 7, målt på nytt ✓"}
    assert guarded.order(guarded.keys.engineer, "control/accept", json=body).status_code == 200
    assert guarded.control.orders == ["accept 3, Jörg Ødegård: dør 7, målt på nytt ✓"]


def test_a_long_unprintable_text_is_told_in_short(guarded: Any) -> None:
    answer = guarded.order(guarded.keys.operate, "control/mill", json={"door_id": "\x1b" * 1000})
    assert len(refused(answer)) < 500
