"""What the shipped bags say of their runs, and how scatter is seen."""

import numpy as np
import pytest

from doormill_ros.diagnosis.runs.scatter import scatters, strays, variance_of
from doormill_ros.diagnosis.runs.ungauged_run import FEWEST_LOADS, cutting_load, ungauged_runs
from doormill_ros.recording.bag_reader import read_bag
from support.source_tree import ROOT


@pytest.mark.parametrize("door", ["thesis_190_0deg", "thesis_1350_2deg"])
def test_a_shipped_bag_tells_pose_and_times(door):
    (run,) = ungauged_runs(ROOT / "bags" / door)
    told = {}
    for item in read_bag(ROOT / "bags" / door):
        told.setdefault(item.topic, []).append(item.message)
    assert (run.name, run.recipe) == (door, door)
    (localization,) = told["/door/localization"]
    (placed,) = run.pictures
    assert placed.offset.tolist() == [
        localization.offset_y,
        localization.offset_z,
        localization.offset_rotation,
    ]
    assert placed.std[0] ** 2 == pytest.approx(localization.pose.covariance[7])
    assert run.residuals.tolist() == [localization.residual]
    # What the simulated controller takes is near what was predicted; its stamps are those of a faster clock.
    assert run.milling == pytest.approx(told["/path/targets"][0].cycle_time, rel=0.1)
    since = {m.state: m.since.sec + 1e-9 * m.since.nanosec for m in told["/abb/status"]}
    assert run.answer == pytest.approx(since["acknowledged"] - since["ready"], abs=1e-6)
    assert run.link == pytest.approx(since["ready"] - since["writing"], abs=1e-6)


def test_runs_that_were_refused_tell_what_they_can():
    runs = ungauged_runs(ROOT / "bags")
    names = {run.name for run in runs}
    assert {"thesis_190_0deg", "standard_door", "spindle_fault"} <= names
    assert not any(run.name == "no_picture" and run.pictures for run in runs)


@pytest.mark.parametrize("step", [0.0, 5.0])
@pytest.mark.parametrize("recipes", [["a"], ["a", "b"]])
def test_the_scatter_is_that_of_the_runs_whatever_changed(step, recipes):
    """Over 100 series of 40 runs, half of them after a step: taken high, by less than a half."""
    rng = np.random.default_rng(8)
    names = (recipes * 40)[:40]
    levels = np.array([10.0 * recipes.index(name) for name in names])
    found = [
        scatters(levels + rng.standard_normal(40) + step * (np.arange(40) >= 20), names, 1e-6)[0]
        for _ in range(100)
    ]
    assert 1.0 < np.mean(found) < 1.5
    assert np.mean(np.array(found) < 0.8) < 0.05


def test_recipes_that_hardly_follow_each_other_may_differ_by_anything():
    rng = np.random.default_rng(8)
    split, mixed = ["a"] * 20 + ["b"] * 20, ["a", "b"] * 20
    values = rng.standard_normal(40)
    assert scatters(values, split, 1e-6)[1] > 5.0
    own, between = scatters(values, mixed, 1e-6)
    assert between < own
    assert scatters(values + 3.0 * (np.array(mixed) == "b"), mixed, 1e-6)[1] == pytest.approx(4.2, rel=0.3)


def test_a_stray_is_one_run_and_no_step():
    rng = np.random.default_rng(8)
    values, recipes = rng.standard_normal(30), ["a"] * 30
    values[12] += 15.0
    assert np.flatnonzero(strays(values, recipes, 1e-6)).tolist() == [12]
    stepped = rng.standard_normal(30) + 20.0 * (np.arange(30) >= 15)
    assert not strays(stepped, recipes, 1e-6).any()


def test_no_difference_tells_nothing():
    assert variance_of(np.zeros(0)) == 0.0


def loads(cut: float, idle: float = 0.1, count: int = 200) -> np.ndarray:
    """A spindle that stands, comes to speed, turns in the air for three tenths of the time and cuts in the others."""
    turning = np.where(np.arange(count) % 10 < 3, idle, idle + cut)
    return np.concatenate([np.zeros(4), np.full(4, 0.5), turning])


def test_the_load_of_the_cut_is_that_above_the_air():
    one, other = cutting_load(loads(0.2)), cutting_load(loads(0.4))
    surge = 4 * 0.4 / 208
    assert one == pytest.approx(0.2 * 140 / 208 + surge)
    assert other - surge == pytest.approx(2.0 * (one - surge))
    assert cutting_load(loads(0.2, idle=0.3)) == pytest.approx(one, abs=0.01)


def test_few_loads_or_a_spindle_that_stands_tell_none():
    assert np.isnan(cutting_load(np.zeros(0)))
    assert np.isnan(cutting_load(np.zeros(200)))
    assert np.isnan(cutting_load(loads(0.2)[: FEWEST_LOADS + 3]))
    assert np.isfinite(cutting_load(loads(0.2)[: FEWEST_LOADS + 4]))


def test_loads_that_are_no_numbers_count_nowhere():
    told = loads(0.2)
    assert cutting_load(np.append(told, [np.nan, np.inf])) == cutting_load(told)


def test_bags_without_the_spindle_tell_no_work():
    assert all(np.isnan(run.work) for run in ungauged_runs(ROOT / "bags"))
