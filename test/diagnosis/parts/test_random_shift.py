"""Shifts of which no two doors are alike: what changed is found by doors that nobody milled before."""

import numpy as np
import pytest

from doormill_ros.diagnosis.core.words.verdict import CONSISTENT
from doormill_ros.diagnosis.parts.kind import Inspections
from doormill_ros.pipeline.plan import load_setup
from support.gauged_shift import SCATTER
from support.random_shift import PLACING, next_doors, random_doors, random_shift
from support.shift_loop import loop_worth
from support.shift_worlds import Hidden, draw_shift, judged

COUNT, STEP = 12, 8
CHANGES = {
    "gap": (
        {"robot": {"gap": [0.0, 1.2e-4, 0.0, 0.0, 0.0, 0.0]}},
        Hidden("joint_backlash", "joint 2", STEP),
    ),
    "force": ({"force": {"factor": 1.3}}, Hidden("process_force", "tool", STEP)),
    "camera": ({}, Hidden("camera_shift", "camera", STEP)),
}


def diagnosis_of(tmp_path, world, seed=4):
    doors = random_doors(1, COUNT)
    assert len({door.recipe.width for door in doors}) == COUNT
    return Inspections().diagnose(random_shift(tmp_path, world, doors, seed), lambda line: None)


@pytest.mark.parametrize("change", CHANGES)
def test_a_change_is_found_though_no_recipe_comes_twice(change, tmp_path):
    section, hidden = CHANGES[change]
    world = {"seed": 4}
    if section:
        world["change"] = [{"from_door": STEP, **section}]
    else:
        world["camera"] = {"moved": [0.0, 2e-4, -1e-4], "from_door": STEP}
    diagnosis = diagnosis_of(tmp_path, world)
    found = judged(diagnosis, (hidden,))
    assert (found.missed, found.wrong, found.late) == ((), (), ())
    assert [finding.cause.course.steps for finding in diagnosis.findings] == [True]


FEW = 5
LATE = {
    "clamp": ({"clamp": {"shift": [0.0, 1e-4, -1.6e-4], "from_door": 3}}, Hidden("clamp_shift", "clamp", 3)),
    "weight": (
        {"change": [{"from_door": 3, "tool": {"mass": 15.0, "com": [0.0, 0.0, 0.1]}}]},
        Hidden("gravity_sag", "tool", 3),
    ),
}


@pytest.mark.parametrize("change", LATE)
def test_what_begins_two_doors_before_the_end_of_five_is_found(change, tmp_path):
    world, hidden = LATE[change]
    doors = random_shift(tmp_path, {"seed": 4, **world}, random_doors(1, FEW), 4)
    found = judged(Inspections().diagnose(doors, lambda line: None), (hidden,))
    assert (found.missed, found.wrong, found.late) == ((), (), ())


def test_a_camera_that_moved_with_a_spring_is_found_although_one_door_of_five_has_one_hinge(tmp_path):
    drawn = draw_shift(314, longest=FEW)
    doors = random_doors(314, FEW)
    assert [len(door.recipe.features) for door in doors].count(1) == 1
    diagnosis = Inspections().diagnose(random_shift(tmp_path, drawn.world, doors, 314), lambda line: None)
    found = judged(diagnosis, drawn.hidden)
    assert (found.missed, found.wrong, found.late) == ((), (), ())


@pytest.mark.parametrize("scatter", [SCATTER, tuple(np.sqrt(np.diag(PLACING)))], ids=["little", "as stated"])
def test_five_other_doors_are_no_change_however_their_places_scatter(scatter, tmp_path):
    doors = random_shift(tmp_path, {"seed": 4}, random_doors(1, FEW), 4, scatter=scatter)
    assert not Inspections().diagnose(doors, lambda line: None).findings


def test_a_force_by_engagement_is_no_change_of_five_other_doors(tmp_path):
    world = {"seed": 9000, "force": {"law": "engagement"}}
    doors = random_shift(tmp_path, world, random_doors(9000, FEW), 9000)
    assert not Inspections().diagnose(doors, lambda line: None).findings


def test_doors_that_are_all_different_are_no_change_by_themselves(tmp_path):
    diagnosis = diagnosis_of(tmp_path, {"seed": 4})
    assert diagnosis.verdict == CONSISTENT
    assert not diagnosis.findings


def test_two_more_such_doors_come_out_better_with_what_was_learned(tmp_path):
    world = {"seed": 4, "force": {"factor": 1.3}}
    following = next_doors(1)
    seen = {door.recipe.width for door in random_doors(1, COUNT)}
    assert not seen & {recipe.width for recipe, _ in following}
    loop = loop_worth(tmp_path, diagnosis_of(tmp_path, world), COUNT, 4, load_setup(), doors=following)
    assert loop.after < 0.5 * loop.before
    assert loop.as_told
