"""Process wrenches from force logs: rotation, weight, segments; table 4.8 as the round trip."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
import yaml
from scipy.spatial.transform import Rotation

from doormill_ros.frames import shift_wrench
from doormill_ros.identification.errors import PayloadError, SegmentError
from doormill_ros.identification.payload import Payload, identify_payload
from doormill_ros.identification.process_forces import (
    lever_arm,
    process_wrench,
    segment_forces,
)
from doormill_ros.measurements.raw.raw_files import Recording, read_force_log
from doormill_ros.recipes.force_origin import ForceAxes
from support.source_tree import DATA
from support.thesis_milling import THESIS_FORCES

ANGLE = math.atan2(219.25, 226.66)
# Sensor axes in flange axes, written out here again so that the sign is checked against this file.
R_FS = np.array([[math.cos(ANGLE), -math.sin(ANGLE), 0], [math.sin(ANGLE), math.cos(ANGLE), 0], [0, 0, 1]])
G = 9.80665
MASS, CENTRE = 26.0, np.array([0.01, -0.02, 0.14])
OFFSET = np.array([3.0, -8.0, 15.0, 0.4, -0.2, 0.1])
# Spindle horizontal, along base x, as at a hinge (home orientation of A.2).
R_BF = np.array([[0.0, 0, 1], [0, 1, 0], [-1, 0, 0]])


def reading(wrench_flange, R_base_flange):
    """What the sensor shows: process wrench, weight and offset, all in sensor axes."""
    R_base_sensor = R_base_flange @ R_FS
    weight = R_base_sensor.T @ [0, 0, -MASS * G]
    process = np.concatenate([R_FS.T @ wrench_flange[:3], R_FS.T @ wrench_flange[3:]])
    return process + np.concatenate([weight, np.cross(CENTRE, weight)]) + OFFSET


def milling_log(path, seed=3):
    """Air cut, then the four segments of table 4.8, then air; 500 Hz; layout of A.16 with time in column 11."""
    rng = np.random.default_rng(seed)
    names = ["air", *THESIS_FORCES, "air"]
    spans, rows, t0 = {}, [], 0.0
    for i, (name, length) in enumerate(zip(names, (2.0, 1.0, 0.3, 1.0, 0.3, 1.0), strict=True)):
        t = t0 + np.arange(round(length * 500)) / 500
        mean = reading(np.array(THESIS_FORCES.get(name, np.zeros(6))), R_BF)
        chatter = np.sin(2 * np.pi * 107 * t)[:, None] * [15, 15, 15, 1.5, 1.5, 1.5]
        noise = rng.normal(scale=[5.0] * 3 + [0.5] * 3, size=(len(t), 6))
        rows.append(np.hstack([mean + chatter + noise, np.zeros((len(t), 4)), t[:, None] + 77.0]))
        if i < 5:
            spans[name] = (t0, t0 + length)
        t0 += length
    np.savetxt(path, np.vstack(rows), fmt="%.8g", delimiter=",")
    return read_force_log(path), spans


@pytest.fixture
def payload():
    return Payload(MASS, CENTRE, OFFSET)


def test_table_4_8_round_trip(tmp_path, payload):
    log, spans = milling_log(tmp_path / "log.csv")
    air = spans.pop("air")
    for options in ({"payload": payload, "R_base_flange": R_BF}, {"air": air}):
        forces = segment_forces(log, spans, **options)
        assert [f.name for f in forces] == list(THESIS_FORCES)
        for f in forces:
            error = np.abs(f.wrench - THESIS_FORCES[f.name])
            # The air window's own error adds to that of the segment.
            assert np.all(error < 5 * np.hypot(f.standard_error, np.array([0.5] * 3 + [0.05] * 3)))
            assert np.all(error < [4, 4, 4, 0.4, 0.4, 0.4])


def test_weight_left_in_is_the_spindles_weight(tmp_path):
    """Without removal the mean is off by 26 kg along flange x (down at a hinge): what figure 4.6 shows."""
    log, spans = milling_log(tmp_path / "log.csv")
    raw = {f.name: f.wrench for f in segment_forces(log, spans)}
    offset = np.concatenate([R_FS @ OFFSET[:3], R_FS @ OFFSET[3:]])
    assert raw["air"][:3] - offset[:3] == pytest.approx([MASS * G, 0, 0], abs=1.5)


def test_thesis_forces_are_the_reference_ones():
    facts = yaml.safe_load((DATA / "thesis" / "facts.yaml").read_text(encoding="utf-8"))
    table = facts["milling"]["forces_N_Nm"]
    assert {k: list(v) for k, v in THESIS_FORCES.items()} == table


def test_table_4_8_turns_its_direction(payload):
    """Section 3.8 says the forces keep their direction at the spindle head; the table's turn by 60 degrees."""
    f = {k: np.array(v[:3]) for k, v in THESIS_FORCES.items()}
    cosine = (
        f["left_line"] @ f["bottom_turn"] / np.linalg.norm(f["left_line"]) / np.linalg.norm(f["bottom_turn"])
    )
    assert math.degrees(math.acos(cosine)) > 60


def test_table_4_8_has_no_single_arm():
    """My = z Fx for a force along x at one point; rounding half a unit, the segments leave no common z."""
    bounds = {}
    for name, (fx, _, _, _, my, _) in THESIS_FORCES.items():
        corners = [(my + a) / (fx + b) for a in (-0.5, 0.5) for b in (-0.5, 0.5)]
        bounds[name] = (min(corners), max(corners))
    assert bounds["left_line"] == pytest.approx((0.203, 0.209), abs=0.001)
    assert bounds["right_line"] == pytest.approx((0.120, 0.138), abs=0.001)
    assert bounds["right_line"][1] < bounds["left_line"][0] < bounds["left_line"][1] < bounds["top_turn"][0]
    assert bounds["bottom_turn"][1] < 0


def test_neighbouring_segments_share_no_sample(tmp_path):
    path = tmp_path / "log.csv"
    path.write_text("\n".join(f"{i},{i},0,0,0,0,0" for i in range(20)))
    a, b = segment_forces(read_force_log(path), {"a": (0, 10), "b": (10, 20)}, rotation=0.0)
    assert (a.samples, b.samples) == (10, 10)
    assert (a.wrench[0], b.wrench[0]) == (4.5, 14.5)


def test_standard_error_covers_slow_swings():
    """Correlated noise: the error over the standard error has about unit variance."""
    rng = np.random.default_rng(5)
    ratios = []
    for _ in range(300):
        x = np.convolve(rng.normal(size=1100), np.ones(50) / 50, "valid")[:1000]
        log = Recording(Path("log.csv"), np.arange(1000) / 1000, np.repeat(x[:, None], 6, axis=1))
        f = segment_forces(log, {"a": (0.0, 2.0)}, rotation=0.0)[0]
        ratios.append(f.wrench[0] / f.standard_error[0])
    assert 0.7 < np.mean(np.square(ratios)) < 2.0
    assert f.standard_error[0] > 3 * f.std[0] / math.sqrt(1000)


@pytest.mark.parametrize(
    ("span", "problem"),
    [((5, 4), "0 <= start"), ((-1, 4), "0 <= start"), ((99, 100), "starts at 99"), ((0, 0.001), "1 samples")],
)
def test_bad_segments(tmp_path, span, problem):
    log, _ = milling_log(tmp_path / "log.csv")
    with pytest.raises(SegmentError, match=problem):
        segment_forces(log, {"x": span})


def test_payload_needs_an_orientation(payload):
    with pytest.raises(SegmentError, match="R_base_flange"):
        process_wrench(np.zeros((3, 6)), payload=payload)


def test_payload_round_trip():
    rng = np.random.default_rng(11)
    R = Rotation.random(12, rng=rng).as_matrix()
    readings = np.array([reading(np.zeros(6), r @ R_FS.T @ R_FS) for r in R])
    noisy = readings + rng.normal(scale=[0.3] * 3 + [0.03] * 3, size=readings.shape)
    found = identify_payload(noisy, R @ R_FS)
    assert found.mass == pytest.approx(MASS, abs=5 * 0.3 / G / math.sqrt(12))
    assert found.centre == pytest.approx(CENTRE, abs=5 * 0.03 / (MASS * G) / math.sqrt(8) + 1e-3)
    assert found.offset == pytest.approx(OFFSET, abs=0.6)
    exact = identify_payload(readings, R @ R_FS)
    assert exact.remove(readings, R @ R_FS) == pytest.approx(0, abs=1e-9)
    assert exact.centre == pytest.approx(CENTRE, abs=1e-9)


def test_payload_refusals():
    R = np.tile(np.eye(3), (5, 1, 1))
    same = np.array([reading(np.zeros(6), r) for r in R])
    with pytest.raises(PayloadError, match="too much alike"):
        identify_payload(same, R)
    with pytest.raises(PayloadError, match="at least three"):
        identify_payload(same[:2], R[:2])
    R = Rotation.random(6, rng=np.random.default_rng(1)).as_matrix()
    upside_down = np.array([-reading(np.zeros(6), r) for r in R])
    with pytest.raises(PayloadError, match="mass of -26"):
        identify_payload(upside_down, R @ R_FS)


TABLE_4_8 = np.array(list(THESIS_FORCES.values()))


def test_the_arm_behind_pure_forces_is_found():
    rng = np.random.default_rng(5)
    force = rng.normal(size=(10, 3)) * 100
    wrench = np.concatenate([force, np.cross([0, 0, 0.25], force)], axis=1)
    assert lever_arm(wrench) == pytest.approx(0.25, abs=1e-12)
    assert shift_wrench(wrench, np.array([0, 0, 0.25]))[:, 3:] == pytest.approx(np.zeros((10, 3)), abs=1e-12)


def test_table_4_8_is_read_a_hand_behind_the_tool_tip():
    """The strongest segment alone, -43 = a (-209), gives 0.206 m; all four together nearly the same."""
    arm = lever_arm(TABLE_4_8)
    assert arm == pytest.approx(43 / 209, abs=0.005)
    left = shift_wrench(TABLE_4_8, np.array([0.0, 0.0, arm]))[0]
    # What is left of 43 N m is what rounding to 1 N m can leave, and 1 % of the arm.
    assert np.abs(left[3:5]).max() < 1.1


def test_recipes_take_the_same_arm(cell_recipe):
    assert [feature.id for feature in cell_recipe.features] == ["hinge_1", "hinge_2"]
    for feature in cell_recipe.features:
        given_at = np.array([0.0, 0.0, feature.wrench_point])
        for name, row in zip(("left_line", "top_turn", "right_line", "bottom_turn"), TABLE_4_8, strict=True):
            at_tip = shift_wrench(row, given_at)
            if feature.force_origin.axes is ForceAxes.FEATURE:  # x right and y up are the tool's y and -x
                at_tip = at_tip[[1, 0, 2, 4, 3, 5]] * [-1, 1, 1, -1, 1, 1]
            assert feature.wrench(name) == pytest.approx(at_tip, abs=1e-9)
        assert feature.wrench_point == pytest.approx(lever_arm(TABLE_4_8), abs=5e-4)


@pytest.fixture
def cell_recipe():
    from doormill_ros.recipes.documents import load_recipe

    return load_recipe("thesis_190_0deg")
