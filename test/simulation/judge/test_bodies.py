"""The shapes of robot and cell, read by the judge's own code."""

import shutil

import numpy as np
import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from doormill_ros.resources import resource
from doormill_ros.robot.description import load_robot
from doormill_ros.simulation.errors import BodiesError
from doormill_ros.simulation.judge.bodies import Box, Capsule, load_cell
from doormill_ros.simulation.judge.links import BASE, FLANGE
from doormill_ros.simulation.truth.chain import chain

ROBOTS = sorted(path.parent.name for path in resource("config/robots").glob("*/bodies.yaml"))
CELL = load_cell()


def test_every_robot_ships_its_bodies():
    assert sorted(path.parent.name for path in resource("config/robots").glob("*/robot.urdf")) == ROBOTS
    assert len(ROBOTS) == 2


@pytest.mark.parametrize("robot", ROBOTS)
def test_the_urdf_leads_where_the_table_of_the_thesis_leads(robot):
    q = np.random.default_rng(1).uniform(-2.0, 2.0, (50, 6))
    links = load_cell(robot).links
    assert np.allclose(links.frames(q)[FLANGE], chain(load_robot(robot).dh, q)[:, 6], atol=1e-9)


@pytest.mark.parametrize("robot", ROBOTS)
def test_every_link_that_moves_has_a_body(robot):
    cell = load_cell(robot)
    assert {body.link for body in cell.bodies} >= {f"link_{k}" for k in range(1, 7)} | {FLANGE}
    assert all(body.link != BASE for body in cell.bodies)
    assert {obstacle.name for obstacle in cell.obstacles} >= {"pedestal", "floor"}


@given(st.integers(0, 2**32 - 1))
def test_no_point_moves_further_than_the_reach_of_its_link_allows(seed):
    rng = np.random.default_rng(seed)
    q = rng.uniform(-2.0, 2.0, (30, 6))
    step = rng.uniform(-1e-5, 1e-5, q.shape)
    names = CELL.links.names[1:]
    ways, bounds = [], []
    for name in names:
        point = rng.normal(size=3)
        point *= 0.4 / np.linalg.norm(point)
        before, after = (CELL.links.frames(at)[name] @ np.append(point, 1.0) for at in (q, q + step))
        ways.append(np.linalg.norm(after - before, axis=1))
        bounds.append(np.abs(step) @ CELL.links.reach(name, 0.4))
    assert np.shape(ways) == (7, 30)
    assert np.all(np.array(ways) <= np.array(bounds) + 1e-12)


def edited(tmp_path, change):
    """A copy of the shipped cell's file with a change."""
    content = yaml.safe_load(resource("config/cell.yaml").read_text())
    change(content)
    path = tmp_path / "cell.yaml"
    path.write_text(yaml.safe_dump(content))
    return path


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda cell: cell.pop("spindle"), "spindle"),
        (lambda cell: cell["obstacles"][0].pop("size"), "allowed is one with size and position"),
        (lambda cell: cell["obstacles"][0].update(shape="ball"), "shape"),
        (
            lambda cell: cell["obstacles"].append(
                {"name": "post", "shape": "capsule", "radius": 0.1, "start": [0, 0, 0], "end": [0, 0, 1]}
            ),
            "allowed are boxes",
        ),
        (lambda cell: cell.update(robot="nobody"), "nobody"),
    ],
)
def test_a_wrong_file_is_refused_with_a_sentence(tmp_path, change, said):
    with pytest.raises(BodiesError, match=said):
        load_cell(cell=edited(tmp_path, change))


def test_a_body_on_a_link_that_is_not_there_is_refused(tmp_path):
    robots = tmp_path / "robots"
    shutil.copytree(resource("config/robots"), robots)
    path = robots / CELL_ROBOT / "bodies.yaml"
    path.write_text(path.read_text().replace("link_3", "link_9"))
    with pytest.raises(BodiesError, match="link_9"):
        load_cell(robots=robots)


CELL_ROBOT = yaml.safe_load(resource("config/cell.yaml").read_text())["robot"]


def test_bodies_know_what_they_hold():
    box = Box("box", BASE, np.eye(4), np.array([0.1, 0.2, 0.3]))
    capsule = Capsule("capsule", BASE, np.zeros(3), np.array([0.0, 0.0, 0.2]), 0.05)
    points = np.array([[0.09, 0.19, 0.29], [0.11, 0.0, 0.0], [0.0, 0.0, 0.24], [0.0, 0.04, 0.1]])
    assert box.holds(points).tolist() == [True, False, True, True]
    assert capsule.holds(points).tolist() == [False, False, True, True]
    low, high = capsule.reaches(np.eye(4)[None])
    assert np.allclose(low, [[-0.05, -0.05, -0.05]])
    assert np.allclose(high, [[0.05, 0.05, 0.25]])
    low, high = box.reaches(np.eye(4)[None])
    assert np.allclose(high, -low)
    assert np.allclose(high, [[0.1, 0.2, 0.3]])
