"""`cell --doors 1 --world FILE --monitor`: the shift ends with a verdict, and with a model that nobody accepted."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from doormill_ros.cell.output.run_folder import ShiftFolder
from doormill_ros.measurements.inspections.inspection import inspections_in
from doormill_ros.models.store import ModelStore
from doormill_ros.monitor.runs_finding import few_runs
from doormill_ros.tools.cell import main

WORLD = "schema: doormill/world/1\nseed: 5\nforce: {factor: 1.3}\n"


def test_a_monitored_shift_ends_with_what_its_doors_say(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "world.yaml").write_text(WORLD)
    out = tmp_path / "out"
    shift = ["--door", "thesis_190_0deg", "--doors", "1", "--world", str(tmp_path / "world.yaml")]
    main([*shift, "--monitor", "--out", str(out)])
    said = capsys.readouterr().out
    assert "verdict     1 door, explained by process force at tool" in said
    assert f"bags        {few_runs(1).sentence}" in said
    assert "version 0 in use, 1 proposed" in said
    record = ModelStore(out / "models").record()
    assert (record.in_use, record.proposed, record.orders) == (0, 1, ())
    (kept,) = inspections_in(out / "inspections" / "doors")
    (door,) = json.loads((out / "shift.json").read_text())["doors"]
    (written,) = inspections_in(out)
    assert kept.run_id == written.run_id == door["run_id"]
    # The topic and the file tell the same.
    assert kept.deviation == pytest.approx(written.deviation, abs=1e-9)
    assert kept.bag.resolve() == written.bag.resolve()
    # Both are known for the simulated gauge's: a further shift takes their place.
    ShiftFolder(out).prepare(1)
    assert not list(out.rglob("inspection.yaml"))


@pytest.mark.parametrize("arguments", [["--door", "x", "--monitor"], ["--door", "x", "--monitor", "--ui"]])
def test_a_monitor_beside_no_shift_is_refused(
    arguments: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as ended:
        main(arguments)
    assert ended.value.code == 2
    assert "--monitor belongs to a shift" in capsys.readouterr().err
