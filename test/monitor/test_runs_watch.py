"""Bags of runs as they come to lie below a folder: what the watch over them makes of series with hidden changes."""

from __future__ import annotations

import shutil
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from types import TracebackType

import pytest

import doormill_ros.monitor.runs_watch as watching
from doormill_ros.diagnosis.runs.limits import FEWEST
from doormill_ros.monitor.runs_finding import FEW, RunsFinding
from doormill_ros.monitor.runs_question import RunsQuestion
from doormill_ros.monitor.runs_watch import RunsState, RunsWatch
from doormill_ros.monitor.watch_state import WatchSettings
from doormill_ros.recording.bag_reader import BagMessage, read_bag
from doormill_ros.recording.bag_writer import BagWriter
from support.asked_here import questioner
from support.run_series import Series, draw_series
from support.run_series_bags import write_series
from support.waiting import LIMIT

SETTINGS = WatchSettings(doors=40, since="", limit=0.0, patience=600.0, model="", runs=60)
SHORT = 0.05  # s, between two looks
COUNT = 14
RESULT, STATUS, REQUEST = "/run/result", "/abb/status", "/abb/request"


class Bags:
    """A watch over the bags of a folder, with settings that can be changed."""

    def __init__(self, folder: Path, settings: WatchSettings = SETTINGS, own_process: bool = False) -> None:
        self.settings, self.bags = settings, folder / "bags"
        self.asked: list[RunsQuestion] = []
        self.looks = 0
        self.questioner = questioner(folder / "kept", lambda: self.settings.patience, own_process)
        ask = self.questioner.ask

        def noted(question: RunsQuestion) -> None:
            self.asked.append(question)
            ask(question)

        self.questioner.ask = noted  # type: ignore[method-assign, assignment]
        self.watch = RunsWatch(self.bags, lambda: self.settings, self.questioner, lambda: None, SHORT)
        look = self.watch._look

        def counted() -> None:
            look()
            self.looks += 1

        self.watch._look = counted  # type: ignore[method-assign]

    def __enter__(self) -> Bags:
        self.watch.start()
        self.questioner.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.questioner.stop()
        self.watch.stop()

    def bring(self, source: Path) -> None:
        """A bag, or a folder of them, comes to lie below the folder, all at once."""
        self.bags.mkdir(parents=True, exist_ok=True)
        beside = self.bags.parent / f"coming_{source.name}"
        shutil.copytree(source, beside)
        beside.rename(self.bags / source.name)

    def look_on(self, times: int = 3) -> None:
        """Let the watch look so often from now on."""
        wanted = self.looks + times
        self.until(lambda state: self.looks >= wanted)

    def until(self, condition: Callable[[RunsState], bool]) -> RunsState:
        deadline = time.monotonic() + LIMIT
        while not condition(state := self.watch.state()):
            assert time.monotonic() < deadline, state
            time.sleep(SHORT)
        return state

    def found(
        self, condition: Callable[[RunsFinding], bool] = lambda found: found.verdict != FEW
    ) -> RunsFinding:
        """What a finding is from now on, or already, when nothing more is asked for the moment."""
        state = self.until(lambda s: s.finding is not None and not s.asking and condition(s.finding))
        assert state.finding is not None
        return state.finding


def series(*kinds: str, drift: bool = False) -> Series:
    return draw_series(
        11, kinds, COUNT, probe=True, marks=True, repeats=3, drift=drift, order="one", calm=True
    )


@pytest.fixture(scope="module")
def moved(tmp_path_factory: pytest.TempPathFactory) -> tuple[Series, Path]:
    """A series of which the camera was moved."""
    folder, drawn = tmp_path_factory.mktemp("moved") / "shift", series("camera_shift")
    write_series(drawn, folder)
    return drawn, folder


@pytest.fixture(scope="module")
def quiet(tmp_path_factory: pytest.TempPathFactory) -> tuple[Series, Path]:
    """A series in which nothing changed."""
    folder, drawn = tmp_path_factory.mktemp("quiet") / "shift", series()
    write_series(drawn, folder)
    return drawn, folder


@pytest.fixture(scope="module")
def known(moved: tuple[Series, Path], tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, RunsFinding]:
    """A folder in which the moved camera was named, and what was found."""
    folder = tmp_path_factory.mktemp("known")
    with Bags(folder, own_process=True) as cell:
        cell.bring(moved[1])
        return folder, cell.found()


@pytest.fixture
def copied(known: tuple[Path, RunsFinding], tmp_path: Path) -> Path:
    """A copy of that folder."""
    return Path(shutil.copytree(known[0], tmp_path / "copied"))


def test_a_hidden_change_is_named_once_its_bags_lie_there(
    known: tuple[Path, RunsFinding], moved: tuple[Series, Path]
) -> None:
    found, (hidden,) = known[1], moved[0].changes
    (change,) = found.changes
    assert (found.verdict, change.cause, change.where, change.course) == (
        "explained",
        "camera_shift",
        "camera",
        "step",
    )
    first = moved[0].run_id(hidden.first)
    assert change.earliest <= first <= change.latest
    assert found.runs == tuple(moved[0].run_id(run) for run in range(COUNT))
    sizes = {size.name: (size.value, size.unit) for size in change.sizes}
    name = ("offset_y", "offset_z", "offset_rotation")[hidden.axis]
    assert sizes[name][0] == pytest.approx(hidden.size, rel=0.2)
    assert sizes[name][1] == ("m", "m", "rad")[hidden.axis]
    assert (
        f"camera shift at camera ({change.said_sizes[0].words}) from run {change.from_run} on"
        in found.sentence
    )
    assert "since of /model_monitor" in found.sentence
    assert found.next_measurement == f"gauge one door from before run {change.from_run} and one from after it"


def test_a_drift_is_named_as_one(tmp_path: Path) -> None:
    drawn = draw_series(
        11, ("controller_speed",), 40, probe=True, marks=True, repeats=3, drift=True, order="one", calm=True
    )
    write_series(drawn, tmp_path / "bags")
    with Bags(tmp_path) as cell:
        found = cell.found()
    (change,) = found.changes
    assert (change.cause, change.course, change.from_run) == ("controller_speed", "drift", drawn.run_id(0))
    (size,) = change.sizes
    assert (size.name, size.unit) == ("factor", "1")
    assert size.value == pytest.approx(drawn.changes[0].size, rel=0.1)
    assert f"({size.value:.2f} times) that drifts from run {drawn.run_id(0)} on" in found.sentence
    assert found.next_measurement == "gauge one of the first of these doors and one of the last"


def test_of_a_quiet_series_nothing_is_named(quiet: tuple[Series, Path], tmp_path: Path) -> None:
    with Bags(tmp_path) as cell:
        cell.bring(quiet[1])
        found = cell.found()
    assert (found.verdict, found.changes, found.questioned) == ("consistent", (), COUNT)
    assert found.sentence == f"{COUNT} runs by bags alone: nothing changed"
    assert found.next_measurement == ""


def spoil(bag: Path, how: str) -> None:
    """Make a bag what a kill, a disk or another recorder leaves."""
    (file,) = bag.glob("*.mcap")
    content = file.read_bytes()
    if how == "of other fields":
        messages = [one for one in read_bag(bag) if one.topic != RESULT]
        shutil.rmtree(bag)
        writer = BagWriter(bag)
        for one in messages:
            writer.add_topic(RESULT if one.topic == REQUEST else one.topic, one.type_name)
        for one in messages:
            writer.write(RESULT if one.topic == REQUEST else one.topic, one.data, one.stamp_ns)
        writer.close()
    elif how == "damaged":
        middle = len(content) // 4
        file.write_bytes(content[:middle] + bytes(64) + content[middle + 64 :])
    else:
        file.write_bytes(content[: len(content) // 10 if how == "cut off" else 0])


@pytest.mark.parametrize(
    ("how", "why"),
    [
        ("cut off", "is still being written or was cut off"),
        ("empty", "without a run"),
        ("damaged", "cannot be read"),
        ("of other fields", "cannot be used"),
    ],
)
def test_a_bag_of_no_use_is_named_and_the_others_are_asked(
    moved: tuple[Series, Path], tmp_path: Path, how: str, why: str
) -> None:
    source = Path(shutil.copytree(moved[1], tmp_path / "source" / "shift"))
    spoil(source / "door_002" / "bag", how)
    with Bags(tmp_path) as cell:
        cell.bring(source)
        found = cell.found()
    (left,) = found.left_aside
    assert left.startswith(f"{cell.bags / 'shift' / 'door_002' / 'bag'}: ")
    assert why in left
    assert ("Error(" in left) == (how == "of other fields")  # what is known has its own sentence
    assert found.questioned == COUNT - 1
    assert [change.cause for change in found.changes] == ["camera_shift"]
    assert found.sentence.endswith("; bags left aside: 1")


def test_a_run_in_hand_is_left_aside_until_it_has_ended(moved: tuple[Series, Path], tmp_path: Path) -> None:
    """One recorder writes all day: the runs that ended count, the last one does not yet."""
    bags = sorted(moved[1].glob("*/bag"))
    writer, last = BagWriter(tmp_path / "bags" / "day"), moved[0].run_id(COUNT - 1)
    late: list[BagMessage] = []
    for bag in bags:
        for one in read_bag(bag):
            writer.add_topic(one.topic, one.type_name)
            if bag == bags[-1] and one.topic in (RESULT, STATUS):
                late.append(one)
            else:
                writer.write(one.topic, one.data, one.stamp_ns)
    writer.flush(force=True)
    with Bags(tmp_path) as cell:
        found = cell.found()
        assert last not in found.runs
        assert found.questioned == COUNT - 1
        (left,) = found.left_aside
        assert f"without the end of run {last}" in left
        for one in late:
            writer.write(one.topic, one.data, one.stamp_ns)
        writer.flush(force=True)
        for number in range(watching.EVERY):
            cell.watch.ended(f"run {number}")
        found = cell.found(lambda found: last in found.runs)
    assert found.left_aside == ()


def test_a_watch_that_was_ended_knows_its_verdict_again_and_asks_nothing(
    copied: Path, known: tuple[Path, RunsFinding]
) -> None:
    with Bags(copied) as cell:
        assert cell.watch.state() == RunsState(known[1])
        cell.look_on()
    assert cell.asked == []


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("diagnosis.json", "{}"),
        ("diagnosis.json", "[1]"),
        ("diagnosis.json", '{"causes"'),
        ("asked.json", "[]"),
        ("asked.json", '{"count": "6", "since": "", "bags": []}'),
        ("asked.json", None),
    ],
)
def test_an_answer_of_no_use_is_asked_for_anew(
    copied: Path, known: tuple[Path, RunsFinding], name: str, content: str | None
) -> None:
    """Of other software, damaged, or of a process that was killed before it was whole."""
    path = copied / "kept" / RunsQuestion.kept / name
    if content is None:
        path.unlink()
    else:
        path.write_text(content)
    with Bags(copied) as cell:
        assert replace(cell.found(), left_aside=()) == known[1]
    assert len(cell.asked) == 1


def test_runs_that_ended_while_nobody_watched_are_asked_about(
    copied: Path, known: tuple[Path, RunsFinding]
) -> None:
    shutil.rmtree(copied / "bags" / "shift" / "door_000")
    with Bags(copied) as cell:
        assert cell.watch.state().finding == known[1]
        assert cell.found(lambda found: found != known[1]).questioned == COUNT - 1


def test_a_change_goes_with_the_first_run_after_its_repair(
    copied: Path, moved: tuple[Series, Path], known: tuple[Path, RunsFinding]
) -> None:
    """Too few runs are there after it at first, and the answer of before is not taken for theirs."""
    repaired = moved[0].run_id(COUNT - 3)
    with Bags(copied) as cell:
        assert cell.found() == known[1]
        cell.settings = replace(SETTINGS, since=repaired)
        cell.watch.settle()
        found = cell.found(lambda found: found.verdict == FEW)
        assert (found.changes, found.questioned, cell.watch.state().since) == ((), 3, repaired)
        assert found.sentence == f"3 runs by bags alone: changes are told from {FEWEST} on"
    with Bags(copied, replace(SETTINGS, since=repaired)) as cell:
        assert cell.found(lambda found: True).verdict == FEW
    assert cell.asked == []


def test_runs_from_since_on_are_asked_alone(copied: Path, moved: tuple[Series, Path]) -> None:
    since = moved[0].run_id(COUNT - FEWEST)
    with Bags(copied, replace(SETTINGS, since=since)) as cell:
        found = cell.found()
    assert found.runs == tuple(moved[0].run_id(run) for run in range(COUNT - FEWEST, COUNT))


def test_the_last_runs_are_asked_alone(copied: Path, moved: tuple[Series, Path]) -> None:
    with Bags(copied, replace(SETTINGS, runs=8)) as cell:
        found = cell.found(lambda found: found.questioned < COUNT)
    assert found.runs == tuple(moved[0].run_id(run) for run in range(COUNT - 8, COUNT))


def test_nobody_asks_where_nobody_wants_to_know(copied: Path, known: tuple[Path, RunsFinding]) -> None:
    with Bags(copied, replace(SETTINGS, runs=0)) as cell:
        assert cell.watch.state().finding is None
        cell.settings = SETTINGS
        cell.watch.settle()
        assert cell.found() == known[1]
        cell.settings = replace(SETTINGS, runs=0)
        cell.watch.settle()
        state = cell.until(lambda state: state.finding is None)
    assert (state.asking, state.message) == (False, "")
    assert len(cell.asked) == 1


def test_fewer_runs_than_every_third_wait_for_more(
    moved: tuple[Series, Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Before the first verdict each run counts; after it every third, or any once a while has passed."""
    doors = sorted(moved[1].glob("door_*"))
    asked: list[int] = []
    with Bags(tmp_path) as cell:
        for door in doors[:FEWEST]:
            cell.bring(door)
        first = cell.found(lambda found: found.questioned == FEWEST)
        asked.append(len(cell.asked))
        cell.bring(doors[FEWEST])
        cell.look_on()
        asked.append(len(cell.asked))
        assert cell.watch.state().finding == first
        for door in doors[FEWEST + 1 : FEWEST + watching.EVERY]:
            cell.bring(door)
        cell.found(lambda found: found.questioned == FEWEST + watching.EVERY)
        monkeypatch.setattr(watching, "LONGEST", 0.0)
        cell.bring(doors[FEWEST + watching.EVERY])
        cell.found(lambda found: found.questioned == FEWEST + watching.EVERY + 1)
    assert asked == [1, 1]
    assert len(cell.asked) == 3


def test_no_run_waits_for_more_where_no_more_come(moved: tuple[Series, Path], tmp_path: Path) -> None:
    doors = sorted(moved[1].iterdir())
    with Bags(tmp_path) as cell:
        for door in doors[:FEWEST]:
            cell.bring(door)
        assert cell.found().questioned == FEWEST
        cell.bring(doors[FEWEST])
        state = cell.watch.at_end(LIMIT)
        assert state.finding is not None
        assert (state.finding.questioned, state.asking) == (FEWEST + 1, False)
        assert len(cell.watch.at_end(LIMIT).finding.runs) == FEWEST + 1
        assert len(cell.asked) == 2


def test_the_end_of_too_few_runs_is_not_waited_for(moved: tuple[Series, Path], tmp_path: Path) -> None:
    with Bags(tmp_path) as cell:
        cell.bring(sorted(moved[1].iterdir())[0])
        state = cell.watch.at_end(LIMIT)
        assert (state.finding.verdict, cell.asked) == (FEW, [])


def test_the_node_loads_no_diagnosis_to_ask_one() -> None:
    """That costs seconds and memory of a cell that starts; the process that is asked loads it."""
    script = (
        "import sys, doormill_ros.nodes.model_monitor as node; assert node; "
        "print([name for name in sys.modules if name == 'scipy' or name.startswith('doormill_ros.diagnosis.core')])"
    )
    told = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert told.stdout.strip() == "[]"
