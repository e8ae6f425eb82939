"""What `recipes check` says of the standard door: targets, times and margins, milled by one robot and by two."""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from doormill_ros.pipeline.preview import preview
from doormill_ros.recipes.documents import load_recipe
from doormill_ros.toolpath.door_checks import cycle_budget, text_table

DOOR = "standard_door"


def main() -> None:
    """Print the tables of either way, and the time of the door."""
    recipe = load_recipe(DOOR)
    for robots in (1, 2):
        shares = preview(recipe, robots, "")
        for share in shares:
            print(f"{DOOR}, {robots} robots: {share.robot}")
            print(text_table(share.check))
        print(f"{robots} robots: {cycle_budget([share.check for share in shares])}")


if __name__ == "__main__":
    main()
