"""What the campaign of bad files once found, each as a file of its own: file, place and a sentence, or the value."""

from __future__ import annotations

import json
import random
import re
from collections.abc import Callable
from pathlib import Path

import pytest

from doormill_ros.errors import LONGEST, DoormillError
from doormill_ros.measurements.documents.schemas import PICTURE_SET as PICTURES
from doormill_ros.measurements.documents.set_document import SetDocument
from doormill_ros.measurements.sets.picture_set import read_picture_set
from doormill_ros.models.store import RECORD, ModelStore
from doormill_ros.recipes.documents import load_recipe
from doormill_ros.recipes.exchange.files import read_file
from doormill_ros.resources import resource
from doormill_ros.robot.description import load_robot
from doormill_ros.robot_model.extended_model import load_compliance_model
from doormill_ros.simulation.controller.configuration.event_routines import read_event_routines
from doormill_ros.simulation.controller.operation.configuration import read_system_outputs
from support.hostile.keeping import spelt_anew

ROBOT = resource("config/robots/irb6600_175_255/robot.yaml")
MODEL = """schema: doormill/extended-model/1
robot: irb6600_175_255
joint_stiffness: [1.0e6, 1.0e6, 1.0e6, 1.0e6, 1.0e6, 1.0e6]
causes:
  - {cause: joint_offset, where: joint 3, parameters: {offset: 1.0e-3}}
"""
MODELS = {
    "schema": "doormill/models/1",
    "issued": 1,
    "versions": [{"number": 1, "made": "2026", "source": "s", "sha256": "0"}],
    "orders": [],
    "stop": None,
}
VERSION = MODELS["versions"][0]


def _record(path: Path) -> object:
    return ModelStore(path.parent).record()


def _pictures(path: Path) -> object:
    return read_picture_set(path.parent)


@pytest.mark.parametrize(
    ("name", "content", "read", "places"),
    [
        ("a.json", b'{"schema": 1, "schema": 2}', read_file, ["schema", "twice"]),
        ("a.yaml", b"schema: 1\nschema: 2\n", read_file, ["schema", "line 2"]),
        ("a.yaml", b"schema: 1\nheight_mm: !!int x\n", load_recipe, ["line 2"]),
        ("set.yaml", b"rate: 1\nmodel:\n  a: 1\n  a: 2\n", SetDocument, ["line 4", "twice"]),
        ("set.yaml", b"rate: 1\nmodel: !!int x\n", SetDocument, ["line 2"]),
        ("model.yaml", MODEL.replace("1.0e-3", "{a: 1}").encode(), load_compliance_model, ["causes.0"]),
        ("model.yaml", MODEL.replace("joint 3", "joint 9").encode(), load_compliance_model, ["causes.0"]),
        ("model.yaml", MODEL.replace("irb6600_175_255", "a" * 5000).encode(), load_compliance_model, ["robot"]),
        ("robot.json", b"", lambda path: load_robot("a" * 300), ["no robot"]),
        (RECORD, json.dumps(MODELS | {"versions": [VERSION | {"made": 3}]}).encode(), _record, ["versions.0.made"]),
        (RECORD, json.dumps(MODELS | {"versions": [VERSION | {"more": 3}]}).encode(), _record, ["versions.0"]),
        (RECORD, json.dumps(MODELS | {"stop": {"version": "1", "message": "m"}}).encode(), _record, ["stop.version"]),
        (RECORD, json.dumps(MODELS | {"orders": None}).encode(), _record, ["orders"]),
        ("b.json", b'{"schema": 1,\n"mass_kg": ' + 5000 * b"1" + b"}", read_file, ["line 2"]),
        ("set.yaml", f"schema: {PICTURES}\ncamera: {300 * 'a'}\n".encode(), _pictures, ["camera"]),
        ("EIO.cfg", b"EIO:CFG_1.0:6:1::\n\xb6", read_system_outputs, ["byte 18"]),
        ("SYS.cfg", b"SYS:CFG_1.0:6:1::\n\xb6", read_event_routines, ["byte 18"]),
    ],
)  # fmt: skip
def test_a_sentence_names_file_and_place(
    tmp_path: Path, name: str, content: bytes, read: Callable[[Path], object], places: list[str]
) -> None:
    path = tmp_path / name
    path.write_bytes(content)
    with pytest.raises(DoormillError) as refused:
        read(path)
    sentence = str(refused.value)
    assert name in sentence or name == "robot.json"
    assert all(place in sentence for place in places), sentence
    assert len(sentence) <= LONGEST


def test_a_place_in_front_keeps_the_sentence_short(tmp_path: Path) -> None:
    path = tmp_path / "doors.json"
    document = load_recipe("standard_door").to_document()
    path.write_text(json.dumps([document | {"x" * 5000: 1}]))
    with pytest.raises(DoormillError, match=r"doors\.json") as refused:
        read_file(path)
    assert len(str(refused.value)) <= LONGEST
    assert refused.value.message == str(refused.value)


def test_a_flange_that_no_table_reaches_names_the_file(tmp_path: Path) -> None:
    urdf = (ROBOT.parent / "robot.urdf").read_text(encoding="utf-8")
    turned = re.sub(
        r'(<joint name="flange_joint".*?rpy=")[^"]*', r"\g<1>0.3 0 0", urdf, count=1, flags=re.DOTALL
    )
    assert turned != urdf
    (tmp_path / "robot.urdf").write_text(turned, encoding="utf-8")
    (tmp_path / "robot.yaml").write_bytes(ROBOT.read_bytes())
    with pytest.raises(DoormillError, match=r"robot\.urdf: the flange is"):
        load_robot(tmp_path)


def test_a_column_inside_another_names_the_file(tmp_path: Path) -> None:
    path = tmp_path / "doors.csv"
    path.write_text("record,door_id,mass,mass.kg\ndoor,a,1,2\n")
    with pytest.raises(DoormillError, match=r"doors\.csv row 2"):
        read_file(path)


@pytest.mark.parametrize(
    ("form", "text"),
    [
        ("yaml", "b: [1.5, 2]\na: {d: 1.0e-3, c: text}\n"),
        ("json", '{"b": [1.5, 2], "a": {"d": 0.001, "c": "text"}}'),
        ("csv", "b,a\n1.5,text\n2.25,other\n"),
    ],
)
def test_another_spelling_is_another_text(form: str, text: str) -> None:
    others = {spelt_anew(text.encode(), form, random.Random(seed)) for seed in range(20)}
    assert len(others - {text.encode()}) > 3


def test_a_record_with_a_byte_order_mark_is_read(tmp_path: Path) -> None:
    (tmp_path / RECORD).write_bytes(b"\xef\xbb\xbf" + json.dumps(MODELS).encode())
    assert ModelStore(tmp_path).record().issued == 1
