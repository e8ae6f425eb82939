"""Every file that a user can hand over, a good one of each, and the function that reads it."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import yaml

from doormill_ros.abb.target_file.target_file import read_target_file
from doormill_ros.catalogue.bag_rows import read_inspection_row, read_rows
from doormill_ros.cell.places.layout import load_layout
from doormill_ros.localization.calibration.camera_file import read_document, write_document
from doormill_ros.localization.camera import load_camera
from doormill_ros.localization.pictures.picture_file import read_picture
from doormill_ros.localization.sensors.axis_vision import load_axis_vision
from doormill_ros.localization.sensors.freedom import load_freedom
from doormill_ros.localization.sensors.one_camera import load_one_camera
from doormill_ros.localization.sensors.photoelectric import load_photoelectric
from doormill_ros.localization.sensors.readings import read_readings
from doormill_ros.localization.sensors.touch_probe import load_touch_probe
from doormill_ros.localization.settings import load_settings as load_localizer_settings
from doormill_ros.measurements.inspections.inspection import read_inspection
from doormill_ros.measurements.raw.raw_files import read_force_log, read_tracker_file
from doormill_ros.measurements.sets.measurement_set import COLUMNS, read_measurement_set
from doormill_ros.measurements.sets.motion_set import read_motion_set
from doormill_ros.measurements.sets.pose_set import read_pose_set
from doormill_ros.recipes.documents import load_recipe, to_json, to_yaml
from doormill_ros.recipes.exchange.csv_file import format_csv
from doormill_ros.recipes.exchange.files import read_file, write_file
from doormill_ros.recipes.exchange.thesis_text import format_thesis_text
from doormill_ros.recipes.exchange.xlsx_file import format_xlsx
from doormill_ros.recording.bag_reader import read_bag
from doormill_ros.recording.replay.run_reader import read_runs
from doormill_ros.robot import description
from doormill_ros.robot.description import load_robot
from doormill_ros.robot_model.elastic.causes.registry import build_cause
from doormill_ros.robot_model.extended_document import model_document
from doormill_ros.robot_model.extended_model import SizedCause, load_compliance_model
from doormill_ros.simulation.controller.configuration.io_configuration import read_io_configuration
from doormill_ros.simulation.robot_cell import load_effects
from doormill_ros.toolpath.settings import load_settings
from support.hostile.cell_files import cell_files, tools_by_name
from support.hostile.subject import Read, Subject, of_folder, text_folder
from support.hostile.wire import controller_answers
from support.source_tree import ROOT


def _calibrated(path: Path) -> Any:
    """What calibrations write over: only what the localizer reads is written."""
    load_camera(path)
    load_localizer_settings(path)
    return read_document(path)


def _copied(folder: Path, *sources: Path) -> Path:
    folder.mkdir(parents=True, exist_ok=True)
    for source in sources:
        shutil.copy(source, folder / source.name)
    return folder


def first_rows(folder: Path, source: Path, table: str, lines: int) -> Path:
    """A measured set with no more than the first lines of its table; returns the folder."""
    folder.mkdir()
    shutil.copy(source / "set.yaml", folder)
    rows = (source / table).read_bytes().split(b"\n")[:lines]
    (folder / table).write_bytes(b"\n".join(rows) + b"\n")
    return folder


LOADING_SET = """schema: doormill/measurement-set/1
robot: irb6600_175_255
model:
  joint_stiffness: [2.4e6, 2.1e6, 1.7e6, 3.4e5, 1.2e5, 4.6e4]
noise:
  displacement: 8e-6
  force: 0.3
  torque: 0.03
wrench_frame_rotation: 0.7688
load_point: [0.0, 0.0, 0.18]
reflectors:
  ee: {link: 6, position: [0.05, 0.0, 0.18]}
"""
LOADING_ROWS = "\n".join(
    [
        ",".join(COLUMNS),
        *(
            f"{i},{10 * i},30,20.5,0,0.1,0.2,0.3,0.4,0.5,-1,0,1,1,1,1,1,2,3,4,5,6,ee,1e-5,2e-5,-3e-5"
            for i in range(1, 9)
        ),
    ]
)
INSPECTION = """schema: doormill/inspection/1
run_id: 20261122T002931290381Z
bag: bag
measured_at: 2026-11-22T08:00:00Z
noise: 1.0e-5
datum: camera
"""
POINTS = "feature,surface,x,y,z,nx,ny,nz,deviation\n" + "".join(
    f"hinge_1,wall,0.002,0.0{i},0.2,0.0,1.0,0.0,1.{i}e-5\n" for i in range(1, 9)
)
EFFECTS = """- {cause: joint_stiffness, where: joint 3, parameters: {stiffness: 1.0e6}}
- {cause: joint_backlash, where: joint 1, parameters: {gap: 1.0e-4, crossing_torque: 10.0}}
"""
TRACKER = "t,x,y,z\n" + "".join(f"{0.01 * i:.2f},1.0000{i % 10},2.0,0.5\n" for i in range(60))
FORCES = "t,fx,fy,fz,mx,my,mz\n" + "".join(f"{0.01 * i:.2f},1.{i % 10},2,3,0.1,0.2,0.3\n" for i in range(60))


def subjects(folder: Path) -> Iterator[Subject]:
    """All of them.

    Args:
        folder: Where the good inputs are put.
    """
    config = ROOT / "config"
    recipe = load_recipe("standard_door")
    yield Subject(
        "recipe.yaml",
        _copied(folder / "recipe", config / "recipes/standard_door.yaml"),
        "standard_door.yaml",
        load_recipe,
        write=lambda value, path: path.write_text(to_yaml(value)),
    )
    yield Subject(
        "recipe.json",
        text_folder(folder / "json", "door.json", to_json(recipe)),
        "door.json",
        load_recipe,
        write=lambda value, path: path.write_text(to_json(value)),
    )
    yield Subject(
        "recipes.csv",
        text_folder(folder / "csv", "doors.csv", format_csv([recipe])),
        "doors.csv",
        read_file,
        write=_doors,
    )
    xlsx = folder / "xlsx"
    xlsx.mkdir(parents=True)
    (xlsx / "doors.xlsx").write_bytes(format_xlsx([recipe]))
    yield Subject("recipes.xlsx", xlsx, "doors.xlsx", read_file, write=_doors)
    yield Subject("tools.yaml", _copied(folder / "tools", config / "tools.yaml"), "tools.yaml", tools_by_name)
    text = format_thesis_text(load_recipe("thesis_190_0deg"))
    yield Subject(
        "thesis text", text_folder(folder / "thesis", "door.txt", text), "door.txt", read_file, write=_doors
    )

    loading = text_folder(folder / "loading", "set.yaml", LOADING_SET)
    text_folder(loading, "trials.csv", LOADING_ROWS)
    yield Subject("loading set.yaml", loading, "set.yaml", of_folder(read_measurement_set))
    yield Subject("loading trials.csv", loading, "trials.csv", of_folder(read_measurement_set))
    motion = first_rows(folder / "motion", ROOT / "test/data/kr300/A", "samples.csv", 400)
    yield Subject("motion set.yaml", motion, "set.yaml", of_folder(read_motion_set))
    yield Subject("motion samples.csv", motion, "samples.csv", of_folder(read_motion_set))
    poses = first_rows(folder / "poses", ROOT / "test/data/ur10/grid", "poses.csv", 60)
    yield Subject("pose set.yaml", poses, "set.yaml", of_folder(read_pose_set))
    yield Subject("poses.csv", poses, "poses.csv", of_folder(read_pose_set))
    door = text_folder(folder / "inspection", "inspection.yaml", INSPECTION)
    text_folder(door, "points.csv", POINTS)
    shutil.copytree(ROOT / "bags/unreachable", door / "bag")
    yield Subject("inspection.yaml", door, "inspection.yaml", of_folder(read_inspection))
    yield Subject("points.csv", door, "points.csv", of_folder(read_inspection))
    yield Subject("inspection of the catalogue", door, "inspection.yaml", of_folder(read_inspection_row))
    yield Subject(
        "tracker file", text_folder(folder / "tracker", "a.csv", TRACKER), "a.csv", read_tracker_file
    )
    yield Subject("force log", text_folder(folder / "force", "a.csv", FORCES), "a.csv", read_force_log)

    layout = load_layout()
    yield Subject("cell.yaml", _copied(folder / "cell", config / "cell.yaml"), "cell.yaml", load_layout)
    yield Subject(
        "toolpath.yaml", _copied(folder / "path", config / "toolpath.yaml"), "toolpath.yaml", load_settings
    )
    yield Subject(
        "camera.yaml", _copied(folder / "camera", config / "camera.yaml"), "camera.yaml", load_camera
    )
    yield Subject(
        "localizer settings",
        _copied(folder / "localizer", config / "camera.yaml"),
        "camera.yaml",
        load_localizer_settings,
    )
    yield Subject(
        "calibration file",
        _copied(folder / "calibration", config / "camera.yaml"),
        "camera.yaml",
        _calibrated,
        write=lambda value, path: write_document(value, path),
    )
    robot = config / "robots/irb6600_175_255"
    described = _copied(folder / "robot", *(p for p in robot.iterdir() if p.is_file()))
    yield Subject("robot.yaml", described, "robot.yaml", _robot)
    yield Subject("robot.urdf", described, "robot.urdf", lambda path: _robot(path.with_name("robot.yaml")))
    spring = SizedCause(build_cause("joint_offset", "joint 3"), np.array([1e-3]))
    play = SizedCause(build_cause("tool_compliance", "flange"), np.array([2e5]))
    stiffness = load_robot("irb6600_175_255").stiffness
    document = model_document("irb6600_175_255", stiffness, [spring, play], "test")
    yield Subject(
        "model.yaml",
        text_folder(folder / "model", "model.yaml", yaml.safe_dump(document)),
        "model.yaml",
        load_compliance_model,
    )
    sensors: dict[str, Read] = {
        "axis_vision": load_axis_vision,
        "one_camera": load_one_camera,
        "photoelectric": load_photoelectric,
        "touch_probe": load_touch_probe,
        "clamp": lambda path: load_freedom(layout, path),
    }
    for name, load in sensors.items():
        yield Subject(
            f"{name}.yaml", _copied(folder / name, config / f"sensors/{name}.yaml"), f"{name}.yaml", load
        )
    yield Subject(
        "effects", text_folder(folder / "effects", "effects.yaml", EFFECTS), "effects.yaml", load_effects
    )
    yield Subject(
        "EIO.cfg", _copied(folder / "eio", ROOT / "rapid/EIO.cfg"), "EIO.cfg", read_io_configuration
    )
    distances = "distances_mm:\n  - [100.1, 200.2, 300.3, 100.1, 200.2, 300.3]\n"
    yield Subject(
        "readings",
        text_folder(folder / "readings", "r.yaml", distances),
        "r.yaml",
        lambda path: read_readings(path, "distances"),
    )
    picture = folder / "picture"
    picture.mkdir()
    grey = np.random.default_rng(1).integers(0, 255, (60, 80), dtype=np.uint8)
    cv2.imwrite(str(picture / "p.png"), grey)
    cv2.imwrite(str(picture / "p.jpg"), grey)
    yield Subject("picture png", picture, "p.png", read_picture)
    yield Subject("picture jpg", picture, "p.jpg", read_picture)

    targets = folder / "targets"
    targets.mkdir()
    written = [m.message.data for m in read_bag(ROOT / "bags/thesis_190_0deg", ["/abb/target_file"])]
    (targets / "Hei2.txt").write_bytes(written[-1].encode())
    yield Subject("target file", targets, "Hei2.txt", lambda path: read_target_file(path.read_bytes()), False)
    bag = folder / "bag"
    shutil.copytree(ROOT / "bags/unreachable", bag)
    mcap = next(p.name for p in bag.glob("*.mcap"))
    kinds = (
        ("messages", _messages),
        ("runs", read_runs),
        ("rows of the catalogue", read_rows),
    )
    for what, read in kinds:
        yield Subject(f"bag {what}", bag, mcap, of_folder(read))
        yield Subject(f"metadata.yaml {what}", bag, "metadata.yaml", of_folder(read))
    yield from cell_files(folder)
    yield from controller_answers(folder)


def _doors(value: Any, path: Path) -> None:
    write_file(path, value)


def _robot(path: Path) -> object:
    # What was read is kept under its path.
    description._load.cache_clear()
    return load_robot(path)


def _messages(folder: Path) -> list[object]:
    return [(m.topic, m.stamp_ns, m.data) for m in read_bag(folder)]
