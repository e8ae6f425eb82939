"""Messages are read by the names of their fields, wherever they come from."""

from __future__ import annotations

import json
import math
from types import SimpleNamespace as Message

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from doormill_ros.messages.from_message import (
    door_pose_of,
    recipe_of,
    transform_of,
    twists_of,
    wrenches_of,
)
from doormill_ros.recipes.documents import shipped_recipes
from doormill_ros.recipes.errors import RecipeError
from doormill_ros.toolpath.errors import DoorPoseError


def test_a_pose_is_the_transform_of_its_quaternion() -> None:
    rotation = Rotation.random(random_state=3)
    x, y, z, w = rotation.as_quat()
    pose = Message(position=Message(x=1.0, y=-2.0, z=3.0), orientation=Message(x=x, y=y, z=z, w=w))
    T_a_b = transform_of(pose)
    assert np.abs(T_a_b[:3, :3] - rotation.as_matrix()).max() < 1e-14
    assert T_a_b[:, 3].tolist() == [1.0, -2.0, 3.0, 1.0]


def test_wrench_and_twist_keep_their_halves_in_order() -> None:
    first, second = Message(x=1.0, y=2.0, z=3.0), Message(x=4.0, y=5.0, z=6.0)
    assert wrenches_of([Message(force=first, torque=second)]).tolist() == [[1, 2, 3, 4, 5, 6]]
    assert twists_of([Message(linear=first, angular=second)]).tolist() == [[1, 2, 3, 4, 5, 6]]
    assert wrenches_of([]).shape == (0, 6)


@pytest.mark.parametrize("value", [math.nan, math.inf, 0.0])
def test_a_pose_that_is_none_is_refused(value: float) -> None:
    place = Message(x=1.0, y=2.0, z=3.0)
    good = Message(position=place, orientation=Message(x=0.0, y=0.0, z=0.0, w=1.0))
    assert door_pose_of(good)[:3, 3].tolist() == [1.0, 2.0, 3.0]
    with pytest.raises(DoorPoseError, match="quaternion"):
        door_pose_of(Message(position=place, orientation=Message(x=0.0, y=0.0, z=0.0, w=value)))


@pytest.mark.parametrize("document", ["", "{", "[" * 5000, "9" * 5000, "null", '{"schema": NaN}'])
def test_a_document_that_is_none_is_refused(document: str) -> None:
    with pytest.raises(RecipeError):
        recipe_of(Message(document=document))


def test_a_recipe_comes_back_from_its_document_and_is_checked() -> None:
    recipe = shipped_recipes()["standard_door"]
    document = recipe.to_document()
    assert recipe_of(Message(document=json.dumps(document))) == recipe
    with pytest.raises(RecipeError):
        recipe_of(Message(document=json.dumps({**document, "width_mm": -1})))
