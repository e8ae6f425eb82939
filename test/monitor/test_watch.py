"""Inspections of a shift in a world with a gap and a larger force: what the watch makes of them, without ROS."""

import shutil
import time
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path

import numpy as np
import pytest

from doormill_ros.errors import DataSetError
from doormill_ros.measurements.inspections.inspection import read_inspection
from doormill_ros.models.errors import MillingStoppedError, UnknownVersionError
from doormill_ros.models.store import ModelStore
from doormill_ros.monitor.errors import InspectionMessageError, KeepingError, QuestionError, UnknownRunError
from doormill_ros.monitor.kept_doors import DoorPoints, KeptDoors
from doormill_ros.monitor.questioner import Questioner
from doormill_ros.monitor.recorded_runs import RecordedRuns
from doormill_ros.monitor.watch import ModelWatch
from doormill_ros.monitor.watch_state import WatchSettings
from support.asked_here import questioner
from support.gauged_shift import HINGE_DOORS, gauged_shift
from support.source_tree import ROOT
from support.waiting import LIMIT

WORLD = {"seed": 5, "force": {"factor": 1.3}, "robot": {"gap": [1e-4, 0.0, 0.0, 0.0, 0.0, 0.0]}}
SETTINGS = WatchSettings(doors=40, since="", limit=0.6e-3, patience=600.0, model="")
DOORS = HINGE_DOORS[:2]


def nobody(points):
    """Nobody is told of what was handed in."""


class Watched:
    """A watch in a folder, with settings that can be changed."""

    def __init__(self, folder, bags=ROOT / "bags", settings=SETTINGS, own_process=False):
        self.settings = settings
        self.store = ModelStore(folder / "models")
        self.questioner = questioner(folder / "kept", lambda: self.settings.patience, own_process)
        self.watch = ModelWatch(
            folder / "kept", bags, folder / "models", lambda: self.settings, self.questioner, lambda: None
        )

    def __enter__(self):
        self.watch.start()
        self.questioner.start()
        return self

    def __exit__(self, *_):
        self.questioner.stop()
        self.watch.stop()

    def answered(self, condition=lambda state: not state.asking):
        deadline = time.monotonic() + LIMIT
        while not condition(state := self.watch.state()):
            assert time.monotonic() < deadline, state
            time.sleep(0.05)
        return state


@pytest.fixture(scope="module")
def inspected(tmp_path_factory):
    """Two gauged doors."""
    return gauged_shift(tmp_path_factory.mktemp("doors"), WORLD, DOORS, 5)


@pytest.fixture(scope="module")
def asked(inspected, tmp_path_factory):
    """A folder in which the two doors were questioned, and the state after that."""
    folder = tmp_path_factory.mktemp("watch")
    with Watched(folder, own_process=True) as watched:
        watched.watch.hand_in(inspected, nobody)
        state = watched.answered()
    return folder, state


@pytest.fixture
def copied(asked, tmp_path_factory):
    """A copy of that folder, beside it: inspections name their bags by where they lie."""
    folder = tmp_path_factory.mktemp("copy")
    shutil.copytree(asked[0], folder, symlinks=True, dirs_exist_ok=True)
    return folder


def points_of(folder, **changes):
    """An inspection as a message brings it."""
    read = read_inspection(folder)
    surface = np.where(read.wall, "wall", "floor").tolist()
    points = DoorPoints(
        read.run_id,
        datetime(2026, 11, 22, 9, tzinfo=UTC),
        read.noise,
        read.datum,
        read.feature,
        surface,
        read.point,
        read.normal,
        read.deviation,
    )
    return replace(points, **changes)


def test_the_doors_name_what_the_world_hides_and_a_model_is_proposed(asked):
    _, state = asked
    found = state.finding
    assert {(fault.cause, fault.where) for fault in found.faults} == {
        ("joint_backlash", "joint 1"),
        ("process_force", "tool"),
    }
    assert "joint backlash at joint 1" in found.sentence
    assert (state.version, state.proposed, found.questioned) == (0, 1, 2)
    assert found.next_measurement
    assert [door.door_id for door in state.doors] == list(DOORS)


def test_the_expected_error_is_that_of_the_doors_and_the_proposed_model_leaves_less(asked, inspected):
    _, state = asked
    worst = max(np.abs(read_inspection(inspected / f"door_{k:03d}").deviation).max() for k in range(2))
    assert state.expected == pytest.approx(worst, rel=1e-9)
    assert state.expected_proposed < 0.8 * state.expected


def test_beyond_the_limit_no_door_is_milled_until_the_better_model_is_accepted(copied):
    with Watched(copied) as watched:
        state = watched.answered()
        assert state.expected > SETTINGS.limit
        with pytest.raises(MillingStoppedError, match=r"version 1 of the model would leave .* accept it"):
            watched.store.for_next_run()
        watched.watch.accept(1, "Kari", "as proposed")
        assert watched.store.for_next_run().version == 1
        state = watched.answered()
        assert (state.version, state.proposed, state.stopped) == (1, 0, "")
        assert 0.0 < state.expected < SETTINGS.limit
        watched.watch.revert(1, "Kari", "to see it again")
        state = watched.answered()
        assert (state.version, state.proposed) == (0, 1)
        with pytest.raises(MillingStoppedError):
            watched.store.for_next_run()


@pytest.mark.parametrize("limit", [0.0, 1e-2])
def test_the_limit_can_be_raised_or_taken_away_while_the_cell_runs(copied, limit):
    with Watched(copied) as watched:
        assert watched.answered().stopped
        watched.settings = replace(SETTINGS, limit=limit)
        watched.watch.settle()
        assert watched.watch.state().stopped == ""
        assert watched.store.for_next_run().version == 0


def test_a_watch_that_was_ended_knows_its_verdict_again(copied, asked):
    with Watched(copied) as watched:
        state = watched.watch.state()
        assert not state.asking
        assert replace(state, asking=False) == asked[1]


@pytest.mark.parametrize("changes", [{}, {"deviation": 0.2}, {"noise": 2.0}], ids=str)
def test_a_door_that_was_measured_anew_before_the_end_is_asked_about(copied, inspected, monkeypatch, changes):
    """Kept, and the process killed before the answer; the same points again are no other question."""
    read = read_inspection(inspected / "door_000")
    scaled = {name: getattr(read, name) * factor for name, factor in changes.items()}
    kept, runs = copied / "kept", []
    KeptDoors(kept, RecordedRuns(ROOT / "bags")).keep(
        points_of(inspected / "door_000", measured_at=read.measured_at, **scaled)
    )
    monkeypatch.setattr(Questioner, "ask", lambda _, question: runs.append(question.asked["runs"]))
    with Watched(copied):
        pass
    assert len(runs) == bool(changes)


def test_nothing_is_accepted_by_itself_and_no_unknown_version(copied):
    with Watched(copied) as watched:
        with pytest.raises(UnknownVersionError):
            watched.watch.accept(9, "Kari", "a slip")
        assert watched.store.record().in_use == 0


def test_an_inspection_of_an_unknown_run_waits_for_its_bag(inspected, tmp_path):
    bags = tmp_path / "bags"
    points = points_of(inspected / "door_000")
    with Watched(tmp_path / "watch", bags) as watched:
        watched.watch.take(points)
        state = watched.answered(lambda state: state.message)
        assert state.error_code == UnknownRunError.code
        assert points.run_id in state.message
        assert (state.waiting, state.doors) == (1, ())
        shutil.copytree(ROOT / "bags" / DOORS[0], bags / "later")
        state = watched.answered(lambda state: state.finding and not state.asking)
        assert [door.run_id for door in state.doors] == [points.run_id]
        assert (state.waiting, state.error_code) == (0, 0)
        assert state.finding.questioned == 1


BAD = {
    "no run": {"run_id": ""},
    "a run that is a path": {"run_id": "a/b"},
    "a run that is the folder above": {"run_id": ".."},
    "a column that is too short": {"deviation": np.zeros(1)},
    "no points": {
        "feature": [],
        "surface": [],
        "point": np.zeros((0, 3)),
        "normal": np.zeros((0, 3)),
        "deviation": np.zeros(0),
    },
    "a feature of two columns": {"feature": "a,b"},
}


@pytest.mark.parametrize("changes", BAD.values(), ids=BAD)
def test_a_message_that_contradicts_itself_is_refused_and_leaves_nothing(inspected, tmp_path, changes):
    points = points_of(inspected / "door_000")
    if isinstance(changes.get("feature"), str):
        changes = {"feature": [changes["feature"]] * len(points.feature)}
    with Watched(tmp_path) as watched:
        watched.watch.take(replace(points, **changes))
        state = watched.answered(lambda state: state.message)
    assert state.error_code == InspectionMessageError.code
    assert (state.waiting, state.doors) == (0, ())


@pytest.mark.parametrize("changes", [{"noise": -1.0}, {"datum": "the wall"}], ids=str)
def test_a_message_with_a_value_of_no_use_is_refused_and_leaves_nothing(inspected, tmp_path, changes):
    with Watched(tmp_path) as watched:
        watched.watch.take(replace(points_of(inspected / "door_000"), **changes))
        state = watched.answered(lambda state: state.message)
    assert 500 <= state.error_code < 600
    assert next(iter(changes)) in state.message
    assert (state.waiting, state.doors) == (0, ())


def test_a_broken_file_is_named_and_keeps_nothing_out_that_was_there(copied, inspected, tmp_path):
    broken = tmp_path / "broken"
    shutil.copytree(inspected / "door_001", broken)
    table = broken / "points.csv"
    table.write_text(table.read_text().replace("wall", "roof", 1))
    (broken / "inspection.yaml").write_text(
        (inspected / "door_001" / "inspection.yaml")
        .read_text()
        .replace("bag: ", f"bag: {inspected}/door_001/")
    )
    told = []
    with Watched(copied) as watched:
        before = watched.watch.state()
        with pytest.raises(DataSetError, match=r"points\.csv: line 2, column"):
            watched.watch.hand_in(broken / "inspection.yaml", told.append)
        assert watched.watch.state() == before
    assert not told


@pytest.mark.parametrize(
    ("key", "value"), [("run_id", "'2026 11 27 no 2'"), ("run_id", "'1.50'"), ("datum", "'feature a: b'")]
)
def test_of_a_folder_of_which_one_is_refused_none_is_taken(inspected, tmp_path, key, value):
    folder, told = tmp_path / "in", []
    for number in range(2):
        door = Path(shutil.copytree(inspected / f"door_{number:03d}", folder / str(number)))
        lines = dict(line.split(": ", 1) for line in (door / "inspection.yaml").read_text().splitlines())
        lines["bag"] = str(ROOT / "bags" / DOORS[number])
        lines |= {key: value} if number else {}
        (door / "inspection.yaml").write_text("".join(f"{k}: {v}\n" for k, v in lines.items()))
    with Watched(tmp_path) as watched:
        with pytest.raises((InspectionMessageError, DataSetError)):
            watched.watch.hand_in(folder, told.append)
        state = watched.watch.state()
    assert (told, state.doors, state.waiting, state.asking) == ([], (), 0, False)


def test_inspections_that_were_taken_before_the_disk_was_full_are_asked_about(
    inspected, tmp_path, monkeypatch
):
    keep, asked = KeptDoors.keep, []

    def full(kept, points, bag=None):
        if kept._doors.is_relative_to(tmp_path) and kept.doors():
            raise KeepingError("no space left")
        return keep(kept, points, bag)

    monkeypatch.setattr(KeptDoors, "keep", full)
    monkeypatch.setattr(Questioner, "ask", lambda _, question: asked.append(len(question.doors)))
    with Watched(tmp_path) as watched, pytest.raises(KeepingError):
        watched.watch.hand_in(inspected, nobody)
    assert asked == [1]


def test_a_door_that_the_diagnosis_cannot_use_is_set_aside_and_the_others_are_questioned(copied, inspected):
    points = points_of(inspected / "door_000")
    with Watched(copied, own_process=True) as watched:
        watched.watch.take(replace(points, feature=["no_such_feature"] * len(points.feature)))
        state = watched.answered(lambda state: state.error_code and not state.asking)
        assert state.error_code == QuestionError.code
        assert points.run_id in state.message
        assert "no_such_feature" in state.message
        assert [door.door_id for door in state.doors] == [DOORS[1]]
        assert state.finding.questioned == 1
    assert (copied / "kept" / "refused" / points.run_id / "reason.txt").read_text()


def test_doors_before_a_repair_can_be_left_aside(copied, inspected):
    last = read_inspection(inspected / "door_001").run_id
    with Watched(copied, settings=replace(SETTINGS, since=last)) as watched:
        state = watched.answered(lambda state: not state.asking)
    assert state.finding.questioned == 1
    assert len(state.doors) == 2


def test_an_inspection_that_nobody_foresaw_costs_no_later_one(copied, inspected, monkeypatch):
    """Of a run that is kept, so that its points count whenever they are taken."""
    folder = inspected / "door_000"
    keep, count = KeptDoors.keep, []

    def stumble(kept, points, bag=None):
        count.append(points.run_id)
        if len(count) == 1:
            raise ZeroDivisionError("nobody foresaw it")
        return keep(kept, points, read_inspection(folder).bag)

    monkeypatch.setattr(KeptDoors, "keep", stumble)
    with Watched(copied) as watched:
        watched.answered()
        watched.watch.take(points_of(folder))
        state = watched.answered(lambda state: state.error_code == QuestionError.code)
        assert "nobody foresaw it" in state.message
        watched.watch.take(points_of(folder, measured_at=datetime(2026, 11, 23, tzinfo=UTC)))
        state = watched.answered(lambda state: len(count) == 2 and not state.error_code)
        assert [door.measured_at[:10] for door in state.doors].count("2026-11-23") == 1


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("diagnosis.json", "{}"),
        ("diagnosis.json", "[1]"),
        ("diagnosis.json", '{"causes"'),
        ("asked.json", "[]"),
        ("asked.json", '{"runs": [], "version": 0, "model": ""}'),
        ("asked.json", '{"runs": 3, "version": 0, "model": ""}'),
        ("asked.json", '{"runs": ["a"], "version": "0", "model": ""}'),
    ],
)
def test_an_answer_of_no_use_is_asked_for_anew(copied, asked, name, content):
    """Of other software, or damaged: the watch begins, and comes to the same verdict."""
    (copied / "kept" / "answer" / name).write_text(content)
    with Watched(copied) as watched:
        state = watched.answered(lambda state: state.finding and not state.asking)
    assert (state.finding, state.error_code) == (asked[1].finding, 0)


def test_a_verdict_that_nobody_foresaw_costs_no_later_question(copied, inspected, monkeypatch):
    propose, count = ModelStore.propose, []

    def stumble(store, model, source):
        count.append(source)
        if len(count) == 1:
            raise ZeroDivisionError("nobody foresaw it")
        return propose(store, model, source)

    (copied / "kept" / "answer" / "asked.json").unlink()
    monkeypatch.setattr(ModelStore, "propose", stumble)
    with Watched(copied) as watched:
        state = watched.answered(lambda state: state.error_code and not state.asking)
        assert "nobody foresaw it" in state.message
        watched.watch.hand_in(inspected, nobody)
        state = watched.answered(lambda state: len(count) == 2 and not state.asking)
    assert (state.error_code, state.finding.better) == (0, True)
