"""How far a program cuts with each tool, and whether the tools last for it."""

from __future__ import annotations

from doormill_ros.recipes.recipe import Recipe
from doormill_ros.recipes.tabled_tool import TabledTool
from doormill_ros.toolpath.errors import ToolLifeError
from doormill_ros.toolpath.pacing.timing import motion_lengths
from doormill_ros.toolpath.program import MillingProgram


def cut_lengths(program: MillingProgram, recipe: Recipe) -> dict[str, float]:
    """How far the tools of the table cut in the wood, by name [m].

    Args:
        program: Of one robot.
        recipe: That it was made from; what a tool of its own cuts is nobody's account.
    """
    tools = {feature.id: feature.tool for feature in recipe.features if isinstance(feature.tool, TabledTool)}
    lengths: dict[str, float] = {}
    if not tools:
        return lengths
    for motion, length in zip(program.motions, motion_lengths(program).tolist(), strict=True):
        tool = tools.get(motion.feature)
        if motion.cutting and tool is not None:
            lengths[tool.name] = lengths.get(tool.name, 0.0) + length
    return lengths


def check_life(program: MillingProgram, recipe: Recipe) -> None:
    """Refuse a program in the middle of which a tool would be worn.

    Args:
        program: Of one robot.
        recipe: That it was made from, with what its tools have cut so far.

    Raises:
        ToolLifeError: One lasts less than the program.
    """
    for name, length in cut_lengths(program, recipe).items():
        tool = recipe.tools[name]
        if isinstance(tool, TabledTool) and length > tool.left:
            raise ToolLifeError(
                f"the door takes {length:.2f} m of cut with tool {name!r}, allowed are {tool.left:.2f} m, what is left "
                f"of its {tool.life:g} m; put a new one into its place and say so (recipes tools renew {name})",
                tool=name,
                found=length,
                allowed=tool.left,
            )
