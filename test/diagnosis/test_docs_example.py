"""The worked example of docs/diagnosis.md says what the tool says."""

import json
import re
from pathlib import Path

import pytest

from doormill_ros.thesis.diagnosis import diagnose_thesis
from doormill_ros.thesis.loading_tests import load_thesis_data
from doormill_ros.thesis.preload import read_preload_test
from doormill_ros.tools.diagnose import main

DOCS = Path(__file__).resolve().parents[2] / "docs"


def text(name):
    return " ".join((DOCS / name).read_text().replace("\n>", " ").split())


@pytest.fixture(scope="module")
def page():
    return text("diagnosis.md")


def test_the_example_gives_the_line_and_the_figures_on_the_page(page, tmp_path, capsys):
    assert main(["--data", str(DOCS / "diagnosis_example"), "--out", str(tmp_path), "--quiet"]) == 0
    said = capsys.readouterr().out.strip()
    assert said in page
    before, after, noise = re.findall(r"\d+\.\d", said)
    assert f"*{before} um*: the simulation's error now. *{after} um*: the extended model's" in page
    assert f"The noise is {noise} um: nothing is left" in page
    document = json.loads((tmp_path / "diagnosis.json").read_text())
    gap, crossing = (document["causes"][0]["parameters"][name] for name in ("gap", "crossing"))
    assert f"Gap ({1e5 * gap['value']:.2f} +- {1e5 * gap['std']:.2f}) x 1e-5 rad" in page
    assert f"Crossing torque {crossing['value']:.0f} +- {crossing['std']:.0f} N m" in page
    away = abs(crossing["value"] - 30.0) / crossing["std"]
    assert f"Its true value, 30, is {away:.1f} standard deviations away" in page
    outliers = "{}, {}, {} and {}".format(*document["outliers"])
    assert f"four gross errors (trials {outliers})" in page
    assert f"the outliers are trials {outliers}." in page
    # What is hidden in the example, as the page tells.
    assert abs(gap["value"] - 5.7e-5) < 2 * gap["std"]
    assert abs(crossing["value"] - 30.0) < 2 * crossing["std"]


def test_the_thesis_table_is_what_the_code_gives():
    page = text("diagnosis-thesis.md")
    data = load_thesis_data()
    found = diagnose_thesis(data)
    for row in found.rows[2:5]:
        figures = (row.measured, row.simulated, row.own_joint, row.all_joints, row.extended, row.held_out)
        assert f"| {row.joint} | " + " | ".join(f"{1e6 * v:.1f}" for v in figures) + " |" in page
    low, high = found.test_6_range
    assert f"{1e6 * low:.0f} or {1e6 * high:.0f}" in page
    friction, stiff_3, stiff_2 = found.candidates
    assert (
        f"friction in joint 3, {friction.value:.1f} +- {friction.std:.0f} N m | {friction.misfit:.2f}" in page
    )
    for name, one in (("joint 3", stiff_3), ("joint 2", stiff_2)):
        size = f"({1e-6 * one.value:.2f} +- {1e-6 * one.std:.2f}) x 1e6 N m/rad"
        assert f"stiffness of {name}, {size} | {one.misfit:.2f}" in page
    for name in ("diagnosis-thesis.md", "thesis.md"):
        for ratio in (found.joint_3_plain, found.joint_3[0], found.joint_3[1]):
            assert f"{ratio:.3f}" in text(name)
    gap = read_preload_test(data)
    assert f"({1e5 * gap.gap:.1f} +- {1e5 * gap.gap_std:.1f}) x 1e-5 rad" in page
    assert f"{1e5 * gap.gap_ci95[0]:.1f} to {1e5 * gap.gap_ci95[1]:.1f}" in page
    assert f"{gap.friction:.0f} +- {gap.friction_std:.0f} N m" in page
    closed = gap.torque / (gap.torque / gap.stiffness_if_friction - gap.gap)
    assert f"{1e-6 * closed:.2f}e6 N m/rad by the first reading" in page
    assert f"{1e-6 * gap.stiffness_if_friction:.2f}e6 by the second" in page


def test_the_page_is_two_pages_long(page):
    assert len(re.findall(r"\S+", page)) < 1500
