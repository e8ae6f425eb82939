"""What is told of a cause beside laws is what the fit of both says, and as sure as that."""

import numpy as np
import pytest
import yaml

from doormill_ros.diagnosis.core.fitting.fit import fit
from doormill_ros.diagnosis.core.kind import run as run_kind
from doormill_ros.diagnosis.law.linear import LinearProblem, established
from doormill_ros.diagnosis.law.numbers import numbers_beside
from doormill_ros.diagnosis.motion.kind import Motions
from doormill_ros.robot_model.candidate import Candidate
from support.motion_world import STIFFNESS, Recording, hide, record

ROWS, SIGMA = 400, 2e-5
TRUTH, LAW = np.array([3e-4, -2e-4]), 4e-4


class Law(Candidate):
    """A column that half follows the first of the causes."""

    name = "law"

    def __init__(self, column):
        super().__init__("here")
        self.column = column
        self.scale, self.lower, self.upper = (np.full(1, v) for v in (1.0, -np.inf, np.inf))

    def effect(self, case):
        return self.column[:, None, None]


@pytest.mark.parametrize("alike", [1, 20])
def test_values_are_true_and_deviations_those_of_repeated_measurements(alike):
    """`alike` neighbours in a block err as one: the fit takes them for independent, their scatter does not."""
    rng = np.random.default_rng(4)
    causes = np.repeat(rng.normal(size=(ROWS // alike, 2)), alike, axis=0)
    law = Law(0.5 * causes[:, 0] + np.repeat(rng.normal(size=ROWS // alike), alike))
    base = established(causes[:, None, :], np.array([SIGMA]), np.full(2, np.inf))
    values, stds = [], []
    for _ in range(150):
        noise = np.repeat(rng.normal(0.0, SIGMA, ROWS // alike), alike)
        target = (causes @ TRUTH + LAW * law.column + noise)[:, None]
        block = np.arange(ROWS) // 20
        problem = LinearProblem(target, np.array([SIGMA]), None, block, SIGMA)
        value, std = numbers_beside(problem, fit(problem, (base, law)))
        values.append(value)
        stds.append(std)
    spread = np.std(values, axis=0)
    assert np.all(np.abs(np.mean(values, axis=0) - TRUTH) < 4.0 * spread / np.sqrt(len(values)))
    assert np.all(np.abs(np.mean(stds, axis=0) / spread - 1.0) < 0.25)


def test_what_no_row_speaks_of_is_as_unsure_as_it_was():
    rng = np.random.default_rng(5)
    seen, law = rng.normal(size=ROWS), Law(rng.normal(size=ROWS))
    reach = np.array([1e-3, 3e-4])
    columns = np.column_stack([seen, 1e-6 * rng.normal(size=ROWS)])[:, None, :]
    base = established(columns, np.array([SIGMA]), reach)
    target = (2e-4 * seen + LAW * law.column + rng.normal(0.0, SIGMA, ROWS))[:, None]
    problem = LinearProblem(target, np.array([SIGMA]), None, np.arange(ROWS) // 20, SIGMA)
    value, std = numbers_beside(problem, fit(problem, (base, law)))
    assert abs(value[0] - 2e-4) < 4.0 * std[0]
    assert 0.5 * SIGMA / np.sqrt(ROWS) < std[0] < 2.5 * SIGMA / np.sqrt(ROWS)
    assert value[1] == pytest.approx(0.0, abs=1e-9)
    assert std[1] == pytest.approx(reach[1], rel=1e-3)


def test_a_spring_beside_a_law_is_told_as_the_model_has_it(tmp_path):
    """A spring of another stiffness than published, and a link encoder that drifts."""
    rng, hidden = np.random.default_rng([32, 5]), Recording()
    for effect, size in (("joint_stiffness", 9.0), ("warming", 4.0)):
        hidden, _, _ = hide(rng, hidden, effect, 2, size)
    folder = record(tmp_path / "set", hidden, 32)
    run_kind(Motions(), [folder], [], tmp_path / "out")
    document = yaml.safe_load((tmp_path / "out" / "diagnosis.json").read_text(encoding="utf-8"))
    model = yaml.safe_load((tmp_path / "out" / "model.yaml").read_text(encoding="utf-8"))
    (cause,) = document["causes"]
    assert (cause["cause"], cause["where"]) == ("joint_stiffness", "joint 2")
    ((joint, entry),) = [(one, entry) for one in model["joints"] for entry in one["causes"]]
    assert joint["laws"]
    told = cause["parameters"]["stiffness"]
    softer = 1.0 / (1.0 / joint["stiffness"] + entry["coefficients"][0])
    assert told["value"] == pytest.approx(softer, rel=1e-9)
    assert (
        abs(told["value"] - hidden.gears[1].stiffness * STIFFNESS[1])
        < 4.0 * told["std"]
        < 0.1 * told["value"]
    )
