"""Worlds of hidden laws: their robot against other kinematics, their files against a prediction made here."""

from __future__ import annotations

import csv
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import yaml

from doormill_ros.measurements.sets.measurement_set import read_measurement_set
from doormill_ros.robot.description import load_robot
from doormill_ros.robot.kinematics import Kinematics
from support.law_worlds.geometry import ROBOT, joint, link_frames
from support.law_worlds.named import CAUSES
from support.law_worlds.session import draw_session
from support.law_worlds.world import LAWS, STRONGEST, WEAKEST, World, draw
from support.pinocchio_model import PinocchioKinematics


@pytest.fixture(scope="module")
def session():
    return draw_session(np.random.default_rng(5))


def missed(folder: Path) -> np.ndarray:
    """What stated springs leave of a set, shape (n, 3) [m]; linear, with the robot package's frames."""
    document = yaml.safe_load((folder / "set.yaml").read_text(encoding="utf-8"))
    with open(folder / "trials.csv", newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))

    def column(names: str) -> np.ndarray:
        return np.array([[float(row[name]) for name in names.split()] for row in rows])

    frames = Kinematics(load_robot(ROBOT)).link_frames(column("q1 q2 q3 q4 q5 q6"))
    c, s = np.cos(document["wrench_frame_rotation"]), np.sin(document["wrench_frame_rotation"])
    R = frames[:, 6, :3, :3] @ np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    force, couple = (np.einsum("nij,nj->ni", R, column(names)) for names in ("fx fy fz", "mx my mz"))
    at = (frames[:, 6] @ np.append(document["load_point"], 1.0))[:, :3]
    places = [document["reflectors"][row["reflector"]] for row in rows]
    links = np.array([place["link"] for place in places])
    local = np.array([[*place["position"], 1.0] for place in places])
    points = np.einsum("nij,nj->ni", frames[np.arange(len(rows)), links], local)[:, :3]
    moved = np.zeros((len(rows), 3))
    for k, stiffness in enumerate(document["model"]["joint_stiffness"]):
        axis, origin = frames[:, k, :3, 2], frames[:, k, :3, 3]
        angle = np.sum(axis * (couple + np.cross(at - origin, force)), axis=1) / stiffness
        moved += np.where(links > k, angle, 0.0)[:, None] * np.cross(axis, points - origin)
    return column("dx dy dz") - moved


def square(values: np.ndarray) -> float:
    return float(np.mean(np.square(values)))


def test_frames_are_those_of_the_urdf_and_of_the_contract(session) -> None:
    other = PinocchioKinematics(load_robot(ROBOT))
    q = session.q[::8]
    np.testing.assert_allclose(link_frames(q)[:, 6], [other.forward(one) for one in q], atol=1e-12)
    np.testing.assert_allclose(link_frames(q), Kinematics(load_robot(ROBOT)).link_frames(q), atol=1e-12)


def test_torques_do_the_work_that_the_load_does(session) -> None:
    other = PinocchioKinematics(load_robot(ROBOT))
    work = [
        other.jacobian(q, session.load_point).T @ np.concatenate([force, couple])
        for q, force, couple in zip(session.q[:20], session.force, session.couple, strict=False)
    ]
    ours = np.column_stack([session.torque(joint(k)) for k in range(1, 7)])[:20]
    np.testing.assert_allclose(ours, work, atol=1e-9)


def test_turning_all_joints_is_standing_at_the_sum_of_the_angles(session) -> None:
    """Far beyond small angles, where the order of the turns shows."""
    angles = np.random.default_rng(1).uniform(-0.5, 0.5, session.q.shape)
    turns = [(joint(k), angles[:, k - 1]) for k in (3, 1, 6, 2, 5, 4)]
    there = replace(session, q=session.q + angles).points
    np.testing.assert_allclose(session.points + session.moved(turns), there, atol=1e-12)


def test_without_a_law_only_the_noise_is_left(tmp_path: Path) -> None:
    left, floor = [], []
    for seed in (0, 17, 34, 51):
        world = replace(draw(seed), size=0.0, named=None)
        world.write(tmp_path / str(seed))
        left.append(missed(tmp_path / str(seed)) / world.noise)
        floor.append(world.tracker_noise[world.session.seen] / world.noise)
    # The sensor's noise comes through the springs: 0.3 N at less than 4 um / N, on more than 5 um.
    assert square(np.vstack(floor)) < square(np.vstack(left)) < square(np.vstack(floor)) + (1.2 / 5.0) ** 2
    # Row by row it is the noise drawn: what differs is far smaller than that.
    assert square(np.vstack(left) - np.vstack(floor)) < (1.2 / 5.0) ** 2


@pytest.mark.parametrize("seed", range(len(LAWS)), ids=lambda seed: LAWS[seed].__name__)
def test_a_law_alone_adds_its_amplitude_to_the_noise(tmp_path: Path, seed: int) -> None:
    world = draw(seed)
    truth = world.truth
    assert truth["law"] == LAWS[seed].__name__
    assert truth["named"] is None
    assert WEAKEST * 0.99 < truth["amplitude"] < STRONGEST * 1.01
    world.write(tmp_path)
    left = missed(tmp_path)
    law, floor = truth["amplitude"] * world.noise, truth["noise"]["floor"]
    # The product of law and noise averages to nothing, with this spread.
    spread = 2.0 * law * floor / np.sqrt(left.size)
    assert square(left) == pytest.approx(law**2 + floor**2, abs=4.0 * spread + 0.03 * law**2)


@pytest.mark.parametrize("seed", [16, 17, 18])
def test_a_named_cause_stands_beside_at_another_joint(tmp_path: Path, seed: int) -> None:
    world = draw(seed)
    beside = world.truth["named"]
    assert beside["cause"] in CAUSES
    assert beside["where"] != world.law.where
    assert 4.0 * 0.99 < beside["amplitude"] < 12.0 * 1.01
    replace(world, size=0.0).write(tmp_path)
    cause, floor = beside["amplitude"] * world.noise, world.truth["noise"]["floor"]
    left = missed(tmp_path)
    spread = 2.0 * cause * floor / np.sqrt(left.size)
    assert square(left) == pytest.approx(cause**2 + floor**2, abs=4.0 * spread + 0.03 * cause**2)


def test_three_causes_take_turns() -> None:
    assert {draw(seed).named.cause for seed in (16, 17, 18)} == set(CAUSES)


def files(world: World, folder: Path) -> list[bytes]:
    world.write(folder / "set")
    world.write_unseen(folder / "unseen")
    return [path.read_bytes() for path in sorted(folder.rglob("*.*"))]


def test_a_seed_is_one_world(tmp_path: Path) -> None:
    first = files(draw(8), tmp_path / "a")
    assert len(first) == 4
    assert first == files(draw(8), tmp_path / "b")
    assert first != files(draw(24), tmp_path / "c")


def test_both_sets_read_and_share_no_configuration(tmp_path: Path) -> None:
    world = draw(16)
    files(world, tmp_path)
    seen, unseen = (read_measurement_set(tmp_path / name) for name in ("set", "unseen"))
    assert len(seen.q) + len(unseen.q) == len(world.session.q)
    postures = [{tuple(q) for q in data.q.round(6)} for data in (seen, unseen)]
    assert not postures[0] & postures[1]
    assert len(postures[0]) >= 14
    assert len(postures[1]) == 6
    # The clock runs through both: the held out are within what was shown, not after it.
    assert unseen.time.min() < seen.time.max()
    assert seen.time.min() < unseen.time.max()


def test_every_stance_is_told_by_angles_or_directions(session) -> None:
    """What the memory of hysteresis starts anew at."""
    anew = np.diff(session.stance) > 0
    moved = np.any(np.diff(session.q, axis=0) != 0.0, axis=1) | np.any(
        np.diff(session.approach, axis=0) != 0.0, axis=1
    )
    np.testing.assert_array_equal(anew, moved)
