"""Tables of the measured UR10 say what diagnosis.json and the repeated runs have."""

from __future__ import annotations

import numpy as np
import pytest

from bench import ur10_tables
from bench.ur10_tables import Redone

WAVES = {f"order_{order}": {"value": size, "std": 1e-7, "unit": "rad"} for order, size in (
    (2, 3e-4), (3, 4e-4), (5, 1e-5), (7, 2e-5), (9, 5e-6), (128, 1.2e-5), (130, 9e-6)
)}  # fmt: skip
SAG = {"compliance": {"value": 9.06e-6, "std": 2.9e-7, "unit": "rad / (N m)"}}
LINK = {
    "theta": {"value": -3.72e-4, "std": 1e-6, "unit": "rad"},
    "a": {"value": -3e-6, "std": 1e-6, "unit": "m"},
}


def cells(text: str) -> list[list[str]]:
    return [line.strip("|").split("|") for line in text.replace(" ", "").splitlines() if line.startswith("|")]


def test_errors_are_lengths_over_all_rows() -> None:
    parts = [np.array([[3.0, 4.0, 0.0]]), np.array([[0.0, 0.0, 1.0], [2.0, 0.0, 0.0]])]
    assert ur10_tables.rms(parts) == pytest.approx(np.sqrt(30.0 / 3.0))


def test_repeated_runs_are_counted_and_pooled_over_the_rows_of_a_series() -> None:
    one = {"holdout_rmse": 9e-4, "train_rmse": 7e-5, "series_out_rmse": 2e-4}
    document = {
        "sets": [{"set": name, "baseline": one, "extended": one} for name in "ab"],
        "baseline": one,
        "extended": one,
        "outliers_by_set": {"b": [7, 9]},
    }
    errors = {"a": np.full((3, 3), 1e-4 / np.sqrt(3.0)), "b": np.full((1, 3), 3e-4 / np.sqrt(3.0))}
    text = ur10_tables.errors(document, *(Redone([], errors) for _ in range(3)))
    assert [row[4] for row in cells(text)[2:]] == ["100", "300", f"{1e2 * np.sqrt(12.0 / 4.0):.0f}"]
    assert text.endswith("rows `b` 7, 9.")


def test_what_some_repeated_runs_name_is_told_apart() -> None:
    sag, play = ("joint_sag", "joint 2"), ("joint_backlash", "joint 1")
    blocks, series = Redone([{sag}, {sag, play}]), Redone([set(), {sag}, {play}])
    entry = {"cause": sag[0], "where": sag[1], "parameters": SAG, "holdout_rmse_without": 8.8e-5}
    gross = {"cause": "gross_error", "where": "set a"}
    text = ur10_tables.causes({"causes": [entry, gross]}, blocks, series)
    (row,) = cells(text)[2:]
    assert row == ["joint_sag", "joint2", "compliance9.1±0.3urad/(Nm)", "88", "2of2,1of3"]
    assert text.endswith("only: joint_backlash joint 1 1 of 2, 1 of 3.")


def test_sizes_have_the_units_of_the_page() -> None:
    assert ur10_tables.size({"cause": "link_geometry", "parameters": LINK}) == "theta -0.37 mrad, a 0.00 mm"
    text = ur10_tables.size({"cause": "joint_periodic_error", "parameters": WAVES})
    whole = 1e6 * np.sqrt(0.5 * sum(one["value"] ** 2 for one in WAVES.values()))
    largest = "order 3 400, order 2 300, order 7 20, order 128 12"
    assert text == f"{whole:.0f} urad rms; largest: {largest}; lines: order 128 12"


def test_ranges_that_were_never_visited_are_those_between_the_others() -> None:
    deg = np.pi / 180.0
    seen = [[-180 * deg, 10 * deg], [15 * deg, 20 * deg], [170 * deg, 180 * deg]]
    document = {"coverage": [{"joint": 2, "ranges": seen}, {"joint": 3, "ranges": [[-np.pi, np.pi]]}]}
    outside = {"a": {"joint 2": 0.5, "joint 3": 0.0}, "b": {"joint 2": 0.001, "joint 3": 0.0}}
    rows = cells(ur10_tables.unvisited(document, outside, 72))[2:]
    assert rows == [["joint2", "20to170", "a50%"], ["joint3", "none", "none"]]
