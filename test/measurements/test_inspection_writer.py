"""What is written is what the reader reads."""

from datetime import UTC, datetime

import numpy as np

from doormill_ros.measurements.inspection import inspections_in, read_inspection
from doormill_ros.measurements.inspection_writer import write_inspection
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


def test_inspections_below_their_runs_and_by_themselves_are_found_in_the_order_of_their_names(tmp_path):
    (tmp_path / "bag").mkdir()
    for name in ("b/inspection", "a", "c/inspection"):
        write_inspection(tmp_path / name, tmp_path / "bag", "run", datetime.now(UTC), 1e-5, points(4))
    assert [door.name for door in inspections_in(tmp_path)] == ["a", "b", "c"]
