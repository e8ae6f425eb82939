"""The thesis' own loading tests, questioned: figures by hand, and tests held out from the fit."""

import json

import numpy as np
import pytest

from doormill_ros.robot_model.extended_model import load_compliance_model
from doormill_ros.thesis.diagnosis import DECIDABLE, diagnose_thesis
from doormill_ros.thesis.loading_tests import load_thesis_data
from doormill_ros.thesis.preload import read_preload_test
from doormill_ros.tools.diagnose import main


@pytest.fixture(scope="module")
def data():
    return load_thesis_data()


@pytest.fixture(scope="module")
def found(data):
    return diagnose_thesis(data)


def test_gap_of_joint_1_by_hand(data):
    # A.8: Fy = -126.213 sin(a) - 122.843 cos(a), a = atan2(219.25, 226.66); arm 1.842 m, radius hypot(120, 480) mm.
    a = np.arctan2(219.25, 226.66)
    torque = abs(-126.2130 * np.sin(a) - 122.8430 * np.cos(a)) * 1.842
    reference = 65.7e-6 / np.hypot(0.120, 0.480)  # rad, the angle of the test that 1.0 stands for
    closed = reference / np.array([1.0, 1.015, 1.125])
    opened = reference / np.array([0.758, 0.713])
    gap = read_preload_test(data)
    assert gap.torque == pytest.approx(torque, rel=1e-6)
    assert gap.gap == pytest.approx(opened.mean() - closed.mean(), rel=1e-6)
    # Two means of a pooled scatter with three degrees of freedom.
    pooled = np.sqrt((closed.var() * 3 + opened.var() * 2) / 3 * (1 / 3 + 1 / 2))
    assert gap.gap_std == pytest.approx(pooled, rel=1e-6)
    assert gap.gap_ci95[0] == pytest.approx(gap.gap - 3.182 * pooled, rel=1e-3)
    assert gap.gap_ci95[0] > 0.0, "four readings are enough to say that there is something"


def test_both_readings_of_table_4_3_give_the_same_two_angles(data):
    """A gap in a stiff joint and friction in a soft one: one load cannot tell them apart."""
    gap = read_preload_test(data)
    opened = gap.torque / gap.stiffness_if_friction
    assert (gap.torque - gap.friction) / gap.stiffness_if_friction == pytest.approx(opened - gap.gap)


def test_the_simulation_of_test_3_is_joint_3_alone_and_lacks_joint_2(found):
    row = found.rows[2]
    assert row.own_joint == pytest.approx(row.simulated, rel=0.02)
    assert row.all_joints > 1.1 * row.measured > row.simulated
    assert "joint 2" in row.left_out


def test_the_cause_brings_tests_3_and_5_together_also_when_held_out(found):
    for joint in (3, 5):
        row = found.rows[joint - 1]
        thesis, springs = abs(row.simulated - row.measured), abs(row.all_joints - row.measured)
        assert abs(row.held_out - row.measured) < 0.75 * springs < thesis
    assert found.misfit[1] < 0.1 * found.misfit[0]


def test_friction_is_one_torque_for_all_tests(found):
    """Figures of a program of its own, written from table 2.1 alone."""
    by_key = {c.cause.key: c for c in found.candidates}
    assert list(by_key) == [
        ("joint_friction", "joint 3"),
        ("joint_stiffness", "joint 3"),
        ("joint_stiffness", "joint 2"),
    ]
    for key, value, misfit in (
        (("joint_friction", "joint 3"), 54.3, 0.40),
        (("joint_stiffness", "joint 3"), 2.08e6, 1.53),
        (("joint_stiffness", "joint 2"), 2.66e6, 4.92),
    ):
        assert by_key[key].value == pytest.approx(value, rel=2e-3)
        assert by_key[key].misfit == pytest.approx(misfit, abs=6e-3)
    assert found.next_misfit == pytest.approx(6.52, abs=6e-3), "friction of joint 2, just too far behind"
    assert found.joint_3_plain == pytest.approx(0.956, abs=6e-4)
    assert found.joint_3[1] == pytest.approx(0.852, abs=6e-4)


def test_what_the_printed_data_cannot_decide_is_said(found):
    names = {(c.name, c.where) for c in [found.cause, *found.confusable]}
    assert {("joint_stiffness", "joint 3"), ("joint_friction", "joint 3")} <= names
    assert "cannot be decided" in found.rows[3].left_out
    low, high = found.test_6_range
    assert low < found.rows[5].measured < high
    assert 6 not in DECIDABLE
    assert np.isnan(found.rows[5].held_out)


def test_the_tool_writes_page_figures_and_model(found, tmp_path, capsys):
    assert main(["--thesis", "--out", str(tmp_path), "--quiet"]) == 0
    assert capsys.readouterr().out.startswith(
        "partly_explained: joint_friction at joint 3 (54.3 N m) or joint_stiffness at joint 3 "
    )
    document = json.loads((tmp_path / "diagnosis.json").read_text())
    assert [row["joint"] for row in document["table_4_2"]] == [1, 2, 3, 4, 5, 6]
    # The deviations that the thesis states for joints 3 to 6.
    off = [round(100 * abs(row["simulated"] / row["measured"] - 1)) for row in document["table_4_2"][2:]]
    assert off == [35, 24, 21, 13]
    assert document["table_4_2"][5]["held_out"] is None
    page = (tmp_path / "report.html").read_text()
    for row in found.rows:
        assert row.left_out in page
    model = load_compliance_model(tmp_path)
    q, wrench = np.zeros((1, 6)), np.array([[0.0, 0.0, -300.0, 0.0, 0.0, 0.0]])
    plain = load_compliance_model("irb6600_175_255").deflection(q, wrench, np.zeros(3))
    np.testing.assert_allclose(
        model.deflection(q, wrench, np.zeros(3)), plain, rtol=5e-3, err_msg="unchanged springs"
    )
    assert model.causes == ()
    assert document["model_unchanged"] == found.unchanged
    assert "five printed lengths cannot tell" in found.unchanged
    assert found.unchanged in (tmp_path / "model.yaml").read_text().replace("\n  ", " ")
    assert found.unchanged in page
    figures = f"{found.joint_3_plain:.3f}", f"{found.joint_3[1]:.3f}"
    assert figures == ("0.956", "0.852")
    assert all(figure in page for figure in figures)
    [margin] = document["margins"]
    assert margin["value"] == pytest.approx(6.12, abs=0.01)
    assert margin["threshold"] == 6.0


def test_thesis_and_data_exclude_each_other(tmp_path, capsys):
    with pytest.raises(SystemExit) as stop:
        main(["--thesis", "--data", str(tmp_path), "--out", str(tmp_path)])
    assert stop.value.code == 2
    assert "not allowed with" in capsys.readouterr().err
