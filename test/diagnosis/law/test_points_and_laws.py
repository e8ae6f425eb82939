"""Laws without a name where a tracker saw a point alone, and where one tracker is worse than the other."""

import json

import numpy as np
import pytest
import yaml

from doormill_ros.diagnosis.pose.diagnosis import diagnose_poses
from doormill_ros.diagnosis.pose.laws import with_laws
from doormill_ros.measurements.sets.pose_set import read_pose_set
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


def by_a_coarse_tracker(folder, noise):
    """The same positions with more noise [m], as the set says."""
    table, description = folder / "poses.csv", folder / "set.yaml"
    head, *lines = (line.split(",") for line in table.read_text(encoding="utf-8").splitlines())
    at, rng = head.index("x"), np.random.default_rng(8)
    for line in lines:
        line[at : at + 3] = [f"{float(v) + rng.normal(0.0, noise):.9f}" for v in line[at : at + 3]]
    table.write_text("".join(",".join(line) + "\n" for line in [head, *lines]), encoding="utf-8")
    document = yaml.safe_load(description.read_text(encoding="utf-8"))
    document["noise"]["position"] = noise
    description.write_text(yaml.safe_dump(document), encoding="utf-8")
    return folder


def test_a_law_that_a_fine_tracker_shows_is_not_lost_beside_a_coarse_one(tmp_path):
    world = draw(2)
    fine = positions_alone(world.write(tmp_path / "fine"))
    coarse = by_a_coarse_tracker(positions_alone(world.write(tmp_path / "coarse", part=1)), 4e-4)
    found = with_laws(diagnose_poses([read_pose_set(coarse), read_pose_set(fine)]))
    (law,) = found.laws.laws
    assert (law.where, law.driver) == (world.truth["where"], world.truth["driver"])
    assert found.holdout_rmse[1] > 1.5 * found.noise_floor
    assert found.laws.holdout_rmse == pytest.approx(found.noise_floor, rel=0.1)
