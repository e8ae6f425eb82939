"""The door with its features, and what the robot was told along them."""

from __future__ import annotations

import base64
import json
from html import escape
from typing import Any

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.frames import apply, inverse
from doormill_ros.messages.from_message import program_of, transform_of
from doormill_ros.recipes.drawing import draw_recipe
from doormill_ros.recipes.recipe import Recipe

EXAGGERATION = 20.0  # corrections are tenths of a millimetre, holes are some ten millimetres wide
NOMINAL, CORRECTED = "#1a73c8", "#d04a1a"


def door_figure(recipe: Any, targets: Any, pose: Any) -> str:
    """The drawing of a recipe as an <img> element; with targets and a pose also the paths through the features.

    Args:
        recipe: doormill_interfaces/DoorRecipe.
        targets: Accepted doormill_interfaces/TargetArray, or None.
        pose: geometry_msgs/Pose of the door in base_link, or None.
    """
    drawing = draw_recipe(Recipe.from_document(json.loads(recipe.document)))
    if targets is not None and pose is not None:
        T_door_base = inverse(transform_of(pose))
        program = program_of(targets)
        for feature in dict.fromkeys(m.feature for m in program.motions if m.feature):
            indices = [
                index
                for m in program.motions
                if m.feature == feature and m.cutting
                for index in ([] if m.via is None else [m.via]) + [m.target]
            ]
            if len(indices) < 2:
                continue
            nominal = _points(T_door_base, [program.targets[i].T_base_tool_nominal for i in indices])
            corrected = _points(T_door_base, [program.targets[i].T_base_tool_corrected for i in indices])
            drawing.overlay("nominal path", nominal, feature, NOMINAL, 1.0)
            drawing.overlay_exaggerated(
                "corrected path", nominal, corrected, EXAGGERATION, feature, CORRECTED
            )
        drawing.note(
            f"blue: path of the tool centre point through its targets; red: as corrected, shift x {EXAGGERATION:g}"
        )
    # As a picture of its own: the drawing's style sheet must not reach the rest of the page.
    data = base64.b64encode(drawing.to_svg().encode()).decode("ascii")
    return (
        f'<img src="data:image/svg+xml;base64,{data}" alt="Door {escape(recipe.door_id)} with its features">'
    )


def _points(T_door_base: FloatArray, poses: list[FloatArray]) -> FloatArray:
    return apply(T_door_base, np.array([T[:3, 3] for T in poses]))
