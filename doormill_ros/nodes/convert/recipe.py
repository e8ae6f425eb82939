"""Recipes."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

from std_msgs.msg import Header

from doormill_interfaces.msg import DoorFeature, DoorRecipe, RecipeSummary
from doormill_ros.frames import DOOR_FRAME
from doormill_ros.nodes.convert.geometry import pose_message
from doormill_ros.recipes.recipe import Recipe

if TYPE_CHECKING:  # the database's libraries are of use to its own node alone
    from doormill_ros.recipes.store.database import RecipeRecord


def recipe_message(recipe: Recipe, run_id: str, header: Header) -> DoorRecipe:
    """A recipe for a run; the JSON document is what `messages.from_message.recipe_of` reads."""
    header.frame_id = DOOR_FRAME
    return DoorRecipe(
        header=header,
        run_id=run_id,
        door_id=recipe.door_id,
        bar_code=recipe.bar_code,
        version=recipe.version,
        author=recipe.author,
        created=recipe.created.isoformat() if recipe.created else "",
        width=recipe.width,
        height=recipe.height,
        thickness=recipe.thickness,
        hinge_side=recipe.hinge_side.value,
        material=recipe.material.value,
        mass=recipe.mass,
        features=[
            DoorFeature(
                id=feature.id,
                kind=feature.kind,
                pose=pose_message(recipe.T_door_feature(feature)),
                depth=feature.cut_depth(recipe.size),
                tool=feature.tool.name,
                document=json.dumps(document, sort_keys=True),
            )
            for feature, document in zip(recipe.features, recipe.to_document()["features"], strict=True)
        ],
        document=json.dumps(recipe.to_document(), sort_keys=True),
    )


def summary_message(record: RecipeRecord) -> RecipeSummary:
    """One line of a recipe list."""
    return RecipeSummary(
        door_id=record.door_id,
        bar_code=record.bar_code,
        version=record.version,
        author=record.author,
        created=record.created.isoformat(),
    )
