"""What the page tells of decisions that were close: ties between causes, and margins of every decision."""

from __future__ import annotations

import json
import re

from doormill_ros.tools.diagnose import main


def test_ties_and_margins_stand_in_the_page(make_set, tmp_path) -> None:
    gain = {"cause": "tracker_scale", "where": "tracker", "parameters": {"factor": 1.1}}
    data = make_set([gain], seed=3, trials=60, postures=12)
    assert main(["--data", str(data.path), "--out", str(tmp_path), "--quiet"]) == 0
    document = json.loads((tmp_path / "diagnosis.json").read_text())
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    [cause] = document["causes"]
    assert [tied["cause"] for tied in cause["tied_with"]] == ["tracker_scale"]
    [ties] = re.findall(r"<h2>What cannot be told apart</h2>(.*?)</section>", page, flags=re.S)
    assert "<td>sensor gain</td>" in ties
    assert "<td>tracker scale</td>" in ties
    assert "<td>nothing: the two are tied</td>" in ties
    [margins] = re.findall(r"<h2>How close the decisions were</h2>(.*?)</section>", page, flags=re.S)
    rows = re.findall(
        r"<tr><td>(.*?)</td><td>(.*?)</td><td>(.*?)</td><td>(.*?)</td></tr>", margins.replace("\n", "")
    )
    assert len(rows) == len(document["margins"]) > 3
    assert [row[0] for row in rows] == [m["decision"].replace("_", " ") for m in document["margins"]]
    for row, margin in zip(rows, document["margins"], strict=True):
        assert abs(float(row[1]) - margin["value"]) <= 0.006 * abs(margin["value"])
        assert row[3] == margin["quantity"]
