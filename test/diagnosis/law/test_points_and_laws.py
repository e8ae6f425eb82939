"""Laws without a name where a tracker saw a point alone: positions, and nothing of rotations."""

import json

import pytest
import yaml

from doormill_ros.tools.diagnose import main
from support.pose_laws.world import draw

QUATERNION = ("qw", "qx", "qy", "qz")


def positions_alone(folder):
    """The same series without the orientation of its target."""
    table, description = folder / "poses.csv", folder / "set.yaml"
    lines = [line.split(",") for line in table.read_text(encoding="utf-8").splitlines()]
    kept = [at for at, name in enumerate(lines[0]) if name not in QUATERNION]
    table.write_text("".join(",".join(line[at] for at in kept) + "\n" for line in lines), encoding="utf-8")
    document = yaml.safe_load(description.read_text(encoding="utf-8"))
    del document["noise"]["rotation"]
    description.write_text(yaml.safe_dump(document), encoding="utf-8")
    return folder


@pytest.mark.parametrize("seed", [2, 4])
def test_a_law_is_placed_and_predicts_another_series_from_positions_alone(tmp_path, seed):
    world, out = draw(seed), tmp_path / "out"
    data = positions_alone(world.write(tmp_path / "set"))
    other = positions_alone(world.write(tmp_path / "unseen", part=1))
    assert main(["--data", str(data), "--check", str(other), "--out", str(out)]) == 0
    document = json.loads((out / "diagnosis.json").read_text(encoding="utf-8"))
    (law,) = document["unnamed"]
    assert (law["where"], law["driver"]) == (world.truth["where"], world.truth["driver"])
    noise = document["noise_floor"]
    (check,) = document["checks"]
    assert check["extended"]["rmse"] > 2.0 * noise
    assert check["characterised"]["rmse"] < 1.2 * noise
