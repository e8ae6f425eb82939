"""A door that slips in the closed clamp after its picture: no signal tells of it, and nobody calls it good."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

from doormill_ros.recording.bag_reader import read_bag
from support.cell_processes import executable
from support.waiting import LIMIT

DOOR = "thesis_190_0deg"
SLIP = 1e-3  # m along base y
OUT_OF_TOLERANCE = 807


def test_a_door_that_slips_after_its_picture_is_told_as_out_of_tolerance(tmp_path: Path) -> None:
    world = tmp_path / "world.yaml"
    world.write_text(f"schema: doormill/world/1\nclamp: {{shift: [0, {SLIP}, 0], from_door: 1}}\n")
    command = [executable("cell"), "--door", DOOR, "--doors", "2", "--world", str(world), "--out", "run"]
    ended = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=LIMIT, check=False)
    assert ended.returncode == 1, ended.stdout
    results = []
    for number in range(2):
        bag = tmp_path / "run" / f"door_{number:03d}" / "bag"
        (found,) = [m.message for m in read_bag(bag, ["/run/result"])]
        results.append(found)
    good, slipped = results
    assert good.success, good.message
    assert (slipped.success, slipped.error_code, slipped.measured) == (False, OUT_OF_TOLERANCE, True)
    assert slipped.deviation == pytest.approx(good.deviation + SLIP, abs=0.05e-3)
    assert "milled, out of tolerance" in ended.stderr
