"""An option that would be ignored is refused in one line."""

from __future__ import annotations

from pathlib import Path

import pytest

from doormill_ros.tools import calibrate, diagnose


def test_diagnose_checks_nothing_with_the_thesis(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "out"
    with pytest.raises(SystemExit) as stop:
        diagnose.main(["--thesis", "--check", "DIR", "--out", str(out)])
    assert stop.value.code == 2
    assert capsys.readouterr().err == (
        "diagnose: --check was given with --thesis, allowed is --check with --data, --pictures, --inspections, --runs; "
        "leave one out\n"
    )
    assert not out.exists()


@pytest.mark.parametrize("count", [1, 2, 4])
def test_a_lens_has_three_coefficients(count: int, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as stop:
        calibrate.main(["lens", *["0.1"] * count])
    assert stop.value.code == 2
    assert capsys.readouterr().err == (
        f"calibration: {count} coefficients were given, allowed are three (k1 k2 k3) or none "
        "for those of the camera file\n"
    )
