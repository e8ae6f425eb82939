"""Tools that wait in a rack and what holds them: for whom they are in the way, and when.

A tool is in its place while the spindle does not have it. An empty spindle that comes for it along the line into the
place may meet it there, and one that has it or comes for it may meet its holder. Nothing else of the robot may, and
nowhere else.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from doormill_ros.arrays import BoolArray, FloatArray
from doormill_ros.frames import inverse, transform
from doormill_ros.recipes.recipe import Recipe
from doormill_ros.recipes.tabled_tool import TabledTool
from doormill_ros.simulation.controller.records.executed_path import ExecutedPath
from doormill_ros.simulation.judge.bodies import Box, JudgedCell, JudgedPlace
from doormill_ros.simulation.judge.links import BASE, FLANGE
from doormill_ros.simulation.judge.sweep import Meeting, Sweep

ASIDE = 2e-3  #: a spindle this close to the line into a place is on its way into it or out of it [m]
TILTED = 5e-3  #: and turned out of the line's direction by no more than this, as the sine
NONE = ""  #: what an empty spindle carries


@dataclass(frozen=True, eq=False)
class InRack:
    """A tool that waits in its place, or what holds it there.

    Attributes:
        box: What it takes up, in the base frame of the robot whose rack it is.
        place: Where.
        tool: It is the tool, which is there while the spindle does not have it.
    """

    box: Box
    place: JudgedPlace
    tool: bool

    def there(self, carried: str) -> bool:
        """Whether it is in its place while the spindle has a tool, by its name."""
        return not self.tool or carried != self.place.tool

    def in_the_way(
        self, met: Meeting, sweep: Sweep, executed: ExecutedPath, first: str, link: str
    ) -> Meeting:
        """What of a meeting is none that a change of tools needs.

        Args:
            met: Where a body of the robot met it.
            sweep: The robot between its samples.
            executed: What it did.
            first: Tool in the spindle where nobody watched it.
            link: Link of the body, the flange for spindle and mill.
        """
        if not len(met.place):
            return met
        carried = carried_by(executed, first)
        kept = np.ones(len(met.place), dtype=bool)
        changing = self._entered(sweep.link(FLANGE, met.place)) & (link == FLANGE)
        for sample in (np.floor(met.place).astype(int), np.ceil(met.place).astype(int)):
            own = carried[sample] == self.place.tool
            changing &= own | (carried[sample] == NONE)
            kept &= ~(own & self.tool)
        return met.only(kept & ~changing)

    def _entered(self, T_base_flange: FloatArray) -> BoolArray:
        """Where a spindle at poses (n, 4, 4) is on the line into the place, between its front and its seat."""
        own = inverse(self.place.T_base_seat) @ T_base_flange
        aside, along = np.linalg.norm(own[:, :2, 3], axis=1), own[:, 2, 3]
        tilt = np.linalg.norm(own[:, :2, 2], axis=1)
        within = (along <= ASIDE) & (along >= -self.place.depth - ASIDE)
        entered: BoolArray = within & (aside <= ASIDE) & (tilt <= TILTED)
        return entered


def in_rack(cell: JudgedCell, recipe: Recipe) -> Iterator[InRack]:
    """Holder and tool of every place of the rack; a tool that the recipe does not know is as wide as any may be."""
    for place in cell.rack:
        yield InRack(place.holder, place, tool=False)
        known = recipe.tools.get(place.tool)
        radius = cell.widest if known is None else known.radius
        length = known.length if isinstance(known, TabledTool) else cell.nose
        nose = float(cell.T_flange_tool[2, 3]) - cell.nose
        at = place.T_base_seat @ transform(translation=np.array([0.0, 0.0, nose + length / 2.0]))
        box = Box(f"tool {place.tool}", BASE, at, np.array([radius, radius, length / 2.0]))
        yield InRack(box, place, tool=True)


def first_tool(cell: JudgedCell) -> str:
    """The tool that is in the spindle between doors: that of the first place."""
    return cell.rack[0].tool if cell.rack else NONE


def carried_by(executed: ExecutedPath, first: str) -> np.ndarray[tuple[int], np.dtype[np.str_]]:
    """The tool in the spindle at each sample, shape (n,), str; `first` where nobody watched."""
    return np.full(len(executed), first) if executed.tool is None else executed.tool
