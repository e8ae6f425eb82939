"""There is one way from a picture to a pose and one from a pose to a program, and it is the nodes' own."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from std_msgs.msg import Header

from doormill_ros.cell.places.layout import DoorOffset
from doormill_ros.frames import transform
from doormill_ros.localization.camera import load_camera
from doormill_ros.localization.errors import BadPicture, LocalizationError
from doormill_ros.messages.from_message import transform_of
from doormill_ros.nodes.convert.picture import picture_message
from doormill_ros.pipeline.look import look
from doormill_ros.pipeline.plan import load_setup, plan
from doormill_ros.pipeline.preview import preview
from doormill_ros.recipes.documents import shipped_recipes
from doormill_ros.recipes.recipe import ClampPlacement
from doormill_ros.recording.replay.recorded_run import RecordedRun
from doormill_ros.recording.replay.run_reader import read_runs
from doormill_ros.robot_model.errors import ExtendedModelError
from doormill_ros.toolpath.door_checks import check_door
from doormill_ros.toolpath.errors import DoorPoseError
from support.source_tree import PACKAGE, ROOT, SOURCES, imports_of

#: What the pipeline stands for: nobody else in the package may go round it.
INSIDE = {
    "doormill_ros.toolpath.generate": {"pipeline/plan.py"},
    "doormill_ros.localization.localizer": {
        "pipeline/look.py",
        "nodes/door_localizer.py",  # works out what depends on the door's size before the picture comes
        "localization/sensors/one_camera.py",  # the camera as one sensor among others
        "localization/sensors/located.py",
        "localization/calibration/scale_test.py",  # moves of a door that are known, by pictures alone
        "localization/calibration/empty_picture.py",  # asks whether a door stands in a picture without a run
        "diagnosis/camera/kind.py",  # judges the localizer itself, by pictures alone
    },
}


@pytest.fixture(scope="module")
def run() -> RecordedRun:
    (run,) = read_runs(ROOT / "bags" / "thesis_190_2deg")
    return run


@pytest.mark.parametrize("module", INSIDE)
def test_nobody_goes_round_the_pipeline(module: str) -> None:
    users = {str(path.relative_to(PACKAGE)) for path in SOURCES if module in imports_of(path)}
    assert users == INSIDE[module]


def test_a_recorded_picture_is_found_where_it_was(run: RecordedRun) -> None:
    picture = next(iter(run.pictures.values()))
    setup = load_setup()
    found = look(picture, load_camera(), setup.layout, run.recipe)
    recorded = next(m for _, m in run.localizations if m.accepted)
    assert np.abs(found.T_base_door - transform_of(recorded.pose.pose)).max() < 1e-5


def test_what_cannot_be_found_is_refused(run: RecordedRun) -> None:
    layout = load_setup().layout
    black = picture_message(np.zeros((20, 20), dtype=np.uint8), Header())
    with pytest.raises(LocalizationError):
        look(black, None, layout, run.recipe)
    black.encoding = "mono16"
    with pytest.raises(BadPicture):
        look(black, None, layout, run.recipe)


def test_a_program_is_made_for_a_door_in_its_clamp_alone() -> None:
    recipe, setup = shipped_recipes()["thesis_190_0deg"], load_setup()
    T_base_door = setup.layout.T_base_door(recipe.width, recipe.thickness)
    planned = plan(recipe, T_base_door, setup)
    check = check_door(planned.program, recipe, setup.robot, setup.settings)
    assert sum(feature.targets for feature in check.features) <= len(planned.program.targets)
    assert planned.time == check.time > 0.0
    with pytest.raises(DoorPoseError):
        plan(recipe, transform(translation=np.array([0.0, 1.0, 0.0])) @ T_base_door, setup)


@pytest.mark.parametrize("share", ["", "first", "second"])
def test_no_robot_mills_a_door_that_stands_too_far_off(share: str) -> None:
    recipe, setup = shipped_recipes()["standard_door"], load_setup(share=share)
    T_base_door = setup.layout.T_base_door(recipe.width, recipe.thickness)
    assert plan(recipe, T_base_door, setup).program.targets
    for off in ([0.0, 0.02, 0.0], [0.0, 0.0, 0.02], [0.01, 0.0, 0.0]):
        with pytest.raises(DoorPoseError):
            plan(recipe, transform(translation=np.array(off)) @ T_base_door, setup)


def test_a_preview_is_the_program_of_the_cell() -> None:
    recipe, setup = shipped_recipes()["thesis_190_0deg"], load_setup()
    moved = replace(recipe, placement=ClampPlacement(0.004, -0.003, 0.01))
    (only,) = preview(moved)
    T_base_door = setup.layout.T_base_door(recipe.width, recipe.thickness, DoorOffset(0.004, -0.003, 0.01))
    assert only.robot == "only"
    assert np.array_equal(only.T_base_door, T_base_door)
    program = plan(moved, T_base_door, setup).program
    assert len(program.targets) == len(only.program.targets) > 0
    for seen, milled in zip(only.program.targets, program.targets, strict=True):
        assert np.array_equal(seen.T_base_tool_corrected, milled.T_base_tool_corrected)


def test_the_setup_is_the_cell_s_unless_told_otherwise() -> None:
    setup = load_setup()
    assert setup.robot.name == setup.layout.robot == setup.model_name
    with pytest.raises(ExtendedModelError):
        load_setup(model="irb6700_235_265")
    assert load_setup("irb6700_235_265").model_name == "irb6700_235_265"
