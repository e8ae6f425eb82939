"""The store of models: what is in use changes by orders alone, in one step, and whatever is broken is said."""

import json
import os
import subprocess
import sys
from datetime import UTC, datetime

import pytest

from doormill_ros.models.errors import (
    MillingStoppedError,
    ModelStoreError,
    OrderNotSignedError,
    UnknownVersionError,
    VersionInUseError,
)
from doormill_ros.models.store import RECORD, ModelInUse, ModelStore

WHO = ("Kari", "door 15 to 30 say so")
AT = datetime(2026, 11, 22, 8, 0, tzinfo=UTC)


@pytest.fixture
def store(tmp_path):
    return ModelStore(tmp_path / "models", now=lambda: AT)


def test_an_empty_store_leaves_the_model_of_the_start(store):
    assert store.for_next_run() == ModelInUse(0, "")
    assert not store.folder.exists()


def test_a_proposal_is_in_use_only_after_an_order(store):
    assert store.propose(b"a", "doors") == 1
    assert store.for_next_run() == ModelInUse()
    assert store.accept(1, *WHO) == 1
    used = store.for_next_run()
    assert used.version == 1
    with open(used.path, "rb") as file:
        assert file.read() == b"a"


def test_orders_are_kept_with_who_when_and_why(store):
    store.propose(b"a", "doors")
    store.accept(1, *WHO)
    store.revert(1, "Ola", "it was the drill")
    document = json.loads((store.folder / RECORD).read_text())
    assert document["orders"] == [
        {
            "order": "accept",
            "version": 1,
            "before": 0,
            "at": "2026-11-22T08:00:00+00:00",
            "who": "Kari",
            "why": "door 15 to 30 say so",
        },
        {
            "order": "revert",
            "version": 0,
            "before": 1,
            "at": "2026-11-22T08:00:00+00:00",
            "who": "Ola",
            "why": "it was the drill",
        },
    ]


def test_reverting_goes_back_step_by_step_and_numbers_are_never_given_twice(store):
    for number in (1, 2):
        assert store.propose(b"%d" % number, "doors") == number
        store.accept(number, *WHO)
    assert store.revert(2, *WHO) == 1
    assert store.revert(1, *WHO) == 0
    assert store.propose(b"3", "doors") == 3
    # What was in use once can be again; the same model has no second number.
    assert store.propose(b"2", "doors") == 2
    assert store.accept(2, *WHO) == 2


@pytest.mark.parametrize("version", [0, 2, 7])
def test_a_version_that_is_not_there_is_not_accepted(store, version):
    store.propose(b"a", "doors")
    before = store.record()
    with pytest.raises(UnknownVersionError):
        store.accept(version, *WHO)
    assert store.record() == before


def test_a_proposal_that_a_later_one_took_the_place_of_is_not_accepted(store):
    store.propose(b"a", "doors")
    store.propose(b"b", "more doors")
    with pytest.raises(UnknownVersionError, match=r"outdated.*there are 2"):
        store.accept(1, *WHO)
    assert store.accept(2, *WHO) == 2


def test_what_is_in_use_is_not_accepted_again_and_only_that_is_taken_back(store):
    store.propose(b"a", "doors")
    with pytest.raises(VersionInUseError):
        store.revert(0, *WHO)
    store.accept(1, *WHO)
    with pytest.raises(VersionInUseError):
        store.accept(1, *WHO)
    with pytest.raises(VersionInUseError, match="version 1 is in use; name that one"):
        store.revert(2, *WHO)
    assert store.record().in_use == 1


@pytest.mark.parametrize(("who", "why"), [("", "because"), ("Kari", " "), ("\n", "")])
def test_an_order_without_a_name_or_a_reason_is_refused(store, who, why):
    store.propose(b"a", "doors")
    with pytest.raises(OrderNotSignedError):
        store.accept(1, who, why)
    assert store.record().in_use == 0


def test_what_stops_milling_is_about_the_model_in_use(store):
    store.propose(b"a", "doors")
    store.stop("0.6 mm off")
    with pytest.raises(MillingStoppedError, match=r"0\.6 mm off"):
        store.for_next_run()
    store.accept(1, *WHO)
    assert store.for_next_run().version == 1
    store.stop("0.7 mm off")
    store.stop("")
    assert store.for_next_run().version == 1


def test_a_model_that_was_changed_mills_nothing_until_it_is_taken_back(store):
    store.propose(b"a", "doors")
    store.accept(1, *WHO)
    with open(store.for_next_run().path, "ab") as file:
        file.write(b" ")
    with pytest.raises(ModelStoreError, match="is not what was proposed as version 1"):
        store.for_next_run()
    assert store.revert(1, *WHO) == 0
    assert store.for_next_run() == ModelInUse()


RECORDS = {
    "no json": "{",
    "another schema": '{"schema": "doormill/models/9"}',
    "a list": "[]",
    "no versions": '{"schema": "doormill/models/1", "issued": 0, "orders": [], "stop": null}',
    "an order of nothing": (
        '{"schema": "doormill/models/1", "issued": 0, "versions": [], "stop": null, "orders": [{"order": "accept", '
        '"version": 3, "before": 0, "at": "", "who": "", "why": ""}]}'
    ),
    "a number that is a word": (
        '{"schema": "doormill/models/1", "issued": "1", "versions": [], "orders": [], "stop": null}'
    ),
    "an unknown key": (
        '{"schema": "doormill/models/1", "issued": 1, "versions": [{"odd": 2}], "orders": [], "stop": null}'
    ),
}


@pytest.mark.parametrize("text", RECORDS.values(), ids=RECORDS)
def test_a_broken_record_is_said_and_nothing_is_milled_by_another_model(store, text):
    store.propose(b"a", "doors")
    (store.folder / RECORD).write_text(text)
    with pytest.raises(ModelStoreError, match=r"models\.json cannot be used"):
        store.for_next_run()
    with pytest.raises(ModelStoreError):
        store.accept(1, *WHO)
    assert (store.folder / RECORD).read_text() == text


def test_a_record_that_is_gone_is_not_taken_for_an_empty_one(store):
    store.propose(b"a", "doors")
    (store.folder / RECORD).unlink()
    with pytest.raises(ModelStoreError, match="it is gone"):
        store.for_next_run()


PROPOSE_FOR_EVER = """
import sys
from pathlib import Path
from doormill_ros.models.store import ModelStore
store = ModelStore(Path(sys.argv[1]))
for number in range(100_000):
    version = store.propose(b"model %d" % number, "doors")
    if number % 2:
        store.accept(version, "Kari", "door 15 to 30 say so")
"""


def test_a_writer_that_is_killed_leaves_a_store_that_can_be_read_and_written(tmp_path):
    for _ in range(8):
        # No fork: this process has threads, whose locks the child would find taken for ever.
        process = subprocess.Popen([sys.executable, "-c", PROPOSE_FOR_EVER, str(tmp_path)])
        issued = ModelStore(tmp_path).record().issued
        while ModelStore(tmp_path).record().issued < issued + 3:
            assert process.poll() is None
        process.kill()
        process.wait()
        store = ModelStore(tmp_path)
        used = store.for_next_run()
        assert used.version == store.record().in_use
        number = store.propose(os.urandom(8), "after the kill")
        assert number > store.record().in_use
        assert store.accept(number, *WHO) == number
