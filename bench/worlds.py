"""Every shipped door in every world that its maker does not know, and with weights that he knows of: walls of both."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "test"))

from doormill_ros.arrays import FloatArray
from doormill_ros.cell.places.layout import DoorOffset
from doormill_ros.pipeline.plan import MillingSetup, load_setup, plan
from doormill_ros.recipes.documents import shipped_recipes
from doormill_ros.recipes.recipe import Recipe
from doormill_ros.toolpath.errors import ExpectedErrorError
from doormill_ros.units import m_to_mm
from support.milled_worlds import TOLD, WORLDS, MilledFile, both_files, wall_errors
from support.told_makers import told


def main() -> None:
    """Print, for each door and world, the feature that the correction serves worst."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("doors", nargs="*", help="shipped doors; all of them when none is named")
    setup, recipes = load_setup(), shipped_recipes()
    print(f"{'door':20s} {'world':36s} {'feature':14s} corrected  plain  difference [mm]")
    for name in parser.parse_args().doors or list(recipes):
        recipe = recipes[name]
        p = recipe.placement
        offset = DoorOffset(p.y, p.z, p.rotation) if p else DoorOffset()
        T_base_door = setup.layout.T_base_door(recipe.width, recipe.thickness, offset)

        unaware = files(recipe, T_base_door, setup)
        for world, truth in WORLDS.items():
            show(name, world, wall_errors(recipe, T_base_door, unaware, truth))
        for world, (*_, truth) in TOLD.items():
            try:
                aware = files(recipe, T_base_door, told(setup, world))
            except ExpectedErrorError as refusal:
                print(f"{name:20s} {world:36s} refused: {refusal.message}", flush=True)
            else:
                show(name, world, wall_errors(recipe, T_base_door, aware, truth))


def files(recipe: Recipe, T_base_door: FloatArray, maker: MillingSetup) -> tuple[MilledFile, ...]:
    """What a maker mills a door with, and the same without corrections."""
    program = plan(recipe, T_base_door, maker).program
    return both_files(program, maker.robot.dh, maker.layout.T_flange_tool)


def show(name: str, world: str, walls: dict[str, tuple[float, float]]) -> None:
    """Print the feature that the correction serves worst."""
    worst = max(walls, key=lambda feature: walls[feature][0] - walls[feature][1])
    corrected, plain = (m_to_mm(value) for value in walls[worst])
    print(
        f"{name:20s} {world:36s} {worst:14s} {corrected:9.3f} {plain:6.3f} {corrected - plain:+.3f}",
        flush=True,
    )


if __name__ == "__main__":
    main()
