"""Pictures of a door that was moved by known amounts question the camera model."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from doormill_ros.cell.places.layout import load_layout
from doormill_ros.diagnosis.camera.causes import CameraCause
from doormill_ros.diagnosis.camera.problem import CameraDiagnosis, PictureProblem
from doormill_ros.diagnosis.core.kind import Progress, SearchedKind
from doormill_ros.diagnosis.core.telling.account import Account, account_of
from doormill_ros.diagnosis.core.words.wording import Words
from doormill_ros.localization.errors import LocalizationError
from doormill_ros.localization.localizer import localize
from doormill_ros.localization.result import Localization
from doormill_ros.measurements.errors import SetMixError
from doormill_ros.measurements.picture_reading import Localisations, localisations_of
from doormill_ros.measurements.sets.picture_set import PictureSet, read_picture_set

FEWEST_PLACES = 4  #: of the door; whole places are left out, predicted and compared

METHOD = """The localizer read every picture with the camera model in question; what it says is compared with where the
door was known to stand, each of y, z and rotation by the localizer's own standard deviation. Every error of the camera
was fitted alone and in combination, and scored on whole places of the door left out of its fit."""


@dataclass(frozen=True, eq=False)
class LocalizedPictures:
    """A picture set and what the localizer says of it.

    Attributes:
        path: The folder.
        data: The localisations.
        refused: Pictures without, each with code and reason.
    """

    path: Path
    data: Localisations
    refused: list[dict[str, Any]]


class Pictures(SearchedKind[LocalizedPictures, PictureProblem, CameraCause]):
    """Pictures of one door before one camera."""

    words = Words("camera model", "pictures", unseen="places", method=METHOD)
    next_measurement = (
        "take pictures of the door at more places, over the whole way of the clamp, early and late"
    )

    def read(self, folder: Path, progress: Progress) -> Sequence[LocalizedPictures]:
        """The set in a folder, localized.

        Raises:
            DataSetError: The set cannot be read, or too few of its pictures show the door.
            BadCameraFile: The camera file cannot be used.
        """
        pictures = read_picture_set(folder)
        found, refused = _localize(pictures, progress)
        rows = sorted(found)
        if len(np.unique(np.round(pictures.moved[rows], 6), axis=0)) < FEWEST_PLACES:
            raise pictures.table.fail(
                len(pictures) - 1,
                "picture",
                f"{len(rows)} of {len(pictures)} pictures show the door, at fewer than {FEWEST_PLACES} places; move it "
                "to more",
            )
        data = localisations_of(
            [found[row] for row in rows],
            [pictures.offset(row) for row in rows],
            pictures.time[rows],
            pictures.camera,
            load_layout(),
            pictures.width,
            pictures.thickness,
        )
        return [LocalizedPictures(folder, data, refused)]

    def check_together(self, sets: Sequence[LocalizedPictures], others: Sequence[LocalizedPictures]) -> None:
        """Pictures of one door on one day: another day has another placing.

        Raises:
            SetMixError: There are several sets to diagnose.
        """
        if len(sets) > 1:
            raise SetMixError(
                f"{sets[1].path / 'set.yaml'}: line 1, column 1: is a second picture set, allowed is one; diagnose "
                "them one by one"
            )

    def problem(self, sets: Sequence[LocalizedPictures]) -> PictureProblem:
        """The localisations of the one set."""
        (one,) = sets
        return PictureProblem(one.data)

    def name(self, one: LocalizedPictures) -> str:
        """Its folder."""
        return one.path.name

    def account(
        self,
        diagnosis: CameraDiagnosis,
        sets: Sequence[LocalizedPictures],
        checks: Sequence[Mapping[str, Any]],
        progress: Progress,
    ) -> Account:
        """With the pattern that each error leaves and the pictures that were refused; calibration is the cure."""
        account = account_of(
            diagnosis,
            self.words,
            self.next_measurement,
            checks,
            name=lambda cause: cause.name,
            more=lambda finding: {"pattern": finding.cause.pattern()},
        )
        refused = [entry for one in sets for entry in one.refused]
        return replace(account, sections={"pictures": account.rows, "refused": refused})


def _localize(
    pictures: PictureSet, progress: Progress
) -> tuple[dict[int, Localization], list[dict[str, Any]]]:
    """What the localizer says of each picture by row, and the refusals."""
    # One door and one camera: its thickness and the mounting are the same in all pictures and scatter in none.
    layout, settings = load_layout(), pictures.settings.lens_in_question()
    found: dict[int, Localization] = {}
    refused: list[dict[str, Any]] = []
    for row, name in enumerate(pictures.names):
        progress(f"localizing {name}")
        try:
            found[row] = localize(
                pictures.picture(row),
                pictures.camera,
                layout,
                pictures.width,
                pictures.thickness,
                settings=settings,
            )
        except LocalizationError as error:
            refused.append({"picture": name, "error_code": error.code, "reason": error.message})
    return found, refused
