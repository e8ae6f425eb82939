"""What the runs of a cell cut, counted in the table of tools."""

from __future__ import annotations

from doormill_interfaces.msg import AbbStatus, RunResult, TargetArray
from doormill_ros.abb.handshake.state import HandshakeState
from doormill_ros.messages.from_message import program_of
from doormill_ros.nodes import topics
from doormill_ros.nodes.managed_node import ManagedNode
from doormill_ros.recipes.recipe import Recipe
from doormill_ros.recipes.store.tool_table import ToolTable
from doormill_ros.recipes.tabled_tool import TabledTool
from doormill_ros.toolpath.tool_life import cut_lengths

#: Once the robot has taken its file a run counts whole: how far it came before it broke off nobody knows.
TAKEN = (HandshakeState.MILLING.value, HandshakeState.DONE.value)


class ToolWear:
    """Notes what a run is going to cut when its targets come, and counts it when the robot has taken them.

    Args:
        node: That hears targets, status and results.
        table: Of the database.
    """

    def __init__(self, node: ManagedNode, table: ToolTable) -> None:
        self._table = table
        self._run_id = self._counted = ""
        self._recipe: Recipe | None = None
        node.subscribe(topics.PATH_TARGETS, self._expect)
        node.subscribe(topics.ABB_STATUS, self._watch)
        node.subscribe(topics.RUN_RESULT, self._end)

    def begin(self, run_id: str, recipe: Recipe) -> None:
        """A run has begun with this recipe."""
        tabled = any(isinstance(tool, TabledTool) for tool in recipe.tools.values())
        self._run_id, self._recipe = run_id, recipe if tabled else None

    def _expect(self, targets: TargetArray) -> None:
        if targets.accepted and self._recipe is not None and targets.run_id == self._run_id:
            self._table.expect(self._run_id, cut_lengths(program_of(targets), self._recipe))

    def _watch(self, status: AbbStatus) -> None:
        if status.state in TAKEN:
            self._count(status.run_id)

    def _end(self, result: RunResult) -> None:
        # Success was told of runs whose milling this node has not seen.
        if result.success:
            self._count(result.run_id)

    def _count(self, run_id: str) -> None:
        if run_id and run_id != self._counted:
            self._table.count(run_id)
            self._counted = run_id
