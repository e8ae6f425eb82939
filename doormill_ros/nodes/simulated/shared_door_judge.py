"""Node /shared_door_judge: inspects a door that two simulated robots milled, and judges how they did it."""

from __future__ import annotations

from typing import Any

import numpy as np
from std_msgs.msg import Header

from doormill_interfaces.msg import DoorPlacement, DoorRecipe, ExecutedPath
from doormill_ros.arrays import FloatArray
from doormill_ros.cell.graph.node_names import SHARED_DOOR_JUDGE
from doormill_ros.cell.graph.two_robots import FIRST, SECOND, in_robot
from doormill_ros.cell.places.tolerance import TOLERANCE
from doormill_ros.frames import DOOR_FRAME
from doormill_ros.messages.from_message import recipe_of
from doormill_ros.nodes.base import topics
from doormill_ros.nodes.base.managed_node import ManagedNode
from doormill_ros.nodes.base.reporting_node import OK
from doormill_ros.nodes.base.robots import ROBOTS
from doormill_ros.nodes.convert.executed import executed_of, milled_message, placed_at, verdict_message
from doormill_ros.simulation.judge.bodies import load_cell
from doormill_ros.simulation.judge.judged_door import judge_shared_door
from doormill_ros.simulation.judge.pair import Milled
from doormill_ros.toolpath.settings import load_settings
from doormill_ros.toolpath.split import split


class SharedDoorJudge(ManagedNode):
    """Waits for the paths of all robots that had something to mill, then inspects the door and judges the motions."""

    def __init__(self, **kwargs: Any) -> None:
        super().__init__(SHARED_DOOR_JUDGE, **kwargs)

    def setup(self) -> None:
        """Read the cell; subscribe."""
        self._settings = load_settings()
        self._cell = load_cell()
        second = self._settings.second_robot.T_base_second
        self._bases: dict[str, FloatArray] = {FIRST: np.eye(4), SECOND: second}
        self._recipe: DoorRecipe | None = None
        self._placement: DoorPlacement | None = None
        self._done: dict[str, ExecutedPath] = {}  # in the order in which they were told
        self._uncorrected: dict[str, ExecutedPath] = {}
        self._milled = self.publisher(topics.MILLED_DOOR)
        self._verdict = self.publisher(topics.RUN_VERDICT)
        self.subscribe(topics.DOOR_RECIPE, self._take_recipe)
        self.subscribe(topics.DOOR_PLACEMENT, self._take_placement)
        for robot in ROBOTS:
            place = in_robot(robot)
            self.subscribe(topics.at(topics.EXECUTED_PATH, place), self._taker(self._done, robot))
            self.subscribe(topics.at(topics.UNCORRECTED_PATH, place), self._taker(self._uncorrected, robot))

    def _take_recipe(self, message: DoorRecipe) -> None:
        self._recipe = message
        self._look()

    def _take_placement(self, message: DoorPlacement) -> None:
        self._placement = message
        self._look()

    def _taker(self, paths: dict[str, ExecutedPath], robot: str) -> Any:
        def take(message: ExecutedPath) -> None:
            paths.pop(robot, None)
            paths[robot] = message
            self._look()

        return take

    def _look(self) -> None:
        """Judge the door once all is there that is told of it."""
        recipe, placement = self._recipe, self._placement
        if recipe is None or placement is None or recipe.run_id != placement.run_id:
            return
        door = recipe_of(recipe)
        shares = split(door, np.eye(4), self._settings)
        working = [share.robot for share in shares if share.operations]
        paths = (self._done, self._uncorrected)
        if any(robot not in of or of[robot].run_id != recipe.run_id for of in paths for robot in working):
            return
        T_cell_door = placed_at(placement)
        # Also of one that had nothing to mill and moved all the same.
        order = [robot for robot, path in self._done.items() if path.run_id == recipe.run_id]
        moved = [Milled(robot, self._bases[robot], executed_of(self._done[robot])) for robot in order]
        still = [Milled(robot, self._bases[robot], None) for robot in ROBOTS if robot not in order]
        uncorrected = {
            robot: executed_of(path)
            for robot, path in self._uncorrected.items()
            if path.run_id == recipe.run_id
        }
        judged = judge_shared_door(door, T_cell_door, [*moved, *still], uncorrected, self._cell)
        self._done.clear()
        self._uncorrected.clear()
        header = Header(stamp=self.get_clock().now().to_msg(), frame_id=DOOR_FRAME)
        self._verdict.publish(verdict_message(judged.verdict, header, placement))
        parts = judged.corrected, judged.uncorrected
        self._milled.publish(milled_message(door, *parts, TOLERANCE, header, placement))
        self.report(OK, "door judged", door_id=placement.door_id, deviation=judged.corrected.worst)
