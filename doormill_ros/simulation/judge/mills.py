"""Which mill the spindle carried while it did what it did: the plant's word, not the planner's."""

from __future__ import annotations

import numpy as np

from doormill_ros.arrays import BoolArray, FloatArray
from doormill_ros.recipes.recipe import Recipe
from doormill_ros.simulation.controller.records.executed_path import ExecutedPath


def mill_radius(recipe: Recipe, executed: ExecutedPath) -> FloatArray:
    """Radius of the mill at each sample, shape (n,) [m].

    That of the tool that was in the spindle; a tool that the recipe does not know is as wide as the widest of its own.
    Where nobody changed tools, and the recipe's were put in by hand: of the feature at hand, of the last or the first.
    """
    if changes_tools(recipe, executed):
        known = {name: tool.radius for name, tool in recipe.tools.items()}
        widest = max(known.values())
        return np.array([known.get(str(name), widest) for name in _tools(executed)])
    radii = {feature.id: feature.tool.radius for feature in recipe.features}
    own = np.array([radii.get(str(name), np.nan) for name in executed.feature])
    at = np.flatnonzero(np.isfinite(own))
    if not len(at):
        return np.full(len(own), max(radii.values()))
    last = np.searchsorted(at, np.arange(len(own)), side="right") - 1
    radius: FloatArray = own[at[np.maximum(last, 0)]]
    return radius


def mill_there(recipe: Recipe, executed: ExecutedPath) -> BoolArray:
    """Whether any mill was in the spindle at each sample, shape (n,)."""
    if not changes_tools(recipe, executed):
        return np.ones(len(executed), dtype=bool)
    there: BoolArray = _tools(executed) != ""
    return there


def changes_tools(recipe: Recipe, executed: ExecutedPath) -> bool:
    """Whether the rack's tools were used: the spindle changed its own, or it is one of the recipe's."""
    if executed.tool is None:
        return False
    carried = set(executed.tool.tolist())
    return len(carried) > 1 or not carried.isdisjoint(recipe.tools)


def _tools(executed: ExecutedPath) -> np.ndarray[tuple[int], np.dtype[np.str_]]:
    assert executed.tool is not None
    return executed.tool
