"""Files of a cell and of a simulated one: worlds, limits, raw measurements, pictures, moves, models, accounts."""

from __future__ import annotations

import json
import shutil
from collections.abc import Iterator
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import cv2
import numpy as np

from doormill_ros.abb.credentials import load_credentials
from doormill_ros.backup.archive import BackupHead, read_archive, write_archive
from doormill_ros.config import read
from doormill_ros.files import write_atomically
from doormill_ros.localization.calibration.errors import BadCalibrationFile
from doormill_ros.localization.calibration.ros_file import read_ros_file, write_ros_file
from doormill_ros.localization.camera import load_camera
from doormill_ros.measurements.raw.raw_set import read_raw_set
from doormill_ros.measurements.sets.picture_set import read_picture_set
from doormill_ros.models.store import RECORD, ModelStore
from doormill_ros.operator.access.token_file import load_keys
from doormill_ros.recipes.documents import load_recipe
from doormill_ros.recipes.exchange.files import read_file, write_file
from doormill_ros.recipes.exchange.tool_file import read_tool_file
from doormill_ros.recording.replay.answer import STAGES, Answer
from doormill_ros.recording.replay.expectation import FILE, read_expectation, write_expectation
from doormill_ros.robot_model.pose.link_masses import read_masses
from doormill_ros.simulation.controller.configuration.event_routines import read_event_routines
from doormill_ros.simulation.controller.motions.limits import load_limits
from doormill_ros.simulation.controller.operation.configuration import read_system_outputs
from doormill_ros.simulation.world.world_file import load_world
from doormill_ros.thesis.loading_tests import load_thesis_data
from doormill_ros.tools.calibration.doors import Moves
from doormill_ros.yaml_text import parse
from support.hostile.subject import Subject, of_folder, text_folder
from support.source_tree import ROOT

RAW = """schema: doormill/raw-loading-tests/1
robot: irb6600_175_255
wrench_frame_rotation: 0.7688
load_point: [0.0, 0.0, 0.18]
tracker_rotation: [0.0, 0.0, 1.5]
noise: {displacement: 1.0e-5, force: 0.3, torque: 0.03}
tests:
  - name: first
    q: [0.0, 0.1, 0.2, 0.0, 0.5, 0.0]
    force: {loaded: force.csv}
    reflectors:
      - {link: 6, position: [0.05, 0.0, 0.18], unloaded: a.csv, loaded: b.csv}
  - name: second
    q: [0.0, 0.1, 0.2, 0.0, 0.5, 0.0]
    load: {link: 2, point: [0.0, 0.0, 0.0], force: [197.0, 0.0, 0.0]}
    reflectors:
      - {link: 2, position: [0.025, 0.0, 0.0], unloaded: a.csv, loaded: b.csv}
"""
PICTURE_SET = """schema: doormill/picture-set/1
camera: camera.yaml
door: {width: 0.826, thickness: 0.040}
"""
PICTURES = "picture,t,y,z,rotation\n" + "".join(f"p{i}.png,{i}.0,0.00{i},0.001,-0.00{i}\n" for i in range(6))
MOVES = """width: 826.0
height: 2040.0
thickness: 40.0
noise: 2.0
pictures:
  - {picture: p0.png, move: [0.0, 0.0, 0.0]}
  - {picture: p1.png, move: [0.0, 5.0, 0.0]}
  - {picture: p2.png, move: [0.0, 0.0, 5.5], thickness: 60.0}
"""


def _table(header: str, mean: list[float], spread: float, seed: int) -> str:
    """Readings of one thing that stands still, one in a hundredth of a second."""
    values = np.array(mean) + np.random.default_rng(seed).normal(0.0, spread, (400, len(mean)))
    rows = (",".join([f"{0.01 * i:.2f}", *(f"{v:.8f}" for v in row)]) for i, row in enumerate(values))
    return "\n".join([header, *rows]) + "\n"


def _track(offset: float, seed: int) -> str:
    return _table("t,x,y,z", [1.0 + offset, 2.0, 0.5], 1e-6, seed)


def _force() -> str:
    return _table("t,fx,fy,fz,mx,my,mz", [100.0, 2.0, 3.0, 0.1, 0.2, 0.3], 0.01, 3)


def _expectation(folder: Path) -> Path:
    shutil.copytree(ROOT / "bags/unreachable", folder)
    values = {"error_code": 310, "pose": [1.5, 0.25, -0.125], "message": "a, b: c", "found": True}
    answers = [Answer(topic, 1_000_000_000 + i, values) for i, topic in enumerate(sorted(STAGES))]
    write_expectation(folder, {"20261122T002931290381Z": answers})
    return folder


def _written_expectation(value: Any, path: Path) -> None:
    write_expectation(path.parent, value)


def _moves(path: Path) -> Moves:
    return read(path, Moves, BadCalibrationFile, "see docs/calibration.md")


def _record(path: Path) -> object:
    return ModelStore(path.parent).record()


def _written_record(value: Any, path: Path) -> None:
    write_atomically(path, json.dumps(value.document(), indent=2))


def _store(folder: Path) -> Path:
    store = ModelStore(folder, lambda: datetime(2026, 11, 22, tzinfo=UTC))
    for number in range(1, 4):
        store.accept(store.propose(f"model {number}".encode(), "a diagnosis"), "somebody", "it is better")
    store.revert(3, "somebody", "it is not")
    store.stop("the wall is off by 0.5 mm")
    return folder


def _private(folder: Path, name: str, text: str) -> Path:
    text_folder(folder, name, text)
    (folder / name).chmod(0o600)
    return folder


def cell_files(folder: Path) -> Iterator[Subject]:
    """All of them.

    Args:
        folder: Where the good inputs are put.
    """
    yield Subject(
        "expected.yaml",
        _expectation(folder / "expected"),
        FILE,
        of_folder(read_expectation),
        write=_written_expectation,
    )
    for name in ("example", "gap_and_force"):
        world = text_folder(
            folder / f"world_{name}", f"{name}.yaml", (ROOT / f"config/worlds/{name}.yaml").read_bytes()
        )
        yield Subject(f"world {name}", world, f"{name}.yaml", _world)
    raw = text_folder(folder / "raw", "loading_tests.yaml", RAW)
    for name, text in (("a.csv", _track(0.0, 1)), ("b.csv", _track(1e-4, 2)), ("force.csv", _force())):
        text_folder(raw, name, text)
    for name in ("loading_tests.yaml", "b.csv", "force.csv"):
        yield Subject(f"raw {name}", raw, name, of_folder(read_raw_set))
    pictures = text_folder(folder / "pictures", "set.yaml", PICTURE_SET)
    text_folder(pictures, "pictures.csv", PICTURES)
    shutil.copy(ROOT / "config/camera.yaml", pictures)
    for i in range(6):
        cv2.imwrite(str(pictures / f"p{i}.png"), np.full((40, 60), 20 * i, dtype=np.uint8))
    for name in ("set.yaml", "pictures.csv", "camera.yaml", "p3.png"):
        yield Subject(f"picture set {name}", pictures, name, of_folder(_pictures))
    yield Subject("moves", text_folder(folder / "moves", "moves.yaml", MOVES), "moves.yaml", _moves)
    ros = folder / "ros"
    ros.mkdir()
    write_ros_file(load_camera(ROOT / "config/camera.yaml"), "door", ros / "ost.yaml")
    yield Subject("ROS calibration", ros, "ost.yaml", read_ros_file)
    yield Subject("models.json", _store(folder / "models"), RECORD, _record, write=_written_record)
    tests = text_folder(
        folder / "tests", "thesis.yaml", (ROOT / "config/loading_tests/thesis.yaml").read_bytes()
    )
    yield Subject("thesis tests", tests, "thesis.yaml", load_thesis_data)
    limits = text_folder(folder / "limits", "controller.yaml", (ROOT / "config/controller.yaml").read_bytes())
    yield Subject("controller.yaml", limits, "controller.yaml", load_limits)
    masses = text_folder(folder / "masses", "ur10.yaml", (ROOT / "config/link_masses/ur10.yaml").read_bytes())
    yield Subject("link masses", masses, "ur10.yaml", read_masses)
    system = text_folder(folder / "system", "SYS.cfg", (ROOT / "rapid/SYS.cfg").read_bytes())
    yield Subject("SYS.cfg", system, "SYS.cfg", read_event_routines)
    outputs = text_folder(folder / "outputs", "EIO.cfg", (ROOT / "rapid/EIO.cfg").read_bytes())
    yield Subject("system outputs", outputs, "EIO.cfg", read_system_outputs)
    tokens = _private(folder / "tokens", "tokens.yaml", f"operate: {'a' * 20}\nengineer: {'b' * 20}\n")
    yield Subject("page tokens", tokens, "tokens.yaml", load_keys, quiet=True)
    account = _private(folder / "account", "account.yaml", "user: somebody\npassword: secret\npin: '1234'\n")
    yield Subject("credentials", account, "account.yaml", lambda path: load_credentials({}, path), quiet=True)
    yield from _exchanged(folder)
    backup = text_folder(folder / "backup", "a.txt", "content")
    write_archive(
        backup / "site.tar",
        BackupHead("0.1.0", "2026-11-22T12:00:00+00:00"),
        [("config/a.txt", backup / "a.txt")],
    )
    yield Subject("backup", backup, "site.tar", read_archive)


def _exchanged(folder: Path) -> Iterator[Subject]:
    """Recipes of several doors and tools as JSON, as `recipes import` and `tools import` take them."""
    recipes = [load_recipe("standard_door"), load_recipe("nine_point_door")]
    for ending in ("yaml", "json"):
        path = folder / f"doors_{ending}" / f"doors.{ending}"
        path.parent.mkdir(parents=True)
        write_file(path, recipes)
        yield Subject(f"recipes {ending}", path.parent, path.name, read_file, write=_written_doors)
    document = parse((ROOT / "config/tools.yaml").read_text())
    tools = text_folder(folder / "tools_json", "tools.json", json.dumps(document, indent=1))
    yield Subject("tools.json", tools, "tools.json", tools_by_name)


def _written_doors(value: Any, path: Path) -> None:
    write_file(path, value)


def tools_by_name(path: Path) -> object:
    """Tools of a file; their order is that of the file, which means nothing."""
    return {tool.name: tool for tool in read_tool_file(path)}


def _world(path: Path) -> object:
    world = load_world(path)
    return world, [world.door(number) for number in (0, 5, 40)]


def _pictures(folder: Path) -> object:
    read = read_picture_set(folder)
    return read, [read.picture(row) for row in range(len(read))]
