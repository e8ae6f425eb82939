"""The course of a run that two robots share: nothing is milled unless both can, and one moves at a time."""

from __future__ import annotations

import threading
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import fields
from functools import partial
from typing import Protocol

from doormill_ros.cell.errors import CellError, StageRefusedError
from doormill_ros.cell.output.summary import StageDurations
from doormill_ros.cell.run.run import TARGETS, Run, StageLimits
from doormill_ros.cell.run.waiting import wait_until
from doormill_ros.errors import DoormillError
from doormill_ros.pipeline.inspection_stage import await_inspection
from doormill_ros.pipeline.partners import Inspector, Recipes
from doormill_ros.pipeline.recipe_stage import fetch_recipe
from doormill_ros.pipeline.run_end import RunEnd

LETTING_GO = 10.0  # s, for a robot to give up its share


class ShareEnd(Protocol):
    """How a robot's share ended: the result of its goal."""

    success: bool
    error_code: int
    message: str
    target_file: str
    sha256: str
    largest_correction: float
    robot_model: str
    model_version: int


class ShareRobot(Protocol):
    """One of the robots as the run sees it; lets the run look again after each change."""

    @property
    def name(self) -> str:
        """Which of the two: "first" or "second"."""

    @property
    def present(self) -> bool:
        """Its bridge takes goals."""

    @property
    def planned(self) -> bool:
        """It has its targets and waits for the word."""

    @property
    def end(self) -> ShareEnd | None:
        """How its share ended, None while it goes on."""

    def begin(self, door_id: str, run_id: str) -> None:
        """Ask it for its share."""

    def give_word(self, run_id: str) -> None:
        """Let it mill."""

    def cancel(self) -> None:
        """Let it give up what is not done."""

    def require(self) -> None:
        """Let a run go on that needs it.

        Raises:
            NodeDeadError: Its bridge has died.
        """

    def times(self) -> StageDurations:
        """How long its stages took, once its share has ended."""


class SharedCourse:
    """A run from the recipe to the end of milling by two robots.

    Args:
        run: The run in hand.
        recipes: Where its recipe comes from.
        robots: Both of them, in the order in which they mill.
        workers: Names of those that have something to mill, None while the recipe has not come.
        inspector: Who measures the milled door.
        limits: How long it waits for each stage.
        tell: Called with each stage's name and the share of the run that is done, 0..1.

    Attributes:
        end: How it ended, as far as it got.
    """

    def __init__(
        self,
        run: Run,
        recipes: Recipes,
        robots: Sequence[ShareRobot],
        workers: Callable[[], Sequence[str] | None],
        inspector: Inspector,
        limits: StageLimits,
        tell: Callable[[str, float], None] = lambda stage, progress: None,
    ) -> None:
        self._run = run
        self._recipes = recipes
        self._robots = tuple(robots)
        self._workers = workers
        self._inspector = inspector
        self._limits = limits
        self._tell = tell
        self._begun: list[ShareRobot] = []
        self.end = RunEnd(run.run_id, run.door_id)

    def mill(self) -> RunEnd:
        """Go through all stages; what ends the run before is told, not raised."""
        try:
            self._tell("recipe", 0.0)
            self.end.recipe_version = fetch_recipe(self._run, self._recipes, self._limits.recipe)
            working = self._begin()
            self._plan(working)
            for number, robot in enumerate(working):
                self._tell("milling", 0.4 + 0.6 * number / len(working))
                self._mill(robot)
            self._tell("milling", 1.0)
            self._note(working)
            measured = await_inspection(self._run, self._inspector, self._limits.inspection)
            self.end.note_shares_milled({r.name: e.target_file for r in working if (e := r.end)}, measured)
        except DoormillError as error:
            done = [robot.name for robot in self._begun if robot.end is not None and robot.end.success]
            self._let_go()
            said = f"; the {done[0]} robot has milled its share" if done else ""
            self.end.refuse(error.code, f"{error.message}{said}")
        return self.end

    def _begin(self) -> list[ShareRobot]:
        """Ask every robot that has something to mill for its share; all of them have to be there."""
        run, limits = self._run, self._limits
        names = run.wait_until(
            self._workers,
            limits.recipe,
            "the recipe was not made known; check that /recipe_database is active",
        )
        working = [robot for robot in self._robots if robot.name in names]

        def require() -> None:
            for robot in working:
                robot.require()

        run.require = require
        for robot in working:
            run.wait_until(
                partial(getattr, robot, "present"),
                limits.request,
                f"the {robot.name} robot takes no goals; check that its /abb_bridge is active",
            )
        for robot in working:
            self._begun.append(robot)
            robot.begin(run.door_id, run.run_id)
        return working

    def _plan(self, working: Sequence[ShareRobot]) -> None:
        """Wait until every robot has its targets: a door that one of them cannot mill is not begun."""
        limits = self._limits
        self._tell("picture", 0.1)

        def planned() -> bool:
            for robot in working:
                self._refused(robot)
            return all(robot.planned for robot in working)

        self._run.wait_until(
            planned,
            limits.recipe + limits.request + limits.picture + limits.targets,
            "the robots did not get their targets; see their results",
        )
        self._tell(TARGETS, 0.4)

    def _mill(self, robot: ShareRobot) -> None:
        """Let one robot mill; the others wait."""
        run, limits = self._run, self._limits
        robot.give_word(run.run_id)

        def milled() -> bool:
            for other in self._begun:
                self._refused(other)
            return robot.end is not None

        run.wait_until(
            milled,
            limits.ready + limits.read + limits.milling + limits.inspection,
            f"the {robot.name} robot did not end its share; look at its pendant",
        )

    @staticmethod
    def _refused(robot: ShareRobot) -> None:
        end = robot.end
        if end is not None and not end.success:
            raise StageRefusedError(f"{robot.name} robot: {end.message}", end.error_code)

    def _let_go(self) -> None:
        """Let every robot give up what it has not done, and wait for that."""
        for robot in self._begun:
            if robot.end is None:
                robot.cancel()
        with suppress(CellError):  # what ended the run counts more
            wait_until(
                threading.Condition(),
                lambda: all(robot.end is not None or _dead(robot) for robot in self._begun),
                LETTING_GO,
                "a robot did not give up its share",
            )

    def _note(self, working: Sequence[ShareRobot]) -> None:
        """What the shares were milled with; of the times the longer ones."""
        end = self.end
        shares = [share for robot in working if (share := robot.end) is not None]
        end.largest_correction = max(share.largest_correction for share in shares)
        end.robot_model, end.model_version = shares[0].robot_model, shares[0].model_version
        end.target_file, end.sha256 = shares[0].target_file, shares[0].sha256
        times = [robot.times() for robot in working]
        end.times = StageDurations(
            *(max(getattr(one, field.name) for one in times) for field in fields(StageDurations))
        )


def _dead(robot: ShareRobot) -> bool:
    try:
        robot.require()
    except CellError:
        return True
    return False
