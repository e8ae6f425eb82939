"""An option that would be ignored is refused in one line."""

from __future__ import annotations

from pathlib import Path

import pytest

from doormill_ros.tools import calibrate, diagnose


@pytest.mark.parametrize("source", [["--thesis"], ["--pictures", "DIR"], ["--inspections", "DIR"]])
def test_diagnose_checks_only_with_data(
    source: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    with pytest.raises(SystemExit) as stop:
        diagnose.main([*source, "--check", "DIR", "--out", str(out)])
    assert stop.value.code == 2
    assert capsys.readouterr().err == (
        f"diagnose: --check was given with {source[0]}, allowed is --check with --data; leave one out\n"
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
