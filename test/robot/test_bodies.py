"""What robots take up is read and refused field by field."""

import shutil
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from doormill_ros.frames import transform
from doormill_ros.robot.bodies import Body, load_bodies
from doormill_ros.robot.description import load_robot
from doormill_ros.robot.errors import RobotDescriptionError

GOOD = "{name: arm, link: link_2, shape: capsule, radius: 0.1, start: [0, 0, 0], end: [0, 0, 1]}"


def robot_with(tmp_path: Path, body: str):
    folder = tmp_path / "arm"
    shutil.copytree(load_robot("irb6600_175_255").urdf.parent, folder)
    text = f"schema: doormill/bodies/1\nsource: here\nmeasured: false\nbodies:\n  - {body}\n"
    (folder / "bodies.yaml").write_text(text)
    return load_robot(folder)


@pytest.mark.parametrize("name", ["irb6600_175_255", "irb6700_235_265"])
def test_shipped_robots_have_a_body_on_every_link(name):
    bodies = load_bodies(load_robot(name))
    assert {body.link for body in bodies} == {"base_link", *(f"link_{i}" for i in range(1, 7))}
    assert len({body.name for body in bodies}) == len(bodies)


def test_a_capsule_reaches_from_end_to_end(tmp_path):
    (body,) = load_bodies(robot_with(tmp_path, GOOD))
    np.testing.assert_array_equal(body.corners, [[0, 0, 0], [0, 0, 1]])
    assert body.margin == 0.1


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("link_2", "link_9", "arm hangs on link link_9, allowed are base_link, link_1"),
        ("shape: capsule", "shape: ball", "shape 'ball', allowed are box and capsule"),
        (", end: [0, 0, 1]", "", "capsule 'arm' has radius, start, allowed are radius, start, end"),
        ("radius: 0.1", "radius: -0.1", "radius is -0.1, allowed is a positive number"),
        ("radius: 0.1", "radius: 0.1, size: [1, 1, 1]", "allowed are radius, start, end"),
        ("end: [0, 0, 1]", "end: [0, 0]", "allowed are 3 finite numbers"),
        ("link: link_2, ", "", "link is missing"),
        ("name: arm", "colour: red, name: arm", "colour is unknown"),
    ],
)
def test_what_is_wrong_is_named(tmp_path, old, new, words):
    with pytest.raises(RobotDescriptionError) as found:
        load_bodies(robot_with(tmp_path, GOOD.replace(old, new)))
    assert words in found.value.message
    assert "bodies.yaml" in found.value.message


def test_a_robot_without_the_file_is_refused(tmp_path):
    robot = robot_with(tmp_path, GOOD)
    (robot.urdf.parent / "bodies.yaml").unlink()
    with pytest.raises(RobotDescriptionError, match=r"bodies\.yaml cannot be read"):
        load_bodies(robot)


def test_a_body_stays_where_it_is_in_another_frame():
    rng = np.random.default_rng(8)
    T = transform(Rotation.random(rng=1).as_matrix(), rng.normal(size=3))
    box = Body(
        "b", "box", size=np.array([1.0, 2.0, 3.0]), position=rng.normal(size=3), rotation=rng.normal(size=3)
    )
    capsule = Body("c", "capsule", radius=0.2, start=rng.normal(size=3), end=rng.normal(size=3))
    for body in (box, capsule):
        expected = body.corners @ T[:3, :3].T + T[:3, 3]
        np.testing.assert_allclose(body.mapped(T).corners, expected, atol=1e-12)
