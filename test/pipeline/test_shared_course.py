"""A run that two robots share: nothing is milled unless both can, one moves at a time, and the run ends by itself."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import pytest

from doormill_ros.cell.errors import NodeDeadError, RunCanceledError, StageTimeoutError
from doormill_ros.cell.output.inspection import MeasuredDoor
from doormill_ros.cell.output.summary import StageDurations
from doormill_ros.cell.run.clock import Clock
from doormill_ros.cell.run.run import Run, StageLimits
from doormill_ros.pipeline.partners import RecipeAnswer
from doormill_ros.pipeline.run_end import RunEnd
from doormill_ros.pipeline.shared_course import SharedCourse

LIMITS = StageLimits(
    recipe=3.0, picture=4.0, targets=5.0, request=6.0, ready=7.0, read=8.0, milling=9.0, inspection=10.0
)


@dataclass
class End:
    """How a robot's share ended."""

    success: bool = True
    error_code: int = 0
    message: str = "milled"
    target_file: str = "/targets/robot/run-1.txt"
    sha256: str = "ab"
    largest_correction: float = 1e-4
    robot_model: str = "irb"
    model_version: int = 3


class Robot:
    """A robot that plans when it is asked and mills when it is given the word, each after a turn of the world."""

    def __init__(self, name: str, world: World) -> None:
        self.name = name
        self.world = world
        self.present = True
        self.planned = False
        self.refusal: End | None = None  # of its planning
        self.fault: End | None = None  # of its milling
        self.silent = False  # never gets its targets
        self.dead = False
        self.dies_at_work = False
        self.asked = self.milling = False
        self.end: End | None = None

    def begin(self, door_id: str, run_id: str) -> None:
        self.world.log.append(f"{self.name} asked")
        self.asked = True

    def give_word(self, run_id: str) -> None:
        assert run_id == "run-1"
        self.world.log.append(f"{self.name} may mill")
        self.milling = True

    def cancel(self) -> None:
        self.world.log.append(f"{self.name} canceled")
        if not self.dead:
            self.end = End(success=False, error_code=803, message="canceled", target_file="")

    def require(self) -> None:
        if self.dead:
            raise NodeDeadError(f"the bridge of the {self.name} robot is dead")

    def times(self) -> StageDurations:
        return StageDurations(request_to_ready=1.0 if self.name == "first" else 2.0)

    def turn(self) -> None:
        if not self.asked or self.end is not None or self.dead:
            return
        if self.milling:
            self.dead = self.dies_at_work
            if not self.dead:
                self.world.log.append(f"{self.name} done")
                self.end = self.fault or End(target_file=f"/targets/{self.name}/run-1.txt")
        elif self.refusal is not None:
            self.end = self.refusal
        elif not self.silent:
            self.planned = True


class World:
    """Database, two robots and inspector; they move on by one turn whenever the run looks at its clock."""

    def __init__(self) -> None:
        self.now = 0.0
        self.log: list[str] = []
        self.robots = [Robot("first", self), Robot("second", self)]
        self.run = Run("run-1", "oak", Clock(self.turn, lambda: 1.7e9 + self.now))
        self.answer = RecipeAnswer(True, 0, "", 4)
        self.workers = ("first", "second")
        self.ready, self.present = True, frozenset({"gauge"})
        self.inspection = MeasuredDoor("hinge_1", 1e-4, 5e-4)
        self.at: dict[str, Callable[[], None]] = {}

    def turn(self) -> float:
        self.now += 0.25
        for robot in self.robots:
            robot.turn()
        return self.now

    def ask(self, door_id: str, run_id: str, hear: Callable[[RecipeAnswer], None]) -> None:
        hear(self.answer)

    def found(self, run_id: str) -> MeasuredDoor | None:
        return self.inspection

    def mill(self) -> RunEnd:
        tell = lambda stage, share: self.at.pop(stage, lambda: None)()  # noqa: E731
        return SharedCourse(self.run, self, self.robots, lambda: self.workers, self, LIMITS, tell).mill()


@pytest.fixture
def world() -> World:
    return World()


def test_the_second_robot_may_mill_when_the_first_is_done_and_the_run_ends_with_both(world: World) -> None:
    end = world.mill()
    assert (end.success, end.error_code, end.recipe_version, end.model_version) == (True, 0, 4, 3)
    assert world.log == [
        "first asked",
        "second asked",
        "first may mill",
        "first done",
        "second may mill",
        "second done",
    ]
    assert end.target_file == "/targets/first/run-1.txt"
    assert "first robot by run-1.txt, second robot by run-1.txt" in end.message
    assert end.times.request_to_ready == 2.0


def test_a_robot_without_a_share_is_not_asked(world: World) -> None:
    world.workers = ("second",)
    world.robots[0].present = False
    assert world.mill().success
    assert world.log == ["second asked", "second may mill", "second done"]


@pytest.mark.parametrize("who", [0, 1])
def test_a_door_that_one_of_them_cannot_mill_is_not_begun(world: World, who: int) -> None:
    world.robots[who].refusal = End(success=False, error_code=310, message="out of reach")
    end = world.mill()
    assert (end.success, end.error_code, end.target_file) == (False, 310, "")
    assert f"{world.robots[who].name} robot: out of reach" in end.message
    assert not any("may mill" in line for line in world.log)
    assert f"{world.robots[1 - who].name} canceled" in world.log


@pytest.mark.parametrize("who", [0, 1])
def test_without_one_of_the_bridges_no_robot_is_asked(world: World, who: int) -> None:
    world.robots[who].present = False
    end = world.mill()
    assert (end.success, end.error_code) == (False, StageTimeoutError.code)
    assert f"the {world.robots[who].name} robot takes no goals" in end.message
    assert world.log == []


@pytest.mark.parametrize("who", [0, 1])
def test_a_robot_without_targets_keeps_both_from_milling(world: World, who: int) -> None:
    world.robots[who].silent = True
    assert world.mill().error_code == StageTimeoutError.code
    assert world.log == ["first asked", "second asked", "first canceled", "second canceled"]


def test_after_a_fault_of_the_first_the_second_does_not_begin(world: World) -> None:
    world.robots[0].fault = End(success=False, error_code=491, message="stopped with a fault")
    end = world.mill()
    assert (end.error_code, end.target_file) == (491, "")
    assert "second may mill" not in world.log
    assert "second canceled" in world.log


def test_a_fault_of_the_second_tells_that_the_first_has_milled(world: World) -> None:
    world.robots[1].fault = End(success=False, error_code=491, message="stopped with a fault")
    end = world.mill()
    assert (end.success, end.error_code) == (False, 491)
    assert end.message.endswith("the first robot has milled its share")


@pytest.mark.parametrize("who", [0, 1])
def test_a_bridge_that_dies_before_milling_ends_the_run_with_nothing_milled(world: World, who: int) -> None:
    world.at["picture"] = lambda: setattr(world.robots[who], "dead", True)
    end = world.mill()
    assert end.error_code == NodeDeadError.code
    assert not any("may mill" in line for line in world.log)


def test_a_bridge_that_dies_while_its_robot_mills_keeps_the_other_one_still(world: World) -> None:
    world.robots[0].dies_at_work = True
    end = world.mill()
    assert (end.success, end.error_code) == (False, NodeDeadError.code)
    assert "second may mill" not in world.log


def test_who_cancels_cancels_both(world: World) -> None:
    world.at["picture"] = world.run.cancel
    world.robots[0].silent = True
    assert world.mill().error_code == RunCanceledError.code
    assert {"first canceled", "second canceled"} <= set(world.log)
