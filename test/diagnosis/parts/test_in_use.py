"""What a model is judged by: that it sends the tool where a plan with it does."""

from dataclasses import replace
from functools import cache

import pytest

from doormill_ros.diagnosis.parts.correction.in_use import undone_along
from doormill_ros.pipeline.plan import load_setup, plan
from doormill_ros.recipes.documents import load_recipe
from doormill_ros.recipes.force_origin import ForceModel, ForceOrigin
from doormill_ros.recipes.program import Program
from doormill_ros.recipes.wrench import WrenchTable
from doormill_ros.robot_model.displacement import Displacement
from doormill_ros.robot_model.elastic.knowledge import MeasuredForce
from doormill_ros.robot_model.extended_model import ExtendedComplianceModel, standing_model
from doormill_ros.statistics import root_mean_square
from support.gauged_shift import Commanded
from support.loop_worlds import timed
from support.milled_worlds import commanded
from support.random_shift import LINE_STEP, NO_BAG, random_shift

STANDS = Displacement(shift=(0.0, 8e-5, -1.2e-4), turn=2e-5, std=2e-5)
KNOWN = MeasuredForce(("hinge_oblong",), 0.01, 0.01)
#: Large ones that nobody measured no plan lets pass.
SMALL = WrenchTable((("default", (-60.0, 20.0, 5.0, 0.0, 0.0, 0.0)),))
#: What is known of the force, and the model that corrects beside the springs.
PLANS = {
    "measured": (None, None),
    "measured on doors": (None, {"force": KNOWN}),
    "where doors stand": (None, {"force": KNOWN, "place": STANDS}),
    "nobody's": (ForceOrigin(), None),
    "computed": (ForceOrigin(model=ForceModel.ENGAGEMENT), None),
}


@cache
def setup():
    return load_setup()


def model_of(more):
    robot = setup().robot
    if more is None:
        return setup().model
    return standing_model(robot, ExtendedComplianceModel(robot.name, robot.dh, robot.stiffness, (), **more))


def recipe_of(forces):
    recipe = load_recipe("thesis_190_0deg")
    features = recipe.features
    if forces is not None:
        table = None if forces.model is ForceModel.ENGAGEMENT else SMALL
        features = tuple(replace(one, forces=forces, wrench_table=table) for one in features)
    return replace(recipe, program=Program.GENERAL, features=features)


@pytest.fixture(scope="module", params=PLANS)
def planned(request, tmp_path_factory):
    """Points of a door that was planned with a model, and the model."""
    forces, more = PLANS[request.param]
    recipe, model, layout = recipe_of(forces), model_of(more), setup().layout
    T_base_door = layout.T_base_door(recipe.width, recipe.thickness)
    made = plan(recipe, T_base_door, replace(setup(), model=model))
    path = timed(commanded(made.program, setup().robot.dh, layout.T_flange_tool, LINE_STEP), made)
    door = Commanded(NO_BAG, recipe.door_id, recipe, T_base_door, path)
    (found,) = random_shift(tmp_path_factory.mktemp("in use"), {"seed": 1}, (door,), 1)
    return found.door.points, model


def test_a_model_is_judged_by_what_a_plan_with_it_sends(planned):
    points, model = planned
    undone = undone_along(points, model, setup().robot, setup().layout.T_flange_tool)
    size = root_mean_square(points.sent)
    assert size > 1e-5
    assert root_mean_square(points.sent + undone) < 0.1 * size
