"""Gross errors do not bend the fit, and good data lose nothing."""

from __future__ import annotations

import dataclasses
import json

import numpy as np
import pytest

from doormill_ros.identification.outliers import fit_without_outliers
from doormill_ros.identification.weighted import fit_stiffness
from doormill_ros.measurements.loading import loadings_of_set
from doormill_ros.measurements.sets.measurement_set import read_measurement_set
from doormill_ros.tools.identify import main

TRUE = np.array([3.1e6, 1.7e6, 2.2e6, 2.6e5, 1.6e5, 6.1e4])


def data_of(kinematics, truth):
    return loadings_of_set(kinematics, read_measurement_set(truth.folder))


def spoiled(data, rows, seed, size=3e-3):
    displacement = data.displacement.copy()
    displacement[rows] += np.random.default_rng(seed).normal(scale=size, size=(len(rows), 3))
    return dataclasses.replace(data, displacement=displacement)


@pytest.mark.parametrize("seed", range(4))
def test_gross_errors_are_found_and_left_out(kinematics, make_set, seed):
    data = data_of(kinematics, make_set(TRUE, n=80, seed=seed))
    rows = np.random.default_rng(seed).choice(80, size=8, replace=False)  # one in ten
    bad = spoiled(data, rows, seed)
    robust = fit_without_outliers(kinematics, bad)
    assert set(robust.outliers) == set(rows)
    clean = fit_stiffness(kinematics, data.pick(np.setdiff1d(np.arange(80), rows)))
    assert robust.fit.stiffness == pytest.approx(clean.stiffness, rel=1e-9)
    # Plain least squares would have been far off.
    assert np.nanmax(np.abs(fit_stiffness(kinematics, bad).stiffness / TRUE - 1)) > 0.1


def test_good_sets_keep_their_trials(kinematics, make_set):
    for seed in range(6):
        robust = fit_without_outliers(kinematics, data_of(kinematics, make_set(TRUE, seed=seed)))
        assert robust.outliers.size == 0
        assert np.array_equal(robust.kept, np.arange(60))


def test_structure_is_not_taken_for_gross_error(kinematics, make_set):
    """Noise ten times as large as declared: nothing stands out, nothing goes."""
    data = data_of(kinematics, make_set(TRUE, seed=2, noise=(8e-5, 0.3, 0.03)))
    data = dataclasses.replace(data, displacement_std=data.displacement_std / 10)
    assert fit_without_outliers(kinematics, data).outliers.size == 0


def test_tool_names_the_trials(tmp_path, make_set, capsys):
    truth = make_set(TRUE, n=80, seed=1)
    path = truth.folder / "trials.csv"
    lines = path.read_text().splitlines()
    cells = lines[18].split(",")
    cells[-1] = repr(float(cells[-1]) + 0.004)
    lines[18] = ",".join(cells)
    path.write_text("\n".join(lines) + "\n")
    assert main(["--data", str(truth.folder), "--out", str(tmp_path / "out")]) == 0
    assert f"gross errors, worst first: trials {cells[0]}\n" in capsys.readouterr().out
    document = json.loads((tmp_path / "out" / "identification.json").read_text())
    assert document["outliers"] == [int(cells[0])]
    pulls = (np.array(document["stiffness"]) - TRUE) / np.array(document["std"])
    assert np.abs(pulls).max() < 4.5
