"""A folder of pictures as the camera of a cell of processes: doors are milled from it, a bad file is answered."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np

from doormill_ros.cell.places.layout import DoorOffset
from doormill_ros.localization.errors import BadPicture
from doormill_ros.nodes.base import topics
from doormill_ros.recipes.documents import shipped_recipes
from doormill_ros.simulation.picture.picture import render_picture
from doormill_ros.simulation.picture.scene import PictureScene
from support.cell_processes import NODES, CellProcesses

DOOR = "thesis_190_0deg"
OFFSETS = (0.004, -0.003)
OFFSET_Z, TURN = 0.001, 0.002


def picture_of_a_door(offset_y: float) -> np.ndarray:
    recipe = shipped_recipes()[DOOR]
    offset = DoorOffset(offset_y, OFFSET_Z, TURN)
    return render_picture(PictureScene(recipe.width, recipe.thickness, offset), 4)


def stand(cell: CellProcesses, offset_y: float) -> None:
    """The door that is really milled stands where the next picture shows it."""
    cell.put("camera_simulator", offset_y=offset_y, offset_z=OFFSET_Z, offset_rotation=TURN)


def test_doors_are_milled_from_a_folder(tmp_path: Path) -> None:
    folder = tmp_path / "pictures"
    folder.mkdir()
    cv2.imwrite(str(folder / "1.png"), picture_of_a_door(OFFSETS[0]))
    (folder / "2.jpg").write_bytes(b"no picture")
    cv2.imwrite(str(folder / "10.jpg"), picture_of_a_door(OFFSETS[1]))
    parameters = {
        "cell_simulator": {"camera_simulator:pictures": False},
        "folder_camera": {"folder": folder},
    }
    nodes = ("folder_camera", *(name for name in NODES if name != "bag_recorder"))
    with CellProcesses(tmp_path / "cell", parameters, nodes) as cell:
        found = cell.subscribe(topics.DOOR_LOCALIZATION)
        results = []
        for offset_y in (OFFSETS[0], 0.0, OFFSETS[1]):
            stand(cell, offset_y)
            results.append(cell.mill(DOOR)[0])
        log = cell.log("folder_camera")
    assert [result.success for result in results] == [True, False, True], [r.message for r in results]
    assert results[1].error_code == BadPicture.code
    places = [answer.offset_y for answer in found if answer.accepted]
    # Each run takes one picture and may take it more than once.
    assert np.abs(np.unique(np.round(places, 4)) - np.sort(OFFSETS)).max() < 1e-4
    assert len({answer.run_id for answer in found}) == 3
    assert "Traceback" not in log
