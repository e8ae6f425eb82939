"""Files in degrees or millimetres are refused with the column and what to write, and no SI file is."""

import csv
from pathlib import Path

import numpy as np
import pytest
import yaml

from doormill_ros.errors import DataSetError
from doormill_ros.measurements.sets.measurement_set import COLUMNS, read_measurement_set
from doormill_ros.measurements.sets.motion_set import read_motion_set
from doormill_ros.measurements.sets.pose_set import read_pose_set
from support.motion_world import Recording, record

DEGREES, MILLIMETRES = 180.0 / np.pi, 1000.0
LOADING = {
    "schema": "doormill/measurement-set/1",
    "robot": "irb6600_175_255",
    "model": {"joint_stiffness": [2.4e6, 2.1e6, 1.7e6, 3.4e5, 1.2e5, 4.6e4]},
    "noise": {"displacement": 8e-6, "force": 0.3, "torque": 0.03},
    "wrench_frame_rotation": 0.7688,
    "load_point": [0.0, 0.0, 0.18],
    "reflectors": {"ee": {"link": 6, "position": [0.05, 0.0, 0.18]}},
}


@pytest.fixture
def poses(tmp_path, write_pose_sets, faults):
    return write_pose_sets(tmp_path, faults(names=["one"]), 12, 1)[0]


@pytest.fixture
def motion(tmp_path):
    return record(tmp_path / "set", Recording(seconds=3.0), seed=1)


@pytest.fixture
def loading(tmp_path):
    rng = np.random.default_rng(3)
    (tmp_path / "set.yaml").write_text(yaml.safe_dump(LOADING))
    rows = []
    for trial in range(1, 31):
        q, wrench, displacement = (
            rng.uniform(-3.0, 3.0, 6),
            rng.uniform(-800.0, 800.0, 6),
            rng.normal(0.0, 4e-4, 3),
        )
        rows.append([trial, 10.0 * trial, 5.0, "", *q, *np.ones(6), *wrench, "ee", *displacement])
    with (tmp_path / "trials.csv").open("w", newline="") as file:
        csv.writer(file).writerows([COLUMNS, *rows])
    return tmp_path


def rewrite(path: Path, columns: list[str], value) -> None:
    """Put in a table's cells what `value` makes of each one and its share of the table's length."""
    with path.open(newline="") as file:
        rows = list(csv.DictReader(file))
    for index, row in enumerate(rows):
        row.update({name: repr(float(value(float(row[name]), index / len(rows)))) for name in columns})
    with path.open("w", newline="") as file:
        writer = csv.DictWriter(file, list(rows[0]))
        writer.writeheader()
        writer.writerows(rows)


def scale(path: Path, columns: list[str], factor: float) -> None:
    rewrite(path, columns, lambda before, _: before * factor)


def change(folder: Path, *keys: str, factor: np.ndarray | float) -> None:
    document = yaml.safe_load((folder / "set.yaml").read_text())
    place = document
    for key in keys[:-1]:
        place = place[key]
    place[keys[-1]] = (np.array(place[keys[-1]]) * factor).tolist()
    (folder / "set.yaml").write_text(yaml.safe_dump(document))


def check(read, folder: Path, spoil, *words: str) -> None:
    """The set is read as it is, and refused once it is in the other unit."""
    read(folder)
    spoil()
    with pytest.raises(DataSetError) as raised:
        read(folder)
    for word in words:
        assert word in raised.value.message


JOINTS = [f"q{k}" for k in range(1, 7)]


@pytest.mark.parametrize(
    ("kind", "read", "table", "columns", "factor", "words"),
    [
        ("poses", read_pose_set, "poses.csv", JOINTS, DEGREES, ("column q", "write radians")),
        ("poses", read_pose_set, "poses.csv", ["x", "y", "z"], MILLIMETRES, ("column", "write metres")),
        ("loading", read_measurement_set, "trials.csv", JOINTS, DEGREES, ("column q", "write radians")),
        ("loading", read_measurement_set, "trials.csv", ["dx", "dy", "dz"], MILLIMETRES, ("column d", "write metres")),
    ],
)  # fmt: skip
def test_columns_in_other_units(kind, read, table, columns, factor, words, request):
    folder = request.getfixturevalue(kind)
    check(read, folder, lambda: scale(folder / table, columns, factor), *words)


@pytest.mark.parametrize(
    ("factor", "words"),
    [
        (np.array([DEGREES, 1.0, 1.0, DEGREES]), "write radians"),
        (np.array([1.0, MILLIMETRES, MILLIMETRES, 1.0]), "write metres"),
    ],
)
def test_a_table_of_links_in_other_units(poses, factor, words):
    check(read_pose_set, poses, lambda: change(poses, "model", "dh", factor=factor), "model.dh", words)


@pytest.mark.parametrize("column", ["m1", "l3", "r1"])
def test_motions_in_degrees(motion, column):
    path = motion / "samples.csv"

    def turn(angle: float) -> None:
        rewrite(path, [column], lambda _, share: share * angle)

    turn(np.pi / 2)
    check(read_motion_set, motion, lambda: turn(90.0), f"column {column}", "write radians")


def test_one_reflector_that_was_knocked_off_is_no_file_in_millimetres(loading):
    path = loading / "trials.csv"
    lines = path.read_text().splitlines()
    lines[5] = ",".join([*lines[5].split(",")[:-3], "0.4", "-0.2", "0.1"])
    path.write_text("\n".join(lines) + "\n")
    assert np.abs(read_measurement_set(loading).displacement).max() == 0.4


@pytest.mark.parametrize("keys", [("load_point",), ("reflectors", "ee", "position")])
def test_places_in_millimetres(loading, keys):
    check(
        read_measurement_set,
        loading,
        lambda: change(loading, *keys, factor=MILLIMETRES),
        ".".join(keys),
        "write metres",
    )


def test_the_turn_of_a_sensor_in_degrees_is_refused(loading):
    (loading / "set.yaml").write_text(yaml.safe_dump(LOADING | {"wrench_frame_rotation": 44.05}))
    with pytest.raises(DataSetError, match=r"wrench_frame_rotation is 44\.05.*are these degrees"):
        read_measurement_set(loading)
