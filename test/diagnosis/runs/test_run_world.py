"""The drawn runs are recorded as they are meant, and hold nothing that only a simulation knows."""

import numpy as np
import pytest

from doormill_ros.recording.bag_reader import read_bag
from support.run_series import DRIFTING, PLACES, PROBE, TAKT, Series, draw_series
from support.run_series_bags import AGAIN, AIR, LOOK, shipped, write_series

STATES = ["writing", "verifying", "raising", "ready", "acknowledged", "clearing", "milling", "done"]


def seconds(stamp) -> float:
    return stamp.sec + 1e-9 * stamp.nanosec


def messages_of(bag) -> dict[str, list]:
    found: dict[str, list] = {}
    for item in read_bag(bag):
        found.setdefault(item.topic, []).append(item.message)
    return found


def stamps_of(bag) -> list[int]:
    return [item.stamp_ns for item in read_bag(bag, ["/abb/status", "/door/localization", "/run/result"])]


@pytest.fixture(scope="module")
def whole(tmp_path_factory) -> tuple[Series, list]:
    """A series with everything in it, one run refused."""
    for seed in range(100):
        series = draw_series(seed, ("camera_shift",), 9, True, True, 3, False, "cycle")
        if series.refused >= 0:
            folder = tmp_path_factory.mktemp("series")
            return series, [messages_of(bag) for bag in write_series(series, folder)]
    raise AssertionError("no run is ever refused")


def milled(whole) -> list[tuple[int, dict]]:
    series, runs = whole
    assert len(runs) == 9
    return [(run, found) for run, found in enumerate(runs) if run != series.refused]


def test_bags_are_those_of_a_real_cell(whole):
    assert len(milled(whole)) == 8
    for _, found in milled(whole):
        assert not [topic for topic in found if "simulation" in topic or "image" in topic]
        assert not found["/run/result"][0].measured
        assert found["/run/result"][0].success


def test_every_message_of_a_run_names_it(whole):
    series, runs = whole
    names = [series.run_id(run) for run in range(len(runs))]
    assert names == sorted(set(names))
    for name, found in zip(names, runs, strict=True):
        told = {
            message.run_id
            for messages in found.values()
            for message in messages
            if hasattr(message, "run_id")
        }
        assert told == {name, ""}
        if "/abb/target_file" in found:
            shipped_id = shipped(found["/door/recipe"][0].door_id).run_id
            assert shipped_id not in found["/abb/target_file"][0].data


def test_runs_are_a_takt_apart_and_in_order(tmp_path):
    bags = write_series(draw_series(1, (), 3, repeats=1, order="one", calm=True), tmp_path)
    begun = [stamps_of(bag)[0] for bag in bags]
    assert np.diff(begun) == pytest.approx(TAKT * 1e9)
    stamps = [stamp for bag in bags for stamp in stamps_of(bag)]
    assert stamps == sorted(stamps)


def test_localizations_are_the_truth_with_the_error_of_the_camera(whole):
    assert len(milled(whole)) == 8
    series, _ = whole
    for run, found in milled(whole):
        nominal = shipped(series.recipes[run]).nominal
        for number, message in enumerate(found["/door/localization"]):
            offset = (message.offset_y, message.offset_z, message.offset_rotation)
            assert offset == pytest.approx(series.seen[run, number], abs=1e-12)
            place, turn = message.pose.pose.position, message.pose.pose.orientation
            assert (place.y - nominal[1], place.z - nominal[2]) == pytest.approx(offset[:2], abs=1e-9)
            assert 2.0 * np.arcsin(turn.x) == pytest.approx(offset[2], abs=1e-9)
            stated = np.sqrt(np.diag(np.reshape(message.pose.covariance, (6, 6))))
            assert stated == pytest.approx([0.0, *series.stated[0], 0.0, 0.0])
            assert message.residual == pytest.approx(series.residual[run, number])
        times = [seconds(message.header.stamp) for message in found["/door/localization"]]
        assert np.diff(times) == pytest.approx([AGAIN, AGAIN], abs=1e-5)


def test_probe_and_marks_are_recorded_beside(whole):
    assert len(milled(whole)) == 8
    series, _ = whole
    for run, found in milled(whole):
        beside = {message.sensor: message for message in found["/sensors/localization"]}
        assert set(beside) == {"camera", PROBE}
        nominal, place = shipped(series.recipes[run]).nominal, beside[PROBE].pose.pose.position
        assert place.y - nominal[1] == pytest.approx(series.probe[run, 0], abs=1e-9)
        assert list(beside[PROBE].sees) == [False, True, True, True, False, False]
        told = {seconds(message.header.stamp) for message in found["/camera/moved"]}
        assert told == {seconds(message.header.stamp) for message in found["/door/localization"]}
        ways = [(m.twist.linear.y, m.twist.linear.z, m.twist.angular.x) for m in found["/camera/moved"]]
        assert ways == [pytest.approx(way, abs=1e-12) for way in series.way[run]]


def test_states_last_as_drawn(whole):
    assert len(milled(whole)) == 8
    series, _ = whole
    for run, found in milled(whole):
        since = {m.state: seconds(m.since) for m in found["/abb/status"]}
        assert [m.state for m in found["/abb/status"]] == ["idle", "requested", *STATES]
        assert list(since.values()) == sorted(since.values())
        assert since["ready"] - since["writing"] == pytest.approx(series.link[run], abs=1e-5)
        assert since["acknowledged"] - since["ready"] == pytest.approx(series.answer[run], abs=1e-5)
        predicted = found["/path/targets"][0].cycle_time * series.milling[run]
        assert since["done"] - since["milling"] == pytest.approx(predicted, abs=1e-5)
        result = found["/run/result"][0]
        assert result.times.request_to_ready == pytest.approx(since["ready"] - since["requested"], abs=1e-5)
        assert 0.0 < seconds(result.header.stamp) - since["done"] < 1.0


def test_loads_are_of_the_spindle_while_it_mills(tmp_path):
    """Seconds of nominal power that the wood takes, from the messages alone, go as the drawn work."""
    series = draw_series(9, ("cutting_power", "controller_speed"), 12, drift=False, order="one", calm=True)
    taken = []
    for run, bag in enumerate(write_series(series, tmp_path)):
        found = messages_of(bag)
        since = {m.state: seconds(m.since) for m in found["/abb/status"]}
        told = found["/abb/spindle_load"]
        assert {m.run_id for m in told} == {series.run_id(run)}
        assert since["milling"] < seconds(told[0].header.stamp)
        assert seconds(told[-1].header.stamp) < since["done"]
        loads = np.array([m.load for m in told])
        assert loads.min() < 0.02
        taken.append(LOOK * np.sum(loads[loads > AIR + 0.02][6:] - AIR))
    size = np.array(taken) / series.work
    assert size == pytest.approx(size.mean(), rel=0.1)


def test_series_without_the_spindle_are_as_they_were(tmp_path):
    plain, more = draw_series(7), draw_series(7, spindle=True)
    assert plain.work is None
    assert more.work is not None
    assert more.changes[: len(plain.changes)] == plain.changes
    for name in ("truth", "seen", "residual", "milling", "answer", "link"):
        assert np.array_equal(getattr(plain, name), getattr(more, name))
    (bag,) = write_series(draw_series(1, (), 1, order="one", calm=True), tmp_path)
    assert "/abb/spindle_load" not in messages_of(bag)


def test_a_refused_run_has_its_reason_and_no_targets(whole):
    series, runs = whole
    found = runs[series.refused]
    assert "/path/targets" not in found
    assert not found["/door/localization"][0].accepted
    assert not found["/run/result"][0].success
    assert found["/run/result"][0].error_code == found["/door/localization"][0].error_code == 204
    assert [message.state for message in found["/abb/status"]][-2:] == ["failed", "idle"]


@pytest.mark.parametrize("kind", PLACES)
def test_a_change_begins_at_its_run(kind):
    """Told from the truth as nobody in the cell could."""
    series = draw_series(5, (kind,), 40, True, True, 3, False, "one", calm=True)
    (change,) = series.changes
    off = series.seen - series.truth[:, None]
    quantity = {
        "camera_shift": -series.way.mean(axis=1)[:, change.axis],
        "clamp_shift": series.truth[:, change.axis],
        "sensor_shift": (series.probe - series.truth)[:, change.axis],
        "camera_lens": series.residual.mean(axis=1),
        "camera_scatter": off.std(axis=1).mean(axis=1),
        "controller_speed": series.milling,
        "controller_answer": series.answer,
        "link_delay": series.link,
        "cutting_power": series.work,
    }[kind]
    before, after = np.median(quantity[: change.first]), np.median(quantity[change.first :])
    grown = after - before if change.axis >= 0 else after / before
    assert grown == pytest.approx(change.size, rel=0.4)
    if kind == "camera_shift":
        shifted = off.mean(axis=1)[:, change.axis]
        jump = shifted[change.first :].mean() - shifted[: change.first].mean()
        assert jump == pytest.approx(change.size, abs=5e-5)


@pytest.mark.parametrize("kind", DRIFTING)
def test_a_drift_is_over_at_no_run(kind):
    (change,) = draw_series(6, (kind,), 30, True, True, 1, True).changes
    assert change.drift
    assert change.share(30)[[0, 29]] == pytest.approx([0.0, 1.0])


def test_the_same_seed_draws_the_same():
    first, again = (draw_series(7) for _ in range(2))
    assert first.changes == again.changes
    assert np.array_equal(first.seen, again.seen)


def test_changes_leave_runs_before_and_after():
    for seed in range(60):
        series = draw_series(seed)
        assert 8 <= len(series.recipes) <= 60
        for change in series.changes:
            assert change.drift or 3 <= change.first <= len(series.recipes) - 3


def test_nothing_changes_where_one_recipe_follows_another():
    series = draw_series(3, (), 20, order="split")
    assert not series.changes
    assert len(set(series.recipes)) == 2
    assert sum(one != other for one, other in zip(series.recipes, series.recipes[1:], strict=False)) == 1
