"""Answers name the fields of the messages they stand for, and hold what those hold."""

from __future__ import annotations

import json
import re
from functools import reduce
from typing import Any

import numpy as np
import pytest

from doormill_interfaces.msg import DoorRecipe, TargetArray
from doormill_ros.nodes.convert.program import program_into
from doormill_ros.pipeline.plan import load_setup, plan
from doormill_ros.recipes.documents import shipped_recipes
from doormill_ros.recording.replay.answer import (
    MAKERS,
    STAGES,
    recipe_of,
    refusal,
    result_answer,
    target_file_answer,
    targets_answer,
    targets_of,
)
from doormill_ros.toolpath.program import MillingProgram
from support.source_tree import ROOT

STEP = re.compile(r"(\w+)(?:\[(\d+)\])?")
#: doormill_interfaces/Motion.kind by what an answer calls it.
KINDS = {"MoveJ": 0, "MoveL": 1, "MoveC": 2, "MoveAbsJ": 3}


@pytest.fixture(scope="module")
def program() -> MillingProgram:
    recipe, setup = shipped_recipes()["thesis_190_0deg"], load_setup()
    return plan(recipe, setup.layout.T_base_door(recipe.width, recipe.thickness), setup).program


def field_of(message: Any, path: str) -> Any:
    """What stands under a path in a message; a point, vector or quaternion as its components."""
    if path.endswith(".length"):
        return len(getattr(message, path.removesuffix(".length")))

    def step(value: Any, name: str) -> Any:
        found = STEP.fullmatch(name)
        assert found, path
        inner = getattr(value, found[1])
        return inner if found[2] is None else inner[int(found[2])]

    value = reduce(step, path.split("."), message)
    fields = getattr(value, "get_fields_and_field_types", lambda: {})()
    return [getattr(value, name) for name in fields] if fields else value


def test_every_field_of_a_program_has_the_value_of_the_message(program: MillingProgram) -> None:
    message = program_into(TargetArray(accepted=True, robot_model="springs", cycle_time=81.5), program)
    answer = targets_answer(7, program, 81.5, "springs")
    assert answer.stamp_ns == 7
    assert len(answer.values) == 9 + 15 * len(program.targets) + 12 * len(program.motions)
    for path, value in answer.values.items():
        found = field_of(message, path)
        if path.endswith(".kind"):
            assert KINDS[str(value)] == found, path
        elif isinstance(value, (list, float)):
            assert np.allclose(np.asarray(found, dtype=float), value, rtol=0.0, atol=1e-12), path
        else:
            assert value == found, path


def test_a_recorded_message_and_a_fresh_program_give_the_same_fields_in_the_same_order(
    program: MillingProgram,
) -> None:
    message = program_into(TargetArray(accepted=True, robot_model="springs", cycle_time=81.5), program)
    recorded, fresh = targets_of(message), targets_answer(0, program, 81.5, "springs")
    assert list(recorded.values) == list(fresh.values)
    assert recorded.accepted


def test_a_recipe_is_compared_by_content_not_by_who_saved_it_when() -> None:
    document = {"author": "me", "created": "now", "version": 3, "door_id": "d", "features": [{"w": [1, 2.5]}]}
    answer = recipe_of(DoorRecipe(document=json.dumps(document), version=3))
    assert answer.values == {
        "version": 3,
        "document.door_id": "d",
        "document.features[0].w[0]": 1,
        "document.features[0].w[1]": 2.5,
    }


def test_a_refusal_is_its_code_and_its_words() -> None:
    answer = refusal("/path/targets", 5, 310, "out of reach")
    assert (answer.accepted, answer.error_code, answer.values["reason"]) == (False, 310, "out of reach")
    message = TargetArray(error_code=310, reason="out of reach")
    message.header.stamp.nanosec = 5
    assert targets_of(message) == answer


def test_a_target_file_is_compared_line_by_line_or_by_its_checksum() -> None:
    lines = target_file_answer(1, b"one\ntwo\n")
    whole = target_file_answer(1, b"one\ntwo\n", by_line=False)
    assert list(lines.values) == ["line 1", "line 2", "line 3", "sha256"]
    assert whole.values == {"sha256": lines.values["sha256"]}
    assert target_file_answer(1, b"", "abc").values == {"sha256": "abc"}


def test_what_a_success_says_of_its_timing_is_not_compared() -> None:
    assert result_answer(True, 0, "ready after 12 ms").values == {"success": True, "error_code": 0}
    assert "message" in result_answer(False, 801, "waited 3 s").values


def test_each_stage_names_code_that_exists() -> None:
    assert MAKERS.keys() == set(STAGES)
    places = [place for maker in MAKERS.values() for place in re.findall(r"doormill_ros/[\w/.]+", maker)]
    assert len(places) >= len(STAGES)
    assert [place for place in places if not (ROOT / place).exists()] == []
