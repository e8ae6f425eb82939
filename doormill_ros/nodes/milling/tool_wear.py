"""What the runs of a cell cut, counted in the table of tools."""

from __future__ import annotations

from functools import partial

from doormill_interfaces.msg import AbbStatus, RunResult, TargetArray
from doormill_ros.abb.handshake.state import HandshakeState
from doormill_ros.cell.graph.two_robots import in_robot
from doormill_ros.messages.from_message import program_of
from doormill_ros.nodes.base import topics
from doormill_ros.nodes.base.managed_node import ManagedNode
from doormill_ros.nodes.base.robots import ROBOTS
from doormill_ros.recipes.recipe import Recipe
from doormill_ros.recipes.store.tool_table import ToolTable
from doormill_ros.recipes.tabled_tool import TabledTool
from doormill_ros.toolpath.mills.tool_life import cut_lengths

#: Once the robot has taken its file a run counts whole: how far it came before it broke off nobody knows.
TAKEN = (HandshakeState.MILLING.value, HandshakeState.DONE.value)
#: Where robots tell of what they do: the only one in the cell, two of them each in a namespace.
PLACES = ("", *map(in_robot, ROBOTS))


class ToolWear:
    """Notes what a run is going to cut when its targets come, and counts it when the robot has taken them.

    Of two robots each share is noted and counted for itself: one of them may mill its own and the other never begin.

    Args:
        node: That hears targets, status and results.
        table: Of the database.
    """

    def __init__(self, node: ManagedNode, table: ToolTable) -> None:
        self._table = table
        self._run_id = ""
        self._counted = dict.fromkeys(PLACES, "")
        self._recipe: Recipe | None = None
        for place in PLACES:
            node.subscribe(topics.at(topics.PATH_TARGETS, place), partial(self._expect, place))
            node.subscribe(topics.at(topics.ABB_STATUS, place), partial(self._watch, place))
        node.subscribe(topics.RUN_RESULT, self._end)

    def begin(self, run_id: str, recipe: Recipe) -> None:
        """A run has begun with this recipe."""
        tabled = any(isinstance(tool, TabledTool) for tool in recipe.tools.values())
        self._run_id, self._recipe = run_id, recipe if tabled else None

    def _expect(self, place: str, targets: TargetArray) -> None:
        if targets.accepted and self._recipe is not None and targets.run_id == self._run_id:
            metres = cut_lengths(program_of(targets), self._recipe)
            self._table.expect(_share(self._run_id, place), metres)

    def _watch(self, place: str, status: AbbStatus) -> None:
        if status.state in TAKEN:
            self._count(place, status.run_id)

    def _end(self, result: RunResult) -> None:
        # Success was told of runs whose milling this node has not seen.
        if result.success:
            for place in PLACES:
                self._count(place, result.run_id)

    def _count(self, place: str, run_id: str) -> None:
        if run_id and run_id != self._counted[place]:
            self._table.count(_share(run_id, place))
            self._counted[place] = run_id


def _share(run_id: str, place: str) -> str:
    """Under which name the table knows what is cut in a run by the robot of a place."""
    return f"{run_id}/{place}" if place else run_id
