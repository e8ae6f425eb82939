"""report.html in a real browser: verdict first, nothing complained of, nothing cut off, for every verdict."""

import pytest

from doormill_ros.diagnosis.core.words.wording import MICRO, micrometres, spoken, with_deviation
from doormill_ros.robot_model.elastic.causes.registry import build_cause
from doormill_ros.tools.diagnose import main
from support.browser import open_page

BACKLASH = {"cause": "joint_backlash", "where": "joint 1", "parameters": {"gap": 8e-5, "crossing": 20.0}}
RIPPLE = {"cause": "joint_ripple", "where": "joint 2", "parameters": {"amplitude": 3e-7, "order": 5}}
SETS = {
    "explained": ([BACKLASH], "Explained: backlash in joint 1 ("),
    "consistent": ([], "Consistent: the simulation is off by"),
    "unexplained": ([RIPPLE], "Unexplained: the simulation is off by"),
}
THESIS = (
    "Partly explained: friction in joint 3, stiffness in joint 3 or stiffness in joint 2; five lengths cannot"
)
#: Texts that stick out of the picture they belong to, with half a pixel for rounding.
OVERFLOWS = """() => [...document.querySelectorAll('svg text')].filter(t => {
    const a = t.getBoundingClientRect(), b = t.ownerSVGElement.getBoundingClientRect();
    return a.left < b.left - 0.5 || a.right > b.right + 0.5 || a.top < b.top - 0.5 || a.bottom > b.bottom + 0.5;
}).map(t => t.textContent)"""


@pytest.fixture
def pages(make_set, tmp_path):
    found = {}
    for seed, (verdict, (effects, _)) in enumerate(SETS.items()):
        data = make_set(effects, seed=70 + seed, trials=120, postures=20)
        assert main(["--data", str(data.path), "--out", str(tmp_path / verdict), "--quiet"]) == 0
        found[verdict] = (tmp_path / verdict / "report.html").as_uri()
    assert main(["--thesis", "--out", str(tmp_path / "thesis"), "--quiet"]) == 0
    found["thesis"] = (tmp_path / "thesis" / "report.html").as_uri()
    return found


def test_every_verdict_in_a_browser(pages):
    first = next(iter(pages.values()))
    with open_page(first, viewport={"width": 1280, "height": 900}) as (page, errors):
        requests = []
        page.on("request", lambda request: requests.append(request.url))
        for verdict, address in pages.items():
            page.goto(address)
            lines = page.inner_text("body").splitlines()
            assert lines[0].startswith(THESIS if verdict == "thesis" else SETS[verdict][1])
            assert page.title() == lines[0]
            top = page.locator("h1").bounding_box()
            assert top["y"] < 100
            assert page.evaluate(OVERFLOWS) == []
            assert page.evaluate("document.documentElement.scrollWidth <= window.innerWidth")
            drawn = page.locator("svg").evaluate_all("all => all.map(s => s.getBoundingClientRect().height)")
            assert min(drawn) > 60
            if verdict == "thesis":
                assert len(drawn) == 2
                continue
            assert len(drawn) >= 14
            titles = page.locator("h2").all_inner_texts()
            assert ("The pattern that gave it away" in titles) == (verdict == "explained")
            assert page.locator("table.models tr").nth(1).get_attribute("class") == "own"
        assert errors == []
        assert set(requests) == set(pages.values())


def test_figures_show_no_more_digits_than_are_known():
    assert with_deviation([5.664e-5], [7.9e-7], "rad") == f"(56.64 ± 0.79) {MICRO}rad"
    assert with_deviation([1.8834e6], [2.1e4], "N m / rad") == "(1.883 ± 0.021) × 10⁶ N m / rad"
    assert with_deviation([95.2], [36.7], "N m") == "(95 ± 37) N m"
    assert with_deviation([0.83442], [0.00176], "1") == "0.8344 ± 0.0018"
    assert with_deviation([1e-7, -2e-7], [1e-9, 2e-9], "m / s") == "((100.0, -200.0) ± (1.0, 2.0)) nm / s"
    assert with_deviation([0.0], [0.0], "rad").endswith("rad")
    assert micrometres(8.04e-6) == f"8.0 {MICRO}m"
    assert micrometres(3.216e-4) == f"322 {MICRO}m"


def test_causes_are_spoken_with_their_place():
    for name, where, words in (
        ("joint_backlash", "joint 1", "backlash in joint 1"),
        ("link_bending", "link 2", "bending in link 2"),
        ("tracker_scale", "tracker", "tracker scale"),
        ("reflector_position", "tip", "position of reflector tip"),
        ("wrench_gain", "sensor", "sensor gain"),
    ):
        assert spoken(build_cause(name, where)) == words
