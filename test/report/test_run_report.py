"""The page of a run, opened in a real browser."""

from __future__ import annotations

import base64
import functools
import re
from collections.abc import Callable, Iterator
from datetime import UTC, datetime
from pathlib import Path
from types import SimpleNamespace

import cv2
import numpy as np
import pytest
from playwright.sync_api import Browser, Page

from doormill_interfaces.msg import DoorInspection
from doormill_ros.measurements.inspections.inspection_writer import write_inspection
from doormill_ros.recording.bag_reader import read_bag
from doormill_ros.report import run_record
from doormill_ros.report.figures import picture_url
from doormill_ros.report.run_record import read_run
from doormill_ros.report.run_report import render_report, write_report
from doormill_ros.tools.report import main
from support.source_tree import ROOT

BAGS = ROOT / "bags"
GOOD = ("thesis_190_0deg", "standard_door")
REFUSED = ("unknown_door", "no_picture", "outside_y", "unreachable", "spindle_fault")


class OpenedPage:
    """A page and everything its browser complained of or asked for."""

    def __init__(self, page: Page, path: Path) -> None:
        self.page = page
        self.complaints: list[str] = []
        self.requests: list[str] = []
        page.on(
            "console", lambda m: self.complaints.append(m.text) if m.type in ("error", "warning") else None
        )
        page.on("pageerror", lambda e: self.complaints.append(str(e)))
        page.on("request", lambda r: self.requests.append(r.url))
        page.goto(path.as_uri())

    def headings(self) -> list[str]:
        return self.page.locator("h2").all_inner_texts()


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Path]:
    """Where the report of a shipped bag lies; each is written once."""

    @functools.cache
    def write(scenario: str) -> Path:
        path = tmp_path_factory.mktemp("reports") / f"{scenario}.html"
        write_report(BAGS / scenario, path)
        return path

    return write


@pytest.fixture
def open_report(browser: Browser, written: Callable[[str], Path]) -> Iterator[Callable[[str], OpenedPage]]:
    pages = []

    def show(scenario: str) -> OpenedPage:
        path = written(scenario)
        pages.append(browser.new_page(viewport={"width": 1100, "height": 1400}))
        return OpenedPage(pages[-1], path)

    yield show
    for page in pages:
        page.close()


def result_of(scenario: str) -> object:
    return [m.message for m in read_bag(BAGS / scenario, ["/run/result"])][-1]


@pytest.mark.parametrize("scenario", [*GOOD, *REFUSED])
def test_the_verdict_is_the_first_line_and_nothing_is_wrong(
    scenario: str, open_report: Callable[[str], OpenedPage]
) -> None:
    opened, result = open_report(scenario), result_of(scenario)
    assert opened.page.inner_text("#verdict") == result.message
    assert opened.page.inner_text("body").startswith(result.message)
    assert opened.page.locator("#verdict").get_attribute("class") == ("good" if result.success else "bad")
    assert opened.complaints == []
    # Self-contained: nothing but the file itself and what it carries.
    assert [u for u in opened.requests if not u.startswith(("file:", "data:"))] == []


@pytest.mark.parametrize("scenario", [*GOOD, *REFUSED])
def test_every_picture_is_drawn(scenario: str, open_report: Callable[[str], OpenedPage]) -> None:
    page = open_report(scenario).page
    widths = page.evaluate("Array.from(document.images).map(i => i.complete ? i.naturalWidth : 0)")
    drawn = page.evaluate(
        "Array.from(document.querySelectorAll('svg')).map(s => s.getBoundingClientRect().height)"
    )
    assert all(width > 100 for width in widths), widths
    assert all(height > 50 for height in drawn), drawn
    assert len(drawn) + len(widths) >= (7 if scenario in GOOD else 1)


@pytest.mark.parametrize("scenario", GOOD)
def test_a_milled_door_has_every_section(scenario: str, open_report: Callable[[str], OpenedPage]) -> None:
    opened = open_report(scenario)
    assert opened.headings() == [
        "Picture",
        "Door and path",
        "Pose and uncertainty",
        "Milled contour against the recipe",
        "Predicted and executed deflection",
        "Correction at the targets",
        "Stage times",
        "Handshake with the controller",
        "RAPID target file",
        "Recipe",
        "Recorded topics",
    ]
    text = opened.page.inner_text("body")
    first_line = next(m.message.data for m in read_bag(BAGS / scenario, ["/abb/target_file"])).splitlines()[0]
    assert first_line in text
    assert re.search(r"recipe\s+\S+, version \d+, saved by", text)
    assert re.search(r"software\s+doormill_ros \d+\.\d+\.\d+", text)
    assert re.search(r"robot model\s+irb6600", text)


def test_a_refused_picture_shows_no_pose(open_report: Callable[[str], OpenedPage]) -> None:
    headings = open_report("outside_y").headings()
    assert "Door and path" in headings
    assert "Pose and uncertainty" not in headings
    assert "RAPID target file" not in headings


def test_text_of_a_bag_cannot_become_part_of_the_page(
    browser: Browser, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from doormill_ros.report import run_report

    record = read_run(BAGS / "unknown_door")
    record.latest["run/result"].message = "<script>console.error('in')</script> & <b>bold</b>"
    path = tmp_path / "page.html"
    path.write_text(run_report.render_report(record), encoding="utf-8")
    page = browser.new_page()
    opened = OpenedPage(page, path)
    assert page.inner_text("#verdict") == "<script>console.error('in')</script> & <b>bold</b>"
    assert opened.complaints == []
    page.close()


def test_a_fault_while_milling_shows_the_file_that_was_handed_over(
    open_report: Callable[[str], OpenedPage],
) -> None:
    opened = open_report("spindle_fault")
    assert "RAPID target file" in opened.headings()
    assert "handed over before" in opened.page.inner_text("body")


def test_a_file_of_another_run_is_not_shown() -> None:
    record = read_run(BAGS / "outside_y")
    record.latest["abb/target_file"] = read_run(BAGS / "thesis_190_0deg").get("abb/target_file")
    page = render_report(record)
    assert "RAPID target file" not in page
    assert "No target file was left" in page


def test_stages_that_were_not_reached_have_no_time(open_report: Callable[[str], OpenedPage]) -> None:
    text = open_report("unknown_door").page.inner_text("body")
    assert text.count("not reached") == 4
    assert "0.0 ms" not in text


@pytest.mark.parametrize("width", [768, 1400])
def test_the_page_fits_tablet_and_desktop(width: int, open_report: Callable[[str], OpenedPage]) -> None:
    page = open_report("outside_y").page
    page.set_viewport_size({"width": width, "height": 1000})
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    lines = page.evaluate(
        """Array.from(document.querySelectorAll('td.number')).map(cell => {
            const range = document.createRange();
            range.selectNodeContents(cell);
            return range.getClientRects().length;
        })"""
    )
    assert set(lines) == {1}  # no number is broken into two lines


def decoded(url: str) -> np.ndarray:
    data = base64.b64decode(url.removeprefix("data:image/jpeg;base64,"))
    return cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_COLOR).astype(int)


def image(pixels: np.ndarray, encoding: str, padding: int = 0) -> SimpleNamespace:
    height, width = pixels.shape[:2]
    rows = np.pad(pixels.reshape(height, -1), ((0, 0), (0, padding)))
    return SimpleNamespace(
        height=height, width=width, encoding=encoding, step=rows.shape[1], data=rows.ravel()
    )


def test_an_overlay_keeps_the_colour_of_its_lines() -> None:
    pixels = np.full((100, 100, 3), 90, dtype=np.uint8)
    pixels[50] = (255, 50, 40)
    _, green, red = decoded(picture_url(image(pixels, "rgb8")))[50].mean(axis=0)
    assert red - green > 150


@pytest.mark.parametrize(("encoding", "padding"), [("mono8", 0), ("mono8", 6), ("bgr8", 0)])
def test_camera_pictures_are_shown_as_drivers_send_them(encoding: str, padding: int) -> None:
    pixels = np.full((40, 60) if encoding == "mono8" else (40, 60, 3), 30, dtype=np.uint8)
    pixels[:, 30:] = 200
    shown = decoded(picture_url(image(pixels, encoding, padding)))
    assert shown.shape == (40, 60, 3)
    assert abs(shown[:, :25].mean() - 30) < 3
    assert abs(shown[:, 35:].mean() - 200) < 3


def test_a_picture_that_nobody_reads_is_left_out() -> None:
    record = read_run(BAGS / "outside_y")
    del record.latest["door/overlay"]
    record.latest["camera/image_raw"].encoding = "bayer_rggb16"
    page = render_report(record)
    assert "<h2>Picture</h2>" not in page
    assert "13.0" in page


def test_the_tool_writes_the_page_beside_the_bag_and_refuses_others(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "page.html"
    assert main([str(BAGS / "unknown_door"), "--out", str(out)]) == 0
    assert "no_such_door" in out.read_text(encoding="utf-8")
    capsys.readouterr()
    assert main([str(tmp_path / "nowhere")]) == 2
    assert "nowhere" in capsys.readouterr().err


def test_a_bag_of_older_software_is_not_believed_that_a_bad_door_is_good() -> None:
    record = read_run(BAGS / "thesis_190_0deg")
    feature = record.latest["simulation/milled_door"].features[0]
    feature.corrected_max = 1.6e-3
    page = render_report(record)
    assert "Door thesis_190_0deg: milled, out of tolerance" in page
    assert f"{feature.feature} is 1.60 mm off where 0.50 mm are allowed" in page
    assert 'class="bad"' in page


@pytest.mark.parametrize(
    ("deviation", "said"),
    [(-1.6e-3, "milled, out of tolerance"), (0.2e-3, "hinge_1 is 0.20 mm off where 0.50 mm are allowed")],
)
def test_a_gauge_that_is_not_part_of_the_cell_is_believed(deviation: float, said: str) -> None:
    record = read_run(BAGS / "thesis_190_0deg")
    gauged = DoorInspection(
        run_id="r", feature=["hinge_1", "hinge_2"], wall=[True, False], deviation=[deviation, 1e-5]
    )
    record.latest["door/inspection"] = gauged
    assert "1.60 mm" not in render_report(record)  # who measured in the cell is believed first
    del record.latest["simulation/milled_door"]
    page = render_report(record)
    assert said in page
    assert "not measured" not in page


def test_an_inspection_is_found_by_its_run(monkeypatch: pytest.MonkeyPatch) -> None:
    run = read_run(BAGS / "thesis_190_0deg").get("run/result").run_id

    def measured_later(bag: Path) -> Iterator[SimpleNamespace]:
        yield from read_bag(bag)
        for run_id in (run, "another"):
            yield SimpleNamespace(topic="/cell1/door/inspection", message=DoorInspection(run_id=run_id))

    monkeypatch.setattr(run_record, "read_bag", measured_later)
    assert read_run(BAGS / "thesis_190_0deg").get("door/inspection").run_id == run


@pytest.mark.parametrize(
    ("own", "said"), [(True, "milled, out of tolerance"), (False, "milled, not measured")]
)
def test_an_inspection_beside_the_bag_is_believed(tmp_path: Path, own: bool, said: str) -> None:
    bag = tmp_path / "bag"
    bag.symlink_to(BAGS / "thesis_190_0deg")
    run = read_run(bag).get("run/result").run_id
    points = SimpleNamespace(
        feature=["hinge_1"],
        surface=["wall"],
        point=np.zeros((1, 3)),
        normal=np.eye(3)[:1],
        deviation=[1.6e-3],
    )
    measured_at = datetime(2026, 11, 22, 8, tzinfo=UTC)
    write_inspection(tmp_path / "inspection", bag, run if own else "another", measured_at, 1e-5, points)
    record = read_run(bag)
    del record.latest["simulation/milled_door"]
    assert said in render_report(record)


def test_a_door_that_nobody_measured_is_said_to_be_so() -> None:
    record = read_run(BAGS / "thesis_190_0deg")
    del record.latest["simulation/milled_door"]
    assert "Door thesis_190_0deg: milled, not measured" in render_report(record)


@pytest.mark.parametrize("scenario", GOOD)
def test_the_largest_expected_error_is_that_of_a_feature(scenario: str) -> None:
    targets = read_run(BAGS / scenario).get("path/targets")
    (told,) = re.findall(r"expected error</th><td>(.*?)</td>", render_report(read_run(BAGS / scenario)))
    errors = [float(value) for value in re.findall(r"([\d.]+) mm", told)]
    assert max(errors) == pytest.approx(1e3 * targets.expected_error, abs=5.1e-4)
