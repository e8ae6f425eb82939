"""Nodes start without the libraries that only others need, or that nothing needs before a run has ended."""

from __future__ import annotations

import pytest

from support.loaded_modules import loaded

#: Of a node: what it must not import, and some lines that do on one message what its first door asks for.
NODES = {
    "bag_recorder": ("sqlalchemy rosbags.rosbag2 pydantic scipy shapely", ""),
    "recipe_database": (
        "scipy.interpolate scipy.optimize cv2 pinocchio sqlalchemy.dialects.postgresql",
        """
        from std_msgs.msg import Header
        from doormill_ros.nodes.convert.recipe import recipe_message
        from doormill_ros.recipes.documents import shipped_recipes
        for recipe in shipped_recipes().values(): recipe_message(recipe, "", Header())
        """,
    ),
    "abb_bridge": (
        "scipy.interpolate scipy.optimize cv2 pinocchio sqlalchemy",
        """
        from doormill_interfaces.msg import TargetArray
        from doormill_ros.abb.target_file.rehearsal import PROGRAM, rehearse
        from doormill_ros.messages.from_message import program_of
        from doormill_ros.nodes.convert.program import program_into
        rehearse(program_of(program_into(TargetArray(), PROGRAM)))
        """,
    ),
    "path_generator": ("scipy.interpolate scipy.optimize cv2 sqlalchemy", ""),
    "door_localizer": ("sqlalchemy pinocchio matplotlib", ""),
    "cell_simulator": ("sqlalchemy pinocchio matplotlib lark uvicorn starlette cryptography", ""),
}


@pytest.mark.parametrize("node", NODES)
def test_a_node_starts_without_what_it_does_not_need(node: str) -> None:
    unwanted, first_door = NODES[node]
    names = loaded("\n".join([f"import doormill_ros.nodes.{node}", *map(str.strip, first_door.splitlines())]))
    assert "rclpy" in names
    assert names & set(unwanted.split()) == set()
