"""The course of a run, driven by the real handshake on signals in memory and a clock that the test moves."""

from __future__ import annotations

import gc
import hashlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import pytest

from doormill_ros.abb import signals
from doormill_ros.abb.handshake.handshake import Handshake
from doormill_ros.abb.handshake.state import HandshakeSnapshot, HandshakeTimeouts
from doormill_ros.abb.link_errors import (
    AcknowledgeTimeoutError,
    ConnectionLostError,
    FileRefusedError,
    FileVerificationError,
    MillingFaultError,
)
from doormill_ros.abb.target_file.target_file import check_handover, read_target_file, render_target_file
from doormill_ros.cell.errors import NodeDeadError, OutOfToleranceError, RunCanceledError, StageTimeoutError
from doormill_ros.cell.output.inspection import MeasuredDoor
from doormill_ros.cell.places.layout import load_layout
from doormill_ros.cell.run.clock import Clock
from doormill_ros.cell.run.run import Run, StageLimits
from doormill_ros.pipeline.course import Course
from doormill_ros.pipeline.partners import RecipeAnswer
from doormill_ros.pipeline.plan import load_setup, plan
from doormill_ros.pipeline.run_end import RunEnd
from doormill_ros.recipes.documents import shipped_recipes
from doormill_ros.toolpath.program import MillingProgram, Target
from support.memory_transport import MemoryTransport

DOOR = "thesis_190_0deg"
EPOCH = 1.7e9  # s, wall clock at monotonic 0
GAUGE = frozenset({"gauge"})  # who measures milled doors
TURN = 0.25  # s by which the world moves on whenever the run looks at the clock
LIMITS = StageLimits(
    recipe=3.0, picture=4.0, targets=5.0, request=6.0, ready=7.0, read=8.0, milling=9.0, inspection=10.0
)


@dataclass
class Answer:
    """A stage's answer; the path generator's with its program."""

    accepted: bool = True
    error_code: int = 0
    reason: str = ""
    targets: tuple[Target, ...] = ()
    largest_correction: float = 0.0
    robot_model: str = "irb"
    model_version: int = 0


@pytest.fixture(scope="module")
def program() -> MillingProgram:
    recipe = shipped_recipes()[DOOR]
    return plan(recipe, load_layout().T_base_door(recipe.width, recipe.thickness), load_setup()).program


class World:
    """Database, camera, localizer, path generator and controller around one run, and the link to the latter.

    They move on by one turn whenever the run looks at its clock.

    Attributes:
        absent: Who does nothing: recipe, request, localization, targets, handshake, read or milling.
        at: Called when the run tells of a stage, by its name.
        shift: By how much the wall clock was set [s].
        was_set: By how much the run says that it was set, each time [s].
    """

    def __init__(self, program: MillingProgram, folder: Path) -> None:
        self.program, self.folder = program, folder
        self.now = 1000.0
        self.transport = MemoryTransport()
        self.entered: dict[str, float] = {}
        self.timeouts = HandshakeTimeouts(acknowledge=3600.0)
        self.shift = 0.0
        self.was_set: list[float] = []
        self.run = Run("run-1", DOOR, Clock(self.turn, self.wall, self._was_set))
        self.recipe = RecipeAnswer(True, 0, "", 4)
        self.localization, self.targets = (
            Answer(),
            Answer(targets=program.targets, largest_correction=2e-3, model_version=7),
        )
        self.end_signal = signals.DONE
        self.absent: set[str] = set()
        self.at: dict[str, Callable[[], None]] = {}
        self.told: list[tuple[str, float]] = []
        self.asked = 0
        self.lost = 0  # recipes asked for in vain
        self.read: bytes = b""
        self.heard: dict[str, float] = {}
        self.ready = True
        self.pictured = 0.0
        self.present: frozenset[str] = frozenset()
        self.inspection: MeasuredDoor | None = None
        self.inspected_after = 3  # looks
        self.dead: set[str] = set()
        self.unsettled = 0  # looks
        self.busy_until = 0.0

    def mill(self) -> RunEnd:
        """Take the door through the course."""
        self.handshake = Handshake(
            self.transport, self.tick, self.timeouts, check=check_handover, on_change=self._entered
        )
        self.handshake.on_start()
        return Course(self.run, self, self, self, self, LIMITS, self._tell).mill()

    def _entered(self, snapshot: HandshakeSnapshot) -> None:
        self.entered[snapshot.state.value] = snapshot.since

    def _tell(self, stage: str, progress: float) -> None:
        self.told.append((stage, progress))
        if stage == "picture":  # from here on pictures are taken
            self.heard.clear()
        self.at.pop(stage, lambda: None)()

    def wall(self) -> float:
        """The wall clock."""
        return EPOCH + self.shift + self.now

    def _was_set(self, step: float) -> None:
        self.was_set.append(step)
        self.at.pop("step", lambda: None)()

    def tick(self) -> float:
        """The handshake's clock: each of its steps takes a millisecond."""
        self.now += 1e-3
        return self.now

    def turn(self) -> float:
        """The run's clock."""
        self.now += TURN
        self._controller()
        if "handshake" not in self.absent:
            self.handshake.step()
        self._stage("targets", self.targets, "localization" in self.heard)
        self._stage("localization", self.localization, self.run.not_before < self.wall())
        return self.now

    def _stage(self, name: str, answer: Answer, may: bool) -> None:
        if may and name not in self.absent and name not in self.heard:
            self.heard[name] = self.wall()
            if name == "localization":
                self.pictured = self.wall() - 0.1
            self.run.deliver(name, answer, self.pictured)

    def _controller(self) -> None:
        told = {stage for stage, _ in self.told}
        signal, put = self.transport.signal, self.transport.set_signal
        busy = self.now < self.busy_until
        put(signals.BUSY, busy)
        if "picture" in told and "request" not in self.absent and not self.read and not busy:
            put(signals.REQUEST, True)
        if signal(signals.READY) and "read" not in self.absent:
            self.read = self.transport.read_file(signals.TARGET_FILE)
            if mark := self.transport._files.get(signals.REQUEST_FILE):
                self.transport._files[signals.ACCEPTED_FILE] = self.run.run_id.encode() + b"\n" + mark
            put(signals.REQUEST, False)
        if "milling" in told and "milling" not in self.absent:
            put(self.end_signal, True)

    # What the course is given of the recipe database and the link to the controller.

    def ask(self, door_id: str, run_id: str, hear: Callable[[RecipeAnswer], None]) -> None:
        assert (door_id, run_id) == (DOOR, "run-1")
        self.asked += 1
        if "recipe" not in self.absent and self.asked > self.lost:
            hear(self.recipe)

    def submit(self, targets: Answer, request_number: int) -> bytes:
        data = render_target_file(replace(self.program, targets=targets.targets), self.run.run_id)
        self.handshake.submit(self.run.run_id, DOOR, data, request_number)
        return data

    @property
    def settled(self) -> bool:
        self.unsettled -= 1
        return self.unsettled < 0

    def require(self, names: Sequence[str]) -> None:
        for name in self.dead & set(names):
            raise NodeDeadError(f"/{name} is dead")

    def found(self, run_id: str) -> MeasuredDoor | None:
        assert run_id == "run-1"
        self.inspected_after -= 1
        return self.inspection if self.inspected_after < 0 else None

    def file_away(self, run_id: str, data: bytes) -> Path:
        path = self.folder / f"{run_id}.txt"
        path.write_bytes(data)
        return path


@pytest.fixture
def world(program: MillingProgram, tmp_path: Path) -> World:
    return World(program, tmp_path)


def assert_refused(end: RunEnd, code: int, words: str) -> None:
    assert (end.success, end.error_code) == (False, code), end.message
    assert end.message.startswith(f"door {DOOR}: ")
    assert words in end.message
    assert (end.target_file, end.sha256) == ("", "")


def test_a_door_goes_through_all_stages(world: World) -> None:
    end = world.mill()
    assert end.success, end.message
    assert world.told == [
        ("recipe", 0.0),
        ("picture", 0.1),
        ("pose", 0.3),
        ("targets", 0.4),
        ("ready", 0.6),
        ("milling", 0.7),
        ("milling", 1.0),
    ]
    assert (end.run_id, end.door_id, end.recipe_version, end.error_code) == ("run-1", DOOR, 4, 0)
    assert end.largest_correction == 2e-3
    assert (end.robot_model, end.model_version) == ("irb", 7)
    assert len(read_target_file(world.read).targets) == len(world.program.targets)
    assert Path(end.target_file).read_bytes() == world.read
    assert end.sha256 == hashlib.sha256(world.read).hexdigest()
    assert f"{len(world.program.targets)} targets, largest correction 2.000 mm" in end.message


def test_a_run_that_ended_holds_its_course_no_more(world: World) -> None:
    """Together they would wait for the collector, with thousands of targets."""
    gc.disable()
    try:
        courses = sum(isinstance(thing, Course) for thing in gc.get_objects())
        assert world.mill().success
        assert sum(isinstance(thing, Course) for thing in gc.get_objects()) == courses
    finally:
        gc.enable()


def test_a_door_waits_while_the_robot_mills_what_a_killed_bridge_handed_over(world: World) -> None:
    """For as long as a door may take, which is longer than a request may be missing."""
    world.transport.set_signal(signals.BUSY, True)
    world.busy_until = world.now + LIMITS.request + 2.0
    end = world.mill()
    assert end.success, end.message
    assert world.now > world.busy_until


def test_a_robot_that_never_ends_that_is_named(world: World) -> None:
    world.transport.set_signal(signals.BUSY, True)
    world.busy_until = float("inf")
    assert_refused(world.mill(), 801, "still mills the door before")


def test_the_stages_times_are_those_at_which_they_were_heard_of(world: World) -> None:
    times, entered = world.mill().times, world.entered
    assert times.picture_to_pose == pytest.approx(0.1, abs=1e-6)
    assert times.pose_to_targets == pytest.approx(world.heard["targets"] - world.heard["localization"])
    assert times.pose_to_targets > 0.0
    assert times.targets_to_ready == pytest.approx(entered["ready"] - entered["writing"])
    assert times.request_to_ready == pytest.approx(entered["ready"] - entered["requested"])
    assert times.request_to_ready > times.targets_to_ready > 0.0


REFUSALS = {
    "recipe": (RecipeAnswer(False, 140, "no such door; list them", 0), "no such door", ["recipe"]),
    "localization": (Answer(False, 204, "13 mm off; clamp anew"), "13 mm off", ["recipe", "picture"]),
    "targets": (Answer(False, 310, "out of reach"), "out of reach", ["recipe", "picture", "pose"]),
}


@pytest.mark.parametrize("stage", REFUSALS)
def test_what_a_stage_refuses_ends_the_run_with_its_code_and_words(world: World, stage: str) -> None:
    answer, words, reached = REFUSALS[stage]
    setattr(world, stage, answer)
    end = world.mill()
    assert_refused(end, answer.error_code, words)
    assert [name for name, _ in world.told] == reached
    assert not world.read
    assert end.recipe_version == (0 if stage == "recipe" else 4)


def test_a_file_that_the_handshake_refuses_is_not_announced(world: World) -> None:
    write = world.transport.write_file
    world.transport.write_file = lambda name, data: write(name, data[:-9])
    end = world.mill()
    assert_refused(end, FileVerificationError.code, "Hei2.txt")
    assert not world.read
    assert (world.folder / "run-1.txt").exists()  # the copy tells what was refused
    assert end.times.targets_to_ready == 0.0


def test_a_file_that_the_controller_refuses_was_not_milled(world: World) -> None:
    world.at["ready"] = lambda: world.transport.set_signal(signals.FAULT, True)
    assert_refused(world.mill(), FileRefusedError.code, "refused the file")
    assert [name for name, _ in world.told][-1] == "ready"


TIMEOUTS = {
    "recipe": ("the recipe database does not answer", "3 s"),
    "request": ("the controller does not ask for targets", "6 s"),
    "localization": ("no picture of the door was localized", "4 s"),
    "targets": ("no targets came for the door's pose", "5 s"),
    "read": ("the controller does not read the target file", "15 s"),
    "milling": ("the controller did not report the end of milling", "9 s"),
}


@pytest.mark.parametrize("absent", TIMEOUTS)
def test_a_stage_that_does_not_answer_ends_the_run_after_its_limit(world: World, absent: str) -> None:
    world.absent.add(absent)
    words, limit = TIMEOUTS[absent]
    end = world.mill()
    assert_refused(end, StageTimeoutError.code, words)
    assert f"(waited {limit})" in end.message


def test_a_handshake_that_stands_still_ends_the_run(world: World) -> None:
    world.at["targets"] = lambda: world.absent.add("handshake")
    assert_refused(world.mill(), StageTimeoutError.code, "was not written and verified")
    assert (world.folder / "run-1.txt").exists()


def test_a_handshake_that_gives_up_first_says_why(world: World) -> None:
    world.absent.add("read")
    world.timeouts = HandshakeTimeouts(acknowledge=LIMITS.read)
    assert_refused(world.mill(), AcknowledgeTimeoutError.code, "did not take the file within 8 s")


def test_a_lost_question_for_the_recipe_is_asked_again(world: World) -> None:
    world.lost = 2
    assert world.mill().success
    assert world.asked == 3


def test_a_database_that_is_not_there_is_not_asked(world: World) -> None:
    world.ready = False
    assert_refused(world.mill(), StageTimeoutError.code, "the recipe database does not answer")
    assert world.asked == 0


def test_a_door_that_is_clamped_anew_is_measured_anew(world: World) -> None:
    """The request falls and rises between pose and targets: nothing of the first picture is milled."""
    fresh = replace(world.targets, largest_correction=3e-3)

    def clamp_anew() -> None:
        for level in (False, True):
            world.transport.set_signal(signals.REQUEST, level)
            world.handshake.step()
        world.targets = fresh

    world.at["pose"] = clamp_anew
    end = world.mill()
    assert end.success, end.message
    assert [name for name, _ in world.told] == [
        "recipe",
        "picture",
        "pose",
        "picture",
        "pose",
        "targets",
        "ready",
        "milling",
        "milling",
    ]
    assert end.largest_correction == 3e-3
    assert world.handshake.snapshot.request_number == 2


@pytest.mark.parametrize("marked", [True, False])
@pytest.mark.parametrize("seconds", [0.1, 3.0])
def test_a_door_outlasts_a_break_of_the_link(
    world: World, monkeypatch: pytest.MonkeyPatch, seconds: float, marked: bool
) -> None:
    """Measured once where the robot program marks its requests; a request without a mark may be another door's."""
    if marked:
        world.transport._files[signals.REQUEST_FILE] = b"17\n"
    read_request, read_signal, until = world.transport.read_request, world.transport.read_signal, [0.0]

    def reach() -> None:
        if world.now < until[0]:
            raise ConnectionLostError("no answer")

    def request() -> bool:
        reach()
        return read_request()

    def signal(name: str) -> bool:
        reach()
        return read_signal(name)

    def cut() -> None:
        until[0] = world.now + seconds
        world.handshake.step()
        assert world.handshake.snapshot.error_code == ConnectionLostError.code

    monkeypatch.setattr(world.transport, "read_request", request)
    monkeypatch.setattr(world.transport, "read_signal", signal)
    world.at["pose"] = cut
    end = world.mill()
    assert end.success, end.message
    times = 1 if marked else 2
    assert world.handshake.snapshot.request_number == times
    assert [name for name, _ in world.told].count("picture") == times


@pytest.mark.parametrize("step", [3600.0, -3600.0])
@pytest.mark.parametrize("stage", ["picture", "pose"])
def test_a_door_is_measured_anew_when_the_clock_is_set(world: World, stage: str, step: float) -> None:
    """By stamps of two clocks nobody could tell this door's pose from another's."""
    good = world.localization, replace(world.targets, largest_correction=3e-3)
    old, world.targets = Answer(False, 206, "the picture is 3600 s old"), Answer(False, 310, "of no pose")

    def set_clock() -> None:
        world.shift = step
        if stage == "picture":
            world.localization = old

    def go_on() -> None:
        world.localization, world.targets = good

    world.at |= {stage: set_clock, "step": go_on}
    end = world.mill()
    assert end.success, end.message
    assert end.largest_correction == 3e-3
    assert end.times.picture_to_pose == pytest.approx(0.1, abs=1e-6)
    assert world.was_set == world.run.steps == [pytest.approx(step, abs=0.5)]
    # Made known again, with a stamp of the clock that was set.
    assert world.asked == 2


def test_a_picture_from_before_the_request_does_not_count(world: World) -> None:
    world.absent.add("localization")

    def early() -> None:
        world.run.deliver("localization", Answer(False, 204, "not clamped yet"), EPOCH + world.now)

    world.at["picture"] = early
    assert_refused(world.mill(), StageTimeoutError.code, "no picture of the door")


@pytest.mark.parametrize(
    ("stage", "absent"),
    [
        ("picture", "request"),
        ("pose", "targets"),
        ("targets", "handshake"),
        ("ready", "read"),
        ("milling", "milling"),
    ],
)
def test_a_canceled_run_waits_for_nothing_more(world: World, stage: str, absent: str) -> None:
    def cancel() -> None:
        world.absent.add(absent)
        world.run.cancel()

    world.at[stage] = cancel
    end = world.mill()
    assert_refused(end, RunCanceledError.code, "canceled")
    assert world.told[-1][0] == stage
    assert end.recipe_version == 4


def test_a_fault_while_milling_ends_the_run(world: World) -> None:
    world.end_signal = signals.FAULT
    assert_refused(world.mill(), MillingFaultError.code, "fault while milling")
    assert world.read


def test_what_is_no_refusal_is_left_to_the_caller(world: World) -> None:
    world.folder = world.folder / "away"
    with pytest.raises(FileNotFoundError):
        world.mill()


def test_a_door_that_was_measured_says_how_far_off_it_is(world: World) -> None:
    world.present, world.inspection = GAUGE, MeasuredDoor("hinge_1", 0.31e-3, 0.5e-3)
    end = world.mill()
    assert (end.success, end.milled, end.error_code, end.inspection) == (True, True, 0, world.inspection)
    assert end.message.endswith("; hinge_1 is 0.31 mm off where 0.50 mm are allowed")


@pytest.mark.parametrize(("deviation", "words"), [(1.6e-3, "1.60 mm"), (float("nan"), "nan mm")])
def test_a_door_beyond_its_tolerance_is_no_success(world: World, deviation: float, words: str) -> None:
    world.present, world.inspection = GAUGE, MeasuredDoor("lock_case", deviation, 0.5e-3)
    end = world.mill()
    assert (end.success, end.milled, end.error_code) == (False, True, OutOfToleranceError.code)
    assert f"milled, out of tolerance, lock_case is {words} off where 0.50 mm are allowed" in end.message
    # It was milled: the file that did it is evidence.
    assert Path(end.target_file).read_bytes() == world.read
    assert end.sha256 == hashlib.sha256(world.read).hexdigest()


def test_a_door_that_nobody_measures_is_not_called_good(world: World) -> None:
    world.inspection = MeasuredDoor("hinge_1", 0.0, 0.5e-3)
    world.inspected_after = 1000
    end = world.mill()
    assert end.success
    assert not end.inspection.measured
    assert end.message.endswith("; not measured")


@pytest.mark.parametrize(
    ("left", "waits"),
    [(GAUGE, True), (frozenset(), False), (frozenset({"another"}), False), (GAUGE | {"another"}, True)],
    ids=["silent", "gone", "started again", "joined"],
)
def test_a_door_is_not_measured_when_nobody_tells_of_it(
    world: World, left: frozenset[str], waits: bool
) -> None:
    world.present, world.inspected_after = GAUGE, 1000
    begun: list[float] = []
    found = world.found

    def look(run_id: str) -> MeasuredDoor | None:
        begun.append(world.now)
        world.present = left
        return found(run_id)

    world.found = look
    end = world.mill()
    assert (end.success, end.inspection) == (True, MeasuredDoor())
    waited = world.now - begun[0]
    assert LIMITS.inspection <= waited < LIMITS.inspection + 1.0 if waits else waited < 1.0


@pytest.mark.parametrize(
    ("stage", "node", "absent"),
    [
        ("recipe", "recipe_database", "recipe"),
        ("recipe", "controller_simulator", "request"),
        ("picture", "door_localizer", "localization"),
        ("picture", "path_generator", "localization"),
        ("pose", "path_generator", "targets"),
        ("ready", "controller_simulator", "read"),
        ("milling", "controller_simulator", "milling"),
    ],
)
def test_a_dead_node_ends_the_run_before_the_stages_limit(
    world: World, stage: str, node: str, absent: str
) -> None:
    died: list[float] = []

    def die() -> None:
        died.append(world.now)
        world.dead.add(node)
        world.absent.add(absent)

    world.at[stage] = die
    assert_refused(world.mill(), NodeDeadError.code, f"/{node} is dead")
    assert world.now - died[0] < 1.0


@pytest.mark.parametrize(("stage", "node"), [("pose", "door_localizer"), ("targets", "path_generator")])
def test_a_node_that_has_done_its_part_is_not_missed(world: World, stage: str, node: str) -> None:
    world.at[stage] = lambda: world.dead.add(node)
    assert world.mill().success


def test_nobody_is_asked_while_two_nodes_of_one_name_are_alive(world: World) -> None:
    world.unsettled = 1000
    assert_refused(world.mill(), StageTimeoutError.code, "two nodes of one name")
    assert world.asked == 0


@pytest.mark.parametrize("first", ["targets", "localization"])
def test_targets_of_a_pose_that_was_found_for_another_run_do_not_count(world: World, first: str) -> None:
    """A localizer that has not heard of the run yet finds the door before; its pose meets this run's recipe."""
    wrong = replace(world.targets, largest_correction=9e-3)

    def overtake() -> None:
        # Of a picture of which no localization came under this run.
        world.run.deliver("targets", wrong, EPOCH + world.now - 0.05)

    if first == "targets":
        require = world.require

        def before(names: Sequence[str]) -> None:
            overtake()
            require(names)

        world.require = before
    else:
        world.at["pose"] = overtake
    end = world.mill()
    assert end.success, end.message
    assert end.largest_correction == 2e-3


def test_targets_may_be_heard_of_before_the_localization_of_their_picture(world: World) -> None:
    world.absent = {"localization", "targets"}

    def both() -> None:
        pictured = EPOCH + world.now
        world.run.deliver("targets", world.targets, pictured)
        world.run.deliver("localization", world.localization, pictured)

    require = world.require

    def swapped(names: Sequence[str]) -> None:
        both()
        require(names)

    world.require = swapped
    assert world.mill().success
