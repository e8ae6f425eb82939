"""A handful of trials names no cause: some number of the library fits any of them."""

import pytest

from doormill_ros.diagnosis.loading.kind import LoadingTests
from doormill_ros.diagnosis.loading.problem import FEWEST
from doormill_ros.measurements.sets.measurement_set import read_measurement_set
from support.source_tree import ROOT

EXAMPLE = ROOT / "docs" / "diagnosis_example"
QUIET = lambda line: None  # noqa: E731


@pytest.mark.parametrize("count", range(1, FEWEST))
def test_few_trials_are_told_to_be_few(tmp_path, count):
    (tmp_path / "set.yaml").write_bytes((EXAMPLE / "set.yaml").read_bytes())
    rows = (EXAMPLE / "trials.csv").read_text().splitlines()[: count + 1]
    (tmp_path / "trials.csv").write_text("\n".join(rows) + "\n")
    kind, sets = LoadingTests(), [read_measurement_set(tmp_path)]
    diagnosis = kind.diagnose(sets, QUIET)
    assert diagnosis.verdict in ("consistent", "unexplained")
    assert not diagnosis.findings
    assert f"fewer than {FEWEST} trials, and there are {count}" in " ".join(diagnosis.remarks)
    assert kind.account(diagnosis, sets, [], QUIET).verdict == diagnosis.verdict
