"""Workshop pictures and what the localizer says of them, rendered once in a session."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
import pytest

from doormill_ros.cell.places.layout import load_layout
from doormill_ros.localization.camera import load_camera
from doormill_ros.localization.errors import LocalizationError
from doormill_ros.localization.localizer import localize
from doormill_ros.localization.result import Localization
from doormill_ros.localization.settings import load_settings
from doormill_ros.simulation.picture.picture import render_picture
from support.pictures.corpus import CorpusPicture, corpus

CORPUS_SIZE, CORPUS_SEED = 72, 4  # another seed than the full corpus of bench/bench_localization.py


@dataclass(frozen=True)
class Looked:
    """A picture of the corpus and what came of it."""

    item: CorpusPicture
    picture: np.ndarray
    found: Localization | None
    refused: LocalizationError | None

    @property
    def error(self) -> np.ndarray:
        """y, z [m] and rotation [rad] off the truth."""
        found, true = self.found.offset, self.item.scene.offset
        return np.array([found.y - true.y, found.z - true.z, found.rotation - true.rotation])


def look(item: CorpusPicture) -> Looked:
    """Render and localise one picture."""
    scene = item.scene
    picture = render_picture(scene, item.seed)
    try:
        known = (
            load_settings().picture_only()
        )  # the scene has the thickness and mounting that the localiser is told
        found = localize(picture, load_camera(), scene.layout, scene.width, scene.thickness, settings=known)
        return Looked(item, picture, found, None)
    except LocalizationError as refused:
        return Looked(item, picture, None, refused)


@pytest.fixture(scope="session")
def camera():
    cv2.setNumThreads(1)
    return load_camera()


@pytest.fixture(scope="session")
def layout():
    return load_layout()


@pytest.fixture(scope="session")
def looked() -> list[Looked]:
    return [look(item) for item in corpus(CORPUS_SIZE, CORPUS_SEED)]
