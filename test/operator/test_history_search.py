"""All kept runs can be searched and taken away as a table that no spreadsheet calculates."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Iterator
from datetime import datetime, timedelta
from pathlib import Path

import httpx
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from playwright.sync_api import expect

from doormill_ros.cell.errors import OutOfToleranceError
from doormill_ros.operator.history.history import FILE, append_history, kept_runs
from doormill_ros.operator.history.history_csv import history_csv
from doormill_ros.operator.serving.page_server import PageServer
from doormill_ros.operator.serving.server import HEADERS, create_app
from doormill_ros.operator.views.ended_run import EndedRun
from doormill_ros.operator.views.state import HISTORY
from doormill_ros.operator.views.view_store import ViewStore
from support.browser import open_page
from support.waiting import LIMIT

COLUMNS = ["run_id", "door_id", "ended", "outcome", "error_code", "message", "measured"]
MANY = 120
BEGIN = 1_700_000_000.0  # s since the epoch
NASTY = "<img src=x onerror=\"document.title='broken'\">"


def runs() -> list[EndedRun]:
    """Oaks that were milled, every fifth an ash that was refused, one spoiled."""
    made = [
        EndedRun(f"r{n}", "ash", False, 201, f"no edge {n}", BEGIN + n)
        if n % 5 == 0
        else EndedRun(f"r{n}", "Oak_æ", True, 0, "milled", BEGIN + n, True)
        for n in range(MANY)
    ]
    spoiled = EndedRun(
        "bad", "=1+1", False, OutOfToleranceError.code, f'{NASTY}, "1.6"\r\n', BEGIN - 1.5, True
    )
    return [spoiled, *made]


@pytest.fixture
def page(tmp_path: Path) -> Iterator[tuple[str, ViewStore, Path]]:
    for run in runs():
        append_history(tmp_path, run)
    store = ViewStore()
    newest = tuple(reversed(runs()))
    store.update(lambda view: view.with_history(newest))
    with PageServer(create_app(store, history=tmp_path), "127.0.0.1", 0) as server:
        yield server.url, store, tmp_path


def found(url: str, search: str, **more: object) -> dict[str, object]:
    answer = httpx.get(url + "history", params={"search": search, **more}, timeout=LIMIT)
    assert answer.status_code == 200
    return answer.json()


def test_the_oldest_run_is_found_behind_the_shown_ones(page: tuple[str, ViewStore, Path]) -> None:
    url, store, _ = page
    assert all(run.run_id != "r1" for run in store.view.history)
    assert found(url, "")["found"] == MANY + 1
    for search, language, count in (
        ("OAK", "en", 96),
        ("ash edge", "en", 24),
        ("edge 115", "en", 1),
        ("201", "en", 24),
        ("refused (201)", "en", 24),
        ("out of tolerance", "en", 1),
        ("toleranse", "nb", 1),
        ("toleranse", "en", 0),
        ("gefräst", "de", 97),
        ("oak ash", "en", 0),
    ):
        assert found(url, search, language=language)["found"] == count, search
    answer = found(url, "ash", limit=3)
    assert (answer["found"], answer["kept"], answer["whole"]) == (24, MANY + 1, True)
    assert [run["run_id"] for run in answer["runs"]] == ["r115", "r110", "r105"]
    assert len(found(url, "")["runs"]) == HISTORY
    (spoiled,) = found(url, "tolerance")["runs"]
    assert spoiled["came_to"] == "out_of_tolerance"


def test_the_table_holds_all_that_match_and_is_a_file(page: tuple[str, ViewStore, Path]) -> None:
    url, _, _ = page
    answer = httpx.get(url + "history.csv", timeout=LIMIT)
    assert answer.headers["content-type"] == "text/csv; charset=utf-8"
    assert answer.headers["content-disposition"] == 'attachment; filename="history.csv"'
    assert {name: answer.headers.get(name) for name in HEADERS} == HEADERS
    header, *rows = csv.reader(io.StringIO(answer.content.decode("utf-8"), newline=""))
    assert header == COLUMNS
    assert answer.content.count(b"\r\n") == MANY + 3  # one of them in a message
    assert [row[0] for row in rows] == [f"r{n}" for n in reversed(range(MANY))] + ["bad"]
    assert rows[-1][1] == "'=1+1"
    assert rows[-1][3:] == [
        "milled, out of tolerance",
        str(OutOfToleranceError.code),
        f'{NASTY}, "1.6"\r\n',
        "true",
    ]
    assert rows[0][:2] == ["r119", "Oak_æ"]
    ended = datetime.fromisoformat(rows[-1][2])
    assert ended.timestamp() == BEGIN - 1.5
    assert ended.utcoffset() == timedelta()
    some = httpx.get(url + "history.csv", params={"search": "ash"}, timeout=LIMIT).text
    assert [row[1] for row in csv.reader(io.StringIO(some))] == ["door_id", *["ash"] * 24]


SIGNS = ("=", "+", "-", "@", "\t", "\r", "\n", "＝")


@example(text="=1+1")
@example(text="\t=1")
@example(text="oak;=1+1")
@example(text='oak; "=1+1"')
@example(text=" =1+1")
@example(text="\ud800")
@given(text=st.text(st.one_of(st.sampled_from("=+-@\t\r\n;,\" 'a＝"), st.characters())))
def test_no_spreadsheet_calculates_a_cell(text: str) -> None:
    content = history_csv([EndedRun(text, text, False, -3, text, 0.0)]).decode("utf-8")
    (_, row) = csv.reader(io.StringIO(content, newline=""))
    assert row[4] == "-3"
    sent = text.encode("utf-8", "replace").decode()
    assert row[5].replace("'", "") == sent.replace("'", "")
    cells = [row[0], row[1], row[5]]
    # Where a comma divides no cells, a semicolon does.
    for cell in (*cells, *(part for whole in cells for part in whole.split(";"))):
        assert not cell.lstrip(' "').startswith(SIGNS[:4] + SIGNS[7:]), cell
    assert not any(cell.startswith(SIGNS) for cell in cells)


def test_a_run_as_it_was_is_no_formula_and_stays(tmp_path: Path) -> None:
    text = "door oak-2: 1.6 mm at 0.5; see a+b, c = d"
    (_, row) = csv.reader(io.StringIO(history_csv([EndedRun("r", text, True, 0, text, 0.0)]).decode()))
    assert (row[1], row[5]) == (text, text)


def test_a_long_file_is_read_from_its_end_and_that_is_told(tmp_path: Path) -> None:
    for run in runs():
        append_history(tmp_path, run)
    lines = (tmp_path / FILE).read_bytes().splitlines(keepends=True)
    last = sum(map(len, lines[-10:]))
    for most, number, whole in ((10**6, len(lines), True), (last + 1, 10, False), (last - 1, 9, False)):
        kept = kept_runs(tmp_path, most)
        assert (kept.runs, kept.whole) == (tuple(runs()[-number:]), whole)
    assert kept_runs(tmp_path / "nowhere").runs == ()


@pytest.mark.parametrize("ended", ["NaN", "Infinity", "-1", "1e300", "253402300800"])
def test_a_time_that_no_calendar_has_spoils_no_table(page: tuple[str, ViewStore, Path], ended: str) -> None:
    url, _, folder = page
    line = json.dumps({"run_id": "x", "door_id": "\ud800", "success": True, "error_code": 0, "message": ""})
    with (folder / FILE).open("a") as stream:
        stream.write(f'{line[:-1]}, "ended": {ended}}}\n')
    assert found(url, "")["found"] == MANY + 1
    assert httpx.get(url + "history.csv", timeout=LIMIT).status_code == 200


def test_what_cannot_be_encoded_spoils_no_answer(page: tuple[str, ViewStore, Path]) -> None:
    url, _, folder = page
    append_history(folder, EndedRun("x", "\ud800", True, 0, "m" * 5000, BEGIN))
    (run,) = found(url, "mmmm")["runs"]
    assert len(run["message"]) == 2000
    table = httpx.get(url + "history.csv", params={"search": "mmmm"}, timeout=LIMIT)
    assert "m" * 5000 in table.text


@pytest.mark.parametrize(
    "query", ["limit=0", "limit=201", "limit=many", "language=fr", f"search={'x' * 201}"]
)
def test_a_senseless_search_is_refused(page: tuple[str, ViewStore, Path], query: str) -> None:
    assert httpx.get(f"{page[0]}history?{query}", timeout=LIMIT).status_code == 422


@pytest.mark.parametrize("path", ["history", "history.csv"])
def test_the_history_is_read_under_its_own_name_only(page: tuple[str, ViewStore, Path], path: str) -> None:
    for headers, status in (({"Host": "a.example"}, 400), ({"Origin": "http://a.example"}, 403)):
        answer = httpx.get(page[0] + path, headers=headers, timeout=LIMIT)
        assert answer.status_code == status
        assert "ash" not in answer.text
    assert httpx.post(page[0] + path, timeout=LIMIT).status_code == 405


def test_a_page_without_a_folder_searches_what_it_shows() -> None:
    store = ViewStore()
    store.update(lambda view: view.with_ended(EndedRun("r", "oak", True, 0, "", BEGIN)))
    with PageServer(create_app(store), "127.0.0.1", 0) as server:
        assert found(server.url, "oak")["found"] == 1


def test_the_operator_searches_and_saves(page: tuple[str, ViewStore, Path]) -> None:
    url, store, _ = page
    with open_page(url, locale="nb-NO") as (shown, errors):
        rows, told = shown.locator("#history tr"), shown.locator("#found")
        expect(rows).to_have_count(HISTORY)
        assert told.get_attribute("aria-live") == "polite"
        field = shown.get_by_label("Søk i alle kjøringer")
        field.fill("ash avvist")
        expect(told).to_have_text("24 av 121 kjøringer funnet")
        expect(rows).to_have_count(24)
        with shown.expect_download() as saved:
            shown.locator("#export").click()
        assert saved.value.suggested_filename == "history.csv"
        assert len(Path(saved.value.path()).read_text().splitlines()) == 25
        # A run that ends meanwhile is found too, and no view brings back what was not sought.
        store.update(lambda view: view.with_ended(EndedRun("new", "ash", False, 201, "", BEGIN + MANY)))
        expect(told).to_have_text("25 av 122 kjøringer funnet")
        expect(rows).to_have_count(25)
        # Words of a result follow the language.
        shown.locator("#language").select_option("en")
        expect(told).to_have_text("0 of 122 runs found")
        field = shown.get_by_label("Search all runs")
        field.fill("milled")
        expect(told).to_have_text("97 of 122 runs found, the newest 50 are shown")
        field.fill("onerror")
        expect(rows).to_have_count(1)
        expect(rows).to_contain_text(NASTY)
        field.fill("")
        expect(rows).to_have_count(HISTORY)
        expect(told).to_have_text("")
        assert shown.title() == "Door milling cell"
        assert errors == []
