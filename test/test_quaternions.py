"""Quaternions and matrices are SciPy's to the last bit, and nodes that only pass poses on start without it."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from doormill_ros import quaternions
from doormill_ros.quaternions import matrix_of, quaternion_of

PASSED_ON = """
import sys
from doormill_ros.abb.target_file.rehearsal import PROGRAM, rehearse
from doormill_interfaces.msg import TargetArray
from rclpy.serialization import serialize_message
from doormill_ros.messages.from_message import program_of
from doormill_ros.nodes.convert.program import program_into
from doormill_ros.nodes.convert.recipe import recipe_message
from doormill_ros.recording.typestores import reader_of
from doormill_ros.recipes.documents import shipped_recipes
from std_msgs.msg import Header
read = reader_of("doormill_interfaces/msg/TargetArray")
rehearse(program_of(read(serialize_message(program_into(TargetArray(), PROGRAM)))))
for recipe in shipped_recipes().values():
    recipe_message(recipe, "", Header())
print(*(name for name in sys.modules if name.startswith("scipy")))
"""


@pytest.fixture(autouse=True)
def without_scipy(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(quaternions, "_loaded", lambda: None)


def some_quaternions() -> np.ndarray:
    """Random ones of many lengths, half turns, turns about one axis, all that map the axes onto each other."""
    q = np.random.default_rng(1).normal(size=(4000, 4)) * np.geomspace(1e-3, 1e3, 4000)[:, None]
    q[:500, 3] = 0.0
    q[500:1000, :2] = 0.0
    return np.concatenate([q, Rotation.create_group("O").as_quat()])


def test_matrices_are_those_of_scipy() -> None:
    q = some_quaternions()
    assert np.array_equal(matrix_of(q), Rotation.from_quat(q).as_matrix())
    assert np.array_equal(matrix_of(q[7]), Rotation.from_quat(q[7]).as_matrix())
    assert matrix_of(q[:24].reshape(4, 6, 4)).shape == (4, 6, 3, 3)


def test_quaternions_are_those_of_scipy() -> None:
    exact = Rotation.from_quat(some_quaternions()).as_matrix()
    for R in (exact, np.round(Rotation.create_group("O").as_matrix())):
        assert np.array_equal(quaternion_of(R), Rotation.from_matrix(R).as_quat(canonical=True))
    assert np.array_equal(quaternion_of(exact[7]), Rotation.from_matrix(exact[7]).as_quat(canonical=True))
    assert quaternion_of(exact[:24].reshape(4, 6, 3, 3)).shape == (4, 6, 4)
    assert quaternion_of(exact[:0]).shape == (0, 4)


def test_a_matrix_that_is_none_of_a_rotation_is_made_one_as_scipy_does() -> None:
    R = Rotation.from_quat(some_quaternions()[:50]).as_matrix()
    R[3] *= 1.0 + 1e-9
    R[4, 0, 1] += 1e-7
    assert np.array_equal(quaternion_of(R), Rotation.from_matrix(R).as_quat(canonical=True))


def test_what_turns_nothing_is_refused() -> None:
    with pytest.raises(ValueError, match="determinant"):
        quaternion_of(np.diag([1.0, 1.0, -1.0]))
    with pytest.raises(ValueError, match="zero norm"):
        matrix_of(np.zeros(4))


def test_who_passes_poses_on_loads_no_scipy() -> None:
    done = subprocess.run([sys.executable, "-c", PASSED_ON], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == ""
