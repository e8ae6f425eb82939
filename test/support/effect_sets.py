"""Sets from the simulated lab, and the scoring campaign of the bench."""

import importlib.util
import sys
from pathlib import Path

import numpy as np
import pytest

from doormill_ros.measurements.sets.measurement_set import read_measurement_set
from doormill_ros.robot.description import load_robot
from support.truth.loading_test import Spoil, draw_plan, write_loading_test


@pytest.fixture(scope="session")
def dh():
    return np.array(load_robot("irb6600_175_255").dh)


@pytest.fixture
def make_set(tmp_path, dh):
    """Writes and reads a set: make_set(effects, seed=.., trials=.., postures=.., style=.., spoil=..)."""

    def make(effects=(), seed=0, trials=60, postures=10, style=0, spoil=None, change=lambda plan: plan):
        rng = np.random.default_rng(seed)
        plan = change(draw_plan(rng, dh, trials, postures, style))
        folder = tmp_path / f"set{seed}"
        bad = write_loading_test(folder, plan, list(effects), rng, spoil or Spoil())
        data = read_measurement_set(folder)
        object.__setattr__(data, "gross", bad)
        return data

    return make


@pytest.fixture(scope="session")
def score():
    """The module that scores the diagnosis on hidden effects."""
    path = Path(__file__).resolve().parents[2] / "bench" / "diagnosis_score.py"
    spec = importlib.util.spec_from_file_location("diagnosis_score", path)
    module = importlib.util.module_from_spec(spec)
    sys.modules["diagnosis_score"] = module
    spec.loader.exec_module(module)
    return module
