"""What is written is what the reader reads."""

import re
from datetime import UTC, datetime, timedelta, timezone

import numpy as np
import pytest

from doormill_ros.errors import DataSetError
from doormill_ros.measurements.inspections.inspection import inspections_in, read_inspection
from doormill_ros.measurements.inspections.inspection_writer import write_inspection
from doormill_ros.simulation.world.gauge import GaugedPoints


def points(count):
    rng = np.random.default_rng(2)
    normal = rng.normal(size=(count, 3))
    return GaugedPoints(
        tuple(f"hinge_{k % 2}" for k in range(count)),
        tuple("wall" if k % 3 else "floor" for k in range(count)),
        rng.uniform(-1.0, 1.0, (count, 3)),
        normal / np.linalg.norm(normal, axis=1, keepdims=True),
        rng.normal(0.0, 1e-4, count),
    )


def test_a_written_inspection_is_read_as_it_was(tmp_path):
    (tmp_path / "door_003" / "bag").mkdir(parents=True)
    folder, wanted = tmp_path / "door_003" / "inspection", points(20)
    when = datetime(2026, 11, 22, 8, 3, 12, tzinfo=UTC)
    write_inspection(folder, tmp_path / "door_003" / "bag", "run-7", when, 1e-5, wanted)
    found = read_inspection(folder)
    assert (found.run_id, found.measured_at, found.noise, found.datum) == ("run-7", when, 1e-5, "camera")
    assert found.bag.resolve() == (tmp_path / "door_003" / "bag").resolve()
    assert found.feature == wanted.feature
    assert found.wall.tolist() == [name == "wall" for name in wanted.surface]
    for name in ("point", "normal", "deviation"):
        np.testing.assert_allclose(getattr(found, name), getattr(wanted, name), atol=5e-10)
    assert [door.name for door in inspections_in(tmp_path)] == ["door_003"]
    assert [door.name for door in inspections_in(folder)] == ["door_003"]


@pytest.mark.parametrize("noise", [1e-8, 1e-5, 1.25e-5, 1.2345678901234567e-05, 1.0 / 30000.0, 1.5e-4, 1e-3])
def test_the_noise_of_a_gauge_is_read_as_it_was_told(tmp_path, noise):
    (tmp_path / "bag").mkdir()
    write_inspection(tmp_path, tmp_path / "bag", "run", datetime.now(UTC), noise, points(4))
    assert read_inspection(tmp_path).noise == noise


def test_inspections_below_their_runs_and_by_themselves_are_found_in_the_order_of_their_names(tmp_path):
    (tmp_path / "bag").mkdir()
    for name in ("b/inspection", "a", "c/inspection"):
        write_inspection(tmp_path / name, tmp_path / "bag", "run", datetime.now(UTC), 1e-5, points(4))
    assert [door.name for door in inspections_in(tmp_path)] == ["a", "b", "c"]


@pytest.mark.parametrize("hours", [-12, 0, 5.5, 14])
def test_the_time_is_the_same_moment_wherever_it_was_told(tmp_path, hours):
    (tmp_path / "bag").mkdir()
    when = datetime(2026, 11, 22, 0, 30, tzinfo=timezone(timedelta(hours=hours)))
    write_inspection(tmp_path, tmp_path / "bag", "run", when, 1e-5, points(4))
    assert read_inspection(tmp_path).measured_at == when


@pytest.mark.parametrize(
    ("text", "year"),
    [
        ("0001-01-01T00:00:00+14:00", None),
        ("1969-12-31T23:59:59Z", None),
        ("1970-01-01T00:00:00Z", 1970),
        ("2037-12-31T23:59:59Z", 2037),
        ("2038-01-01T00:00:00Z", None),
        ("9999-12-31T23:59:59-12:00", None),
    ],
)
def test_a_time_that_no_message_can_tell_is_refused(tmp_path, text, year):
    (tmp_path / "bag").mkdir()
    write_inspection(tmp_path, tmp_path / "bag", "run", datetime.now(UTC), 1e-5, points(4))
    file = tmp_path / "inspection.yaml"
    file.write_text(re.sub("measured_at: .*", f"measured_at: {text}", file.read_text()))
    if year:
        assert read_inspection(tmp_path).measured_at.year == year
        return
    with pytest.raises(DataSetError, match=r"inspection\.yaml: line 4.*of the years 1970 to 2037"):
        read_inspection(tmp_path)
