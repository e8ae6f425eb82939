"""Each key of a world moves what it must of a recorded door, by a figure computed by hand, and nothing else."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from doormill_ros.cell.places.layout import load_layout
from doormill_ros.diagnosis.parts.doors.late import LAGS
from doormill_ros.diagnosis.parts.effects.lag import ServoLag
from doormill_ros.localization.camera import load_camera
from doormill_ros.localization.localizer import localize
from doormill_ros.messages.from_message import program_of
from doormill_ros.nodes.simulated.controller_simulator import switch_on
from doormill_ros.recording.bag_reader import read_bag
from doormill_ros.simulation.controller.motions.limits import load_limits
from doormill_ros.simulation.picture.picture import render_picture
from doormill_ros.simulation.picture.scene import PictureScene, SceneCamera
from doormill_ros.simulation.world.door_truth import FORCE, TAKT
from doormill_ros.simulation.world.servo import lagging
from doormill_ros.units import DEG, MM
from support.source_tree import ROOT

BAG = ROOT / "bags" / "thesis_190_0deg"
WIDTH, THICKNESS = 0.8, 0.04


def moved(door, recorded, **changes):
    """Way of the tool from where today's cell has it, shape (n, 3)."""
    path = replace(recorded.path, **changes)
    T_base_door = door.T_base_door(recorded.T_base_door)
    actual = door.executed(recorded.recipe, T_base_door, path).T_base_tool[:, :3, 3]
    return actual - recorded.path.T_base_tool[:, :3, 3]


def test_a_world_as_assumed_mills_as_todays_cell_did(truth, recorded):
    door = truth()
    assert np.abs(moved(door, recorded)).max() < 1e-9
    np.testing.assert_array_equal(door.T_base_door(recorded.T_base_door), recorded.T_base_door)
    found = door.executed(recorded.recipe, recorded.T_base_door, recorded.path)
    np.testing.assert_allclose(found.T_base_tool, recorded.path.T_base_tool, atol=1e-9)
    # Nobody in a workshop knows the true wrench: the path keeps what was assumed.
    np.testing.assert_array_equal(
        truth("force: {factor: 2}").executed(recorded.recipe, recorded.T_base_door, recorded.path).wrench,
        recorded.path.wrench,
    )


def test_the_force_is_the_factor_times_the_recipes_and_so_is_the_deflection(truth, recorded):
    rigid = recorded.path.T_base_tool_commanded[:, :3, 3]
    assumed = recorded.path.T_base_tool[:, :3, 3] - rigid
    more = truth("force: {factor: 1.3}").executed(recorded.recipe, recorded.T_base_door, recorded.path)
    np.testing.assert_allclose(more.T_base_tool[:, :3, 3] - rigid, 1.3 * assumed, atol=2e-6)
    assert np.abs(0.3 * assumed).max() > 5e-5


@pytest.mark.parametrize(("number", "factor"), [(0, 1.2), (1, 1.2 * 1.05), (10, 1.2 * 1.5)])
def test_wear_adds_its_share_from_door_to_door(truth, recorded, number, factor):
    door = truth("force: {factor: 1.2, wear_per_door: 0.05}", number)
    wrench = door.wrench(recorded.recipe, recorded.T_base_door, recorded.path)
    np.testing.assert_allclose(wrench, factor * recorded.path.wrench, rtol=1e-9, atol=1e-9)


def test_scatter_draws_one_factor_a_door_from_the_worlds_seed(truth, recorded):
    def factor(text, number):
        wrench = truth(text, number).wrench(recorded.recipe, recorded.T_base_door, recorded.path)
        row = np.abs(recorded.path.wrench[:, 1]).argmax()
        return wrench[row, 1] / recorded.path.wrench[row, 1]

    drawn = np.array([factor("force: {scatter: 0.1}", number) for number in range(100)])
    assert factor("force: {scatter: 0.1}", 7) == drawn[7]
    assert factor("seed: 2\nforce: {scatter: 0.1}", 7) != drawn[7]
    # Of 100 normal numbers mean and deviation are within 4 of their own standard deviations.
    assert abs(drawn.mean() - 1.0) < 4 * 0.01
    assert abs(drawn.std() - 0.1) < 4 * 0.1 / np.sqrt(200.0)


def test_an_angle_turns_the_force_about_the_tool(truth, recorded):
    found = truth(f"force: {{angle: {np.pi / 2}}}").wrench(
        recorded.recipe, recorded.T_base_door, recorded.path
    )
    R = recorded.path.T_base_tool_commanded[:, :3, :3]
    assumed, turned = (np.einsum("nji,nj->ni", R, w[:, :3]) for w in (recorded.path.wrench, found))
    np.testing.assert_allclose(
        turned, np.column_stack([-assumed[:, 1], assumed[:, 0], assumed[:, 2]]), atol=1e-9
    )
    assert np.abs(assumed).max() > 50.0


def test_engaged_wood_makes_no_force_where_nothing_is_cut_and_at_most_a_full_slots(truth, recorded):
    door = truth("force: {law: engagement}")
    wrench = door.wrench(recorded.recipe, recorded.T_base_door, recorded.path)
    size = np.linalg.norm(wrench[:, :3], axis=1)
    largest = np.linalg.norm(recorded.path.wrench[:, :3], axis=1).max()
    assert not size[~recorded.path.cutting].any()
    assert 0.5 * largest < size.max() < 1.05 * largest
    again = truth("force: {law: engagement, factor: 2}").wrench(
        recorded.recipe, recorded.T_base_door, recorded.path
    )
    np.testing.assert_allclose(again, 2.0 * wrench)


def test_a_mill_of_1_2_newtons_per_micrometre_bends_by_a_tenth_of_a_millimetre_under_120_newtons(truth):
    door = truth("tool: {stiffness: 1.2e+6}")
    axis = np.array([[1.0, 0.0, 0.0]] * 3)
    force = np.array([[0.0, 120.0, 0.0], [0.0, 0.0, -60.0], [500.0, 0.0, 0.0]])
    np.testing.assert_allclose(
        door.bent(force, axis), [[0.0, 1e-4, 0.0], [0.0, 0.0, -5e-5], [0.0, 0.0, 0.0]], atol=1e-15
    )
    assert not truth().bent(force, axis).any()


def test_a_soft_mill_moves_only_what_cuts(truth, recorded):
    way = moved(truth("tool: {stiffness: 1.2e+6}"), recorded)
    loaded = np.any(recorded.path.wrench[:, :3] != 0.0, axis=1)
    assert np.abs(way[~loaded]).max() < 1e-9
    force = recorded.path.wrench[:, :3]
    axis = recorded.path.T_base_tool_commanded[:, :3, 2]
    across = force - np.sum(force * axis, axis=1, keepdims=True) * axis
    np.testing.assert_allclose(way, across / 1.2e6, atol=1e-9)


def test_weight_moves_the_tool_down_wherever_it_is(truth, recorded):
    way = moved(truth("tool: {mass: 25, com: [0, 0, 0.12]}"), recorded)
    assert way[:, 2].max() < -1e-4


@pytest.mark.parametrize(("number", "shift"), [(2, 0.0), (3, 2e-4), (9, 2e-4)])
def test_the_clamp_moves_the_door_from_its_door_on_and_not_the_tool(truth, recorded, number, shift):
    door = truth("clamp: {shift: [2.0e-4, 0, 0], from_door: 3}", number)
    T = door.T_base_door(recorded.T_base_door)
    np.testing.assert_allclose(T[:3, 3] - recorded.T_base_door[:3, 3], [shift, 0.0, 0.0], atol=1e-15)
    np.testing.assert_array_equal(T[:3, :3], recorded.T_base_door[:3, :3])
    assert np.abs(moved(door, recorded)).max() < 1e-9


def test_an_arm_that_warms_up_by_ten_kelvin_pushes_the_tool_away_from_its_base(truth):
    text = "temperature: {rise: 10, hours: 2, growth: 1.0e-5}"
    at, flange = np.array([[1.2, 0.0, 1.6]]), np.array([[1.0, 0.0, 1.5]])  # the tool is 2 m from the base
    late = truth(text, 10_000).grown(np.zeros(1), at, flange)
    np.testing.assert_allclose(late, [[0.6e-4, 0.0, 0.8e-4]], rtol=1e-9)
    # After two hours all but 1 / e.
    door = round(2.0 * 3600.0 / TAKT)
    np.testing.assert_allclose(
        truth(text, door).grown(np.zeros(1), at, flange), (1.0 - 1.0 / np.e) * late, rtol=1e-9
    )
    np.testing.assert_allclose(
        truth(text, 0).grown(np.array([7200.0]), at, flange), (1.0 - 1.0 / np.e) * late, rtol=1e-9
    )
    assert not truth(text, 0).grown(np.zeros(1), at, flange).any()
    longer = truth("temperature: {rise: 10, expansion: 1.2e-5}", 10_000).grown(np.zeros(1), at, flange)
    np.testing.assert_allclose(longer, 1.2e-4 * flange, rtol=1e-9)
    assert not truth("temperature: {rise: 10}", 9).grown(np.zeros(1), at, flange).any()


def test_a_tool_that_follows_late_goes_round_in_a_smaller_circle_behind_its_command():
    lag, turn, radius = 0.02, 5.0, 0.01
    time = np.linspace(0.0, 3.0, 3001)
    angle = turn * time
    sent = radius * np.column_stack([np.cos(angle), np.sin(angle), np.zeros_like(angle)])
    late = lagging(time, sent, lag)[1500:]  # what it began with has died away
    # Of a first-order lag: 1 / sqrt(1 + (w T)^2) of the size, atan(w T) behind.
    np.testing.assert_allclose(np.linalg.norm(late, axis=1), radius / np.hypot(1.0, turn * lag), rtol=3e-5)
    behind = angle[1500:] - np.unwrap(np.arctan2(late[:, 1], late[:, 0])) - 2.0 * np.pi
    np.testing.assert_allclose(np.mod(behind + np.pi, 2.0 * np.pi) - np.pi, np.arctan(turn * lag), atol=1e-5)
    assert np.array_equal(lagging(time, sent, 0.0), sent)


def test_it_cuts_a_right_angle_by_what_the_diagnosis_tells_as_its_corner():
    lag, feed = 0.01, 0.05
    time = np.linspace(0.0, 1.0, 20_001)
    way = feed * (time - 0.5)
    sent = np.column_stack([np.minimum(way, 0.0), np.maximum(way, 0.0), 0.0 * way])
    passed = np.linalg.norm(lagging(time, sent, lag), axis=1).min()
    told = ServoLag(LAGS[0]).values(np.array([(lag / 1e-2) ** 2]), SimpleNamespace(feed=np.full(3, feed)))
    np.testing.assert_allclose(told, passed, rtol=2e-3)


def test_a_controller_that_lags_moves_the_path_at_its_bends_only(truth, recorded):
    way = np.linalg.norm(moved(truth("controller: {corner: 3.0e-4}"), recorded), axis=1)
    assert 1e-5 < way[recorded.path.cutting].max() < 3.1e-4
    # On the straight walls, most of the way, nothing changes.
    assert np.median(way[recorded.path.cutting]) < 1e-6


def test_the_controller_is_as_configured_but_what_the_world_names(truth):
    assert truth().limits == load_limits()
    found = truth("controller: {segment_time: 0.012, acceleration: 0.5}").limits
    assert found == replace(load_limits(), segment_time=0.012, acceleration=0.5)


def test_a_controller_of_a_quarter_of_the_acceleration_needs_longer_for_the_same_way(truth, tmp_path):
    (message,) = (item.message for item in read_bag(BAG, ["/path/targets"]) if item.message.accepted)
    program = program_of(message)
    runs = []
    for text in ("", "controller: {acceleration: 0.5}"):
        cell = switch_on(tmp_path)
        cell.limits = truth(text).limits
        runs.append(cell.execute_uncorrected(program))
    fast, slow = runs
    # From rest to rest at the speed v each stop takes v / a: 50 mm/s make 25 ms and 100 ms.
    assert slow.time[-1] > fast.time[-1] + 0.075
    np.testing.assert_allclose(slow.T_base_tool_commanded[-1], fast.T_base_tool_commanded[-1], atol=1e-9)


@pytest.mark.parametrize("key", ["robot: {pose_error: {seed: 3, size: 1.0e-4}}"])
def test_wrong_links_move_the_tool_without_any_load(truth, recorded, key):
    unloaded = np.zeros_like(recorded.path.wrench)
    free, wrong = (
        truth(text)
        .executed(recorded.recipe, recorded.T_base_door, replace(recorded.path, wrench=unloaded))
        .T_base_tool[:, :3, 3]
        for text in ("", key)
    )
    off = np.linalg.norm(wrong - free, axis=1)
    assert off.min() > 5e-5
    assert off.max() < 3e-3


def localized(truth, text, number=0):
    """Offset that the project's localizer finds for a door at its nominal place."""
    shift, turn = truth(text, number).camera_moved
    camera = SceneCamera.load()
    scene = PictureScene(WIDTH, THICKNESS, camera=replace(camera, origin=camera.origin + shift, turn=turn))
    return localize(render_picture(scene, seed=1), load_camera(), load_layout(), WIDTH, THICKNESS).offset


def test_a_camera_that_was_moved_sees_the_door_moved_the_other_way(truth):
    still = localized(truth, "")
    text = "camera: {moved: [0, 4.0e-4, -3.0e-4], from_door: 2}"
    found = localized(truth, text, 2)
    assert found.y - still.y == pytest.approx(-0.4 * MM, abs=0.02 * MM)
    assert found.z - still.z == pytest.approx(0.3 * MM, abs=0.02 * MM)
    assert found.rotation - still.rotation == pytest.approx(0.0, abs=0.01 * DEG)
    np.testing.assert_array_equal(truth(text, 1).camera_moved[0], np.zeros(3))
    np.testing.assert_array_equal(truth(text, 1).camera_moved[1], np.eye(3))


def test_a_camera_that_was_turned_sees_the_door_beside_its_place(truth):
    still, angle = localized(truth, ""), 5e-4
    distance = load_layout().rear_face_x - THICKNESS - SceneCamera.load().origin[0]
    # Turned to the left, about base z, what is ahead seems to be to the right: distance times angle.
    yawed = localized(truth, f"camera: {{turned: [0, 0, {angle}]}}")
    assert yawed.y - still.y == pytest.approx(-angle * distance, rel=0.1)
    # Turned about the way it looks, the door seems to be turned back.
    rolled = localized(truth, f"camera: {{turned: [{angle}, 0, 0]}}")
    assert rolled.rotation - still.rotation == pytest.approx(-angle, abs=0.005 * DEG)


def test_what_is_drawn_for_the_gauge_is_not_what_is_drawn_for_the_force(truth):
    door = truth("seed: 5", 3)
    assert door.drawn(FORCE).random() == truth("seed: 5", 3).drawn(FORCE).random()
    assert len({door.drawn(what).random() for what in (1, 2)} | {truth("seed: 5", 4).drawn(1).random()}) == 3
