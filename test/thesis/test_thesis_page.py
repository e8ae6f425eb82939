"""docs/thesis.md says what the code computes."""

from __future__ import annotations

import re

import pytest

from doormill_ros.recipes.cutting import Cutting
from doormill_ros.thesis.comparison import compare_with_simulation
from doormill_ros.thesis.fit import fit_thesis, overall_std
from doormill_ros.thesis.loading_tests import load_thesis_data
from doormill_ros.thesis.outcome import find_contradictions
from doormill_ros.thesis.recovery import recover
from doormill_ros.units import MM, RPM
from support.source_tree import ROOT
from support.thesis_milling import INCH, SURFACE_FOOT_PER_MINUTE, THESIS_MILL, THESIS_SURFACE_SPEED


@pytest.fixture(scope="module")
def page():
    return (ROOT / "docs" / "thesis.md").read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def computed():
    data = load_thesis_data()
    recovery = recover(data)
    return data, recovery, fit_thesis(data)


def row(page: str, section: str, first: str) -> list[str]:
    """Cells of the row that starts with `first` in a section."""
    body = page.split(f"## {section}", 1)[1].split("\n## ", 1)[0]
    for line in body.splitlines():
        cells = [cell.strip() for cell in line.strip().strip("|").split("|")]
        if cells[0] == first:
            return cells
    raise AssertionError(f"no row {first!r} under {section}")


def numbers(cell: str) -> list[float]:
    return [float(n) for n in re.findall(r"-?\d+\.?\d*(?:e-?\d+)?", cell)]


def test_stiffness_table(page, computed):
    _, recovery, fit = computed
    std = overall_std(recovery, fit)
    for joint in range(6):
        cells = row(page, "Joint stiffness", str(joint + 1))
        assert numbers(cells[2])[0] == pytest.approx(recovery.stiffness[joint], rel=2e-4)
        rounding = recovery.printing_std[joint] / recovery.stiffness[joint]
        assert numbers(cells[3])[0] / 100 == pytest.approx(rounding, abs=6e-5)
        assert numbers(cells[4])[0] == pytest.approx(fit.stiffness[joint], rel=1e-3)
        assert numbers(cells[5])[0] / 100 == pytest.approx(std[joint] / recovery.stiffness[joint], rel=0.04)
    assert f"Chi-square is {fit.chi_square:.0f} with" in page
    assert f"{recovery.ratio_2_to_1:.4f} +- {recovery.ratio_2_to_1_std:.4f}" in page


def test_comparison_table(page, computed):
    data, recovery, fit = computed
    section = "Simulation against measurement (table 4.2)"
    for side, suffix in ((1, "load's side"), (-1, "other side")):
        rows = compare_with_simulation(data, recovery, overall_std(recovery, fit), side)
        assert [r.joint for r in rows] == [1, 2, 3, 4, 5, 6]
        for r in rows:
            first = str(r.joint) if r.joint < 6 else f"6, reflector on the {suffix}"
            cells = row(page, section, first)
            assert numbers(cells[1])[0] == pytest.approx(r.measured * 1e6, abs=0.051)
            assert numbers(cells[2])[0] == pytest.approx(r.simulated * 1e6, abs=0.051)
            assert numbers(cells[3])[0] == pytest.approx(r.own_joint * 1e6, abs=0.051)
            assert numbers(cells[4])[0] == pytest.approx(r.predicted * 1e6, abs=0.51)
            assert cells[5] == f"{'+'.join(map(str, r.nearest_joints))}: {r.nearest * 1e6:.1f}"


def test_contradictions_table(page, computed):
    """Every contradiction's leading numbers stand in the page."""
    data, recovery, _ = computed
    n = {c.name: c.numbers for c in find_contradictions(data, recovery)}
    section = page.split("## Printed figures", 1)[1].split("\n## ", 1)[0]
    um = 1e6
    for text in (
        f"{n['stiffness and displacement of test 3']['predicted'] * um:.1f} um predicted",
        f"follows from {n['measured displacement of test 6']['corrected_length'] * um:.1f} um",
        f"ratio {n['measured displacement of test 6']['ratio_from_table_4_2']:.4f}",
        f"{n['measured displacement of test 6']['corrected_deviation'] * um:.1f} um deviation",
        f"{n['torque of joint 1 in test 6']['torque_script']:.1f} N m instead of "
        f"{n['torque of joint 1 in test 6']['torque']:+.1f}",
        f"joint 5 adds {n['joints that give way in test 6']['joint_5'] * um:.0f} um",
        f"{n['displacement taken off in test 3']['difference'] * um:.1f} um off",
        f"{n['angle of test 5']['share_of_joint_3']:.3f} of joint 3's rotation",
        f"takes off {n['angle taken off in test 4']['alpha'] * um:.0f} urad",
        f"{n['lengths of the first link']['printed']:.3f} m/rad instead of "
        f"{n['lengths of the first link']['table_2_1']:.3f}",
        ", ".join(f"{n['arm of the load in tests 1, 5 and 6'][f'arm_{k}'] * 1e3:.0f}" for k in (1, 5))
        + " and 45 mm",
        f"sensor reads {n['load of test 2']['force_3']:.1f} and {n['load of test 2']['force_5']:.1f} N hanging",
    ):
        assert text in section


def test_milling_table(page):
    for name, rpm, feed in (("initial", 5025, 80), ("final", 3200, 50)):
        cutting = Cutting(spindle_speed=rpm * RPM, feed=feed * MM)
        sfm = f"{cutting.spindle(THESIS_MILL) * THESIS_MILL.radius / SURFACE_FOOT_PER_MINUTE:.0f} SFM"
        assert sfm in row(page, "Milling", f"{name} setting, surface speed")[2]
        inch = f"{cutting.chip(THESIS_MILL) / INCH:.4f} inch"
        assert inch in row(page, "Milling", f"{name} setting, chip load")[2]
    low, high = (
        Cutting(surface_speed=speed, chip_load=1e-3).spindle(THESIS_MILL) / RPM
        for speed in THESIS_SURFACE_SPEED
    )
    assert f"{low:.0f} to {high:.0f} rpm" in page
