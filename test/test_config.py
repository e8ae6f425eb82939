"""Every configuration is read in one way: whatever is wrong with a file becomes one sentence and one code."""

import json
import math
import os
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

from doormill_ros.cell.errors import BadCellFile
from doormill_ros.cell.places.layout import load_layout
from doormill_ros.config import check, read
from doormill_ros.errors import DoormillError
from doormill_ros.localization.camera import load_camera
from doormill_ros.localization.errors import BadCameraFile
from doormill_ros.localization.sensors.axis_vision import load_axis_vision
from doormill_ros.localization.sensors.errors import BadSensorFile
from doormill_ros.localization.sensors.one_camera import load_one_camera
from doormill_ros.localization.sensors.photoelectric import load_photoelectric
from doormill_ros.localization.sensors.touch_probe import load_touch_probe
from doormill_ros.localization.settings import load_settings as load_localizer
from doormill_ros.resources import resource
from doormill_ros.robot.description import load_robot
from doormill_ros.robot.errors import RobotDescriptionError
from doormill_ros.robot_model.errors import ExtendedModelError
from doormill_ros.robot_model.extended_model import load_compliance_model
from doormill_ros.simulation.controller.motions.limits import load_limits
from doormill_ros.simulation.errors import (
    ControllerLimitsError,
    EffectsFileError,
    SceneFileError,
    WorldFileError,
)
from doormill_ros.simulation.picture.scene import SceneCamera
from doormill_ros.simulation.robot_cell import load_effects
from doormill_ros.simulation.world.world_file import load_world
from doormill_ros.toolpath.errors import PathSettingsError
from doormill_ros.toolpath.settings import load_settings as load_toolpath
from doormill_ros.values import Array, Count, Exactly, Finite, Name, NotNegative, Positive, Section
from doormill_ros.yaml_text import NotYaml, parse

LOADERS = {
    "cell": (load_layout, BadCellFile, "config/cell.yaml"),
    "camera": (load_camera, BadCameraFile, "config/camera.yaml"),
    "localizer": (load_localizer, BadCameraFile, "config/camera.yaml"),
    "toolpath": (load_toolpath, PathSettingsError, "config/toolpath.yaml"),
    "robot": (load_robot, RobotDescriptionError, "config/robots/irb6600_175_255/robot.yaml"),
    "one_camera": (load_one_camera, BadSensorFile, "config/sensors/one_camera.yaml"),
    "axis_vision": (load_axis_vision, BadSensorFile, "config/sensors/axis_vision.yaml"),
    "photoelectric": (load_photoelectric, BadSensorFile, "config/sensors/photoelectric.yaml"),
    "touch_probe": (load_touch_probe, BadSensorFile, "config/sensors/touch_probe.yaml"),
}
LOADERS["controller"] = (load_limits, ControllerLimitsError, "config/controller.yaml")
LOADERS["world"] = (load_world, WorldFileError, "config/worlds/example.yaml")
LOADERS["scene"] = (SceneCamera.load, SceneFileError, "config/camera.yaml")
NO_CONFIGURATION = {
    "empty": b"",
    "null": b"~\n",
    "list": b"- 1\n",
    "number": b"17\n",
    "broken": b"a: [1, 2\n",
    "tabs": b"a:\n\t- 1\n",
    "nul": b"a: \x00\n",
    "no text": b"\xff\xfe\x00\xd8\x80",
    "python": b"!!python/object/apply:os.system ['true']\n",
    "two documents": b"--- {}\n--- {}\n",
    "twice": b"robot: 1\nrobot: 2\n",
    "deep": b"[" * 100_000,
    "bad tag": b"robot: !!int ''\n",
    "bad time": b"robot: !!timestamp x\n",
    "list as key": b"? [a]\n: 1\n",
    "long number": b"robot: " + b"9" * 5000,
}


def one_sentence(error: DoormillError, path: Path) -> None:
    assert str(path) in error.message
    assert "\n" not in error.message
    assert len(error.message) < 700


@pytest.mark.parametrize("content", NO_CONFIGURATION.values(), ids=NO_CONFIGURATION)
@pytest.mark.parametrize("loader", LOADERS)
def test_a_file_that_is_no_configuration_is_one_sentence(loader, content, tmp_path):
    load, error, _ = LOADERS[loader]
    path = tmp_path / "robot.yaml"
    path.write_bytes(content)
    with pytest.raises(error) as caught:
        load(path)
    assert type(caught.value) is error
    one_sentence(caught.value, path)


@pytest.mark.parametrize("loader", LOADERS)
def test_a_missing_file_is_one_sentence(loader, tmp_path):
    load, error, _ = LOADERS[loader]
    path = tmp_path / "nothing.yaml"
    with pytest.raises(error, match="No such file") as caught:
        load(path)
    one_sentence(caught.value, path)


def places(document: object, path: tuple = ()) -> list[tuple]:
    """Every place of a document, parents first."""
    items = document.items() if isinstance(document, dict) else enumerate(document)
    found = []
    for key, value in items:
        found.append((*path, key))
        if isinstance(value, dict | list):
            found += places(value, (*path, key))
    return found


@cache
def plain(name: str) -> str:
    """A shipped file as JSON, which is read hundreds of times as fast: what two keys share stands twice."""
    return json.dumps(yaml.safe_load(resource(LOADERS[name][2]).read_text(encoding="utf-8")))


def changed(name: str, place: tuple, value: object) -> str:
    document = json.loads(plain(name))
    node = document
    for key in place[:-1]:
        node = node[key]
    node[place[-1]] = value
    return yaml.dump(document, Dumper=yaml.CSafeDumper)


# Keys that a calibration or an identification leaves behind and the loaders pass by.
PASSED_BY = {"deviation", "std", "localizer", "label"}
OF_OTHERS = {"localizer": PASSED_BY - {"localizer"}, "scene": PASSED_BY | {"rotation_vector"}}
IMPOSSIBLE = [{}, True, "far", math.nan, -(10**400)]


@pytest.mark.parametrize("name", LOADERS)
def test_no_value_of_a_shipped_file_may_be_anything(name, tmp_path):
    """Each number of each file is replaced by what is none; the sentence names its key."""
    load, error, form = LOADERS[name]
    document = yaml.safe_load(resource(form).read_text(encoding="utf-8"))
    if name == "localizer":
        document = {"localizer": document["localizer"]}
    path = tmp_path / "robot.yaml"
    numbers = 0
    for place in places(document):
        value = document
        for key in place:
            value = value[key]
        if (
            isinstance(value, bool)
            or not isinstance(value, int | float)
            or set(place) & OF_OTHERS.get(name, PASSED_BY)
        ):
            continue
        numbers += 1
        for wrong in IMPOSSIBLE:
            path.write_text(changed(name, place, wrong))
            with pytest.raises(error) as caught:
                load(path)
            assert place[0] in caught.value.message
            assert "allowed" in caught.value.message
            one_sentence(caught.value, path)
    assert numbers > 1


@pytest.mark.parametrize("name", [name for name in LOADERS if name != "scene"])
def test_an_unknown_key_is_named_with_those_that_are_known(name, tmp_path):
    load, error, form = LOADERS[name]
    document = yaml.safe_load(resource(form).read_text(encoding="utf-8"))
    sections = [place for place in places(document) if set(place) & PASSED_BY == set()]
    sections = [()] + [place for place in sections if isinstance(place[-1], str)]
    path = tmp_path / "robot.yaml"
    tried = 0
    for place in [("localizer",)] if name == "localizer" else sections:
        whole = node = json.loads(plain(name))
        for key in place:
            node = node[key]
        if not isinstance(node, dict):
            continue
        known = set(node)
        node["colour"] = 1
        path.write_text(yaml.dump(whole, Dumper=yaml.CSafeDumper))
        with pytest.raises(error, match=r"colour is unknown, allowed are") as caught:
            load(path)
        assert known - {"colour"} <= set(
            caught.value.message.split("allowed are ")[1].replace(";", ",").split(", ")
        )
        tried += 1
    assert tried >= 1


def test_other_documents_are_read_the_same_way(tmp_path):
    path = tmp_path / "x.yaml"
    path.write_text("a: [1,\n")
    with pytest.raises(EffectsFileError, match="cannot be read, not YAML line 2, column 1"):
        load_effects(path)
    with pytest.raises(ExtendedModelError, match="cannot be read"):
        load_compliance_model(path)
    path.write_text("- {cause: joint_friction, where: joint 3}\n")
    with pytest.raises(EffectsFileError, match=r"0\.parameters is missing"):
        load_effects(path)
    path.write_text("- {cause: joint_friction, where: joint 3, parameters: {torque: 2.0}}\n")
    assert load_effects(path) == (
        {"cause": "joint_friction", "where": "joint 3", "parameters": {"torque": 2.0}},
    )


@dataclass(frozen=True, eq=False)
class Part(Section):
    size: Positive
    kind: Literal["round", "square"]
    grid: Annotated[np.ndarray, Array((2, 3))]
    count: Count = 1
    shift: NotNegative | None = None


@dataclass(frozen=True, eq=False)
class Whole(Section):
    schema: Annotated[str, Exactly("test/1")]
    parts: tuple[Part, ...]
    where: dict[str, Finite]
    name: Name = "a"


GOOD = {"size": 1, "kind": "round", "grid": [[1, 2, 3], [4, 5, "6e2"]]}
DOCUMENT = {"schema": "test/1", "parts": [GOOD], "where": {"x": "-1e-3"}}


def test_a_model_holds_what_the_document_says():
    whole = check({**DOCUMENT, "parts": [{**GOOD, "count": 2.0}]}, Whole, BadCellFile, "d")
    part = whole.parts[0]
    assert (part.size, part.kind, part.count, part.shift, whole.name) == (1.0, "round", 2, None, "a")
    assert type(part.count) is int
    assert whole.where == {"x": -1e-3}
    np.testing.assert_array_equal(part.grid, [[1, 2, 3], [4, 5, 600]])
    with pytest.raises(ValueError, match="read-only"):
        part.grid[0, 0] = 1.0


@pytest.mark.parametrize(
    ("document", "sentence"),
    [
        (None, "d: it holds nothing, allowed is a mapping; "),
        ([1], "d: it holds [1], allowed is a mapping; "),
        ({**DOCUMENT, "schema": "test/2"}, "d: schema is 'test/2', allowed is test/1; "),
        ({"parts": [], "where": {}}, "d: schema is missing, allowed is test/1; "),
        ({**DOCUMENT, "name": ""}, "d: name is '', allowed is text that is not empty; "),
        ({**DOCUMENT, "name": 5}, "d: name is 5, allowed is text; "),
        ({**DOCUMENT, "parts": 5}, "d: parts is 5, allowed is a list; "),
        ({**DOCUMENT, "parts": [GOOD, 5]}, "d: parts.1 is 5, allowed is a mapping; "),
        ({**DOCUMENT, "parts": [{}]}, "d: parts.0.size is missing, allowed is a positive number; "),
        (
            {**DOCUMENT, "parts": [{**GOOD, "colour": 1, "size": -1}]},
            "d: parts.0.colour is unknown, allowed are size, kind, grid, count, shift; ",
        ),
        ({**DOCUMENT, "parts": [{**GOOD, "size": True}]}, "d: parts.0.size is True, allowed is a positive number; "),
        ({**DOCUMENT, "parts": [{**GOOD, "size": "1"}]}, "d: parts.0.size is '1', allowed is a positive number; "),
        ({**DOCUMENT, "parts": [{**GOOD, "shift": -1}]}, "d: parts.0.shift is -1, allowed is a number from 0 up; "),
        (
            {**DOCUMENT, "parts": [{**GOOD, "count": 1.5}]},
            "d: parts.0.count is 1.5, allowed is a positive whole number; ",
        ),
        (
            {**DOCUMENT, "parts": [{**GOOD, "kind": "oval"}]},
            "d: parts.0.kind is 'oval', allowed is 'round' or 'square'; ",
        ),
        (
            {**DOCUMENT, "parts": [{**GOOD, "grid": [[1, 2, 3]]}]},
            "d: parts.0.grid is [[1, 2, 3]], allowed are 2 x 3 finite numbers; ",
        ),
        ({**DOCUMENT, "where": {"x": math.inf}}, "d: where.x is inf, allowed is a finite number; "),
        ({**DOCUMENT, "where": [1]}, "d: where is [1], allowed is a mapping; "),
    ],
)  # fmt: skip
def test_the_sentence_names_key_value_and_what_is_allowed(document, sentence):
    with pytest.raises(BadCellFile) as caught:
        check(document, Whole, BadCellFile, "d", "say it right")
    assert caught.value.message == sentence + "say it right"


ANYTHING = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=5),
    lambda inner: (
        st.lists(inner, max_size=3)
        | st.dictionaries(
            st.text(max_size=3) | st.sampled_from(["schema", "parts", "where", "size"]), inner, max_size=3
        )
    ),
    max_leaves=8,
)


@settings(max_examples=200, deadline=None)
@given(st.dictionaries(st.sampled_from(["schema", "parts", "where", "name"]), ANYTHING))
def test_no_document_raises_anything_else(document):
    with pytest.raises(BadCellFile):
        check({**document, "schema": "x"}, Whole, BadCellFile, "d")


@settings(max_examples=300, deadline=None)
@given(st.text(alphabet="ab:-[]{}!&*#|>'\"%@`,?~ \n\t0123456789.eE_<=", max_size=40))
def test_no_text_raises_anything_else(text):
    """Read, or refused as no YAML."""
    with suppress(NotYaml):
        parse(text)


def test_read_is_parse_and_check(tmp_path):
    path = tmp_path / "x.yaml"
    path.write_text(yaml.safe_dump(DOCUMENT), encoding="utf-8-sig")
    assert read(path, Whole, BadCellFile).parts[0].size == 1.0


@pytest.mark.timeout(60)
def test_what_is_no_regular_file_of_text_is_refused_by_its_place(tmp_path):
    path = tmp_path / "world.yaml"
    os.mkfifo(path)
    with pytest.raises(
        EffectsFileError, match="cannot be read, a pipe, a device or a socket, not a regular file;"
    ):
        load_effects(path)
    path.unlink()
    path.write_bytes("\ufeffschema: 1\r\nä: ".encode() + b"\xe4\r\n")
    with pytest.raises(
        EffectsFileError, match=r"cannot be read, line 2, column 4: is no UTF-8 text \(.*\); allowed is"
    ):
        load_effects(path)
