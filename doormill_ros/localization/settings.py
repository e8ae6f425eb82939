"""Limits at which a picture is refused, and what is known beside the picture."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from functools import lru_cache
from pathlib import Path

import yaml

from doormill_ros.localization.errors import BadCameraFile
from doormill_ros.resources import resource


@dataclass(frozen=True)
class LocalizerSettings:
    """The section `localizer` of config/camera.yaml.

    Attributes:
        squareness: Standard deviation of the door's angle from a right angle [rad].
        max_age: Age from which a picture is stale [s].
        max_blur: Softest edge, standard deviation of its point spread [px].
        min_inlier_share: Share of each edge's visible length that must agree with its line.
        max_deviation: Largest standard deviation of y, z [m] and rotation [rad] that a picture may leave.
        mounting_deviation: Standard deviation of the camera's mounting in y, z [m] and rotation [rad].
        thickness_deviation: Standard deviation of the face's distance, from the door's thickness and its seat in
            the clamp [m].
    """

    squareness: float
    max_age: float
    max_blur: float
    min_inlier_share: float
    max_deviation: tuple[float, float, float]
    mounting_deviation: tuple[float, float, float]
    thickness_deviation: float

    def picture_only(self) -> LocalizerSettings:
        """These settings where thickness, seat and mounting are known exactly: the covariance is the picture's own."""
        return replace(self, mounting_deviation=(0.0, 0.0, 0.0), thickness_deviation=0.0)


def load_settings(path: Path | None = None) -> LocalizerSettings:
    """Read the section `localizer` of config/camera.yaml, or of another file of the same form.

    Raises:
        BadCameraFile: A key is missing or unknown, or a value negative or of the wrong length.
    """
    path = path or resource("config/camera.yaml")
    section = (yaml.safe_load(path.read_text(encoding="utf-8")) or {}).get("localizer") or {}
    names = {f.name for f in fields(LocalizerSettings)}
    if set(section) != names:
        wrong = sorted(set(section) ^ names)
        raise BadCameraFile(
            f"section localizer of {path} lacks or does not know {', '.join(wrong)}; correct it"
        )
    values = {}
    for name, value in section.items():
        triple = name in ("max_deviation", "mounting_deviation")
        numbers = tuple(float(v) for v in value) if triple else (float(value),)
        if len(numbers) != (3 if triple else 1) or any(not v >= 0 for v in numbers):
            raise BadCameraFile(f"{name} in {path} is {value}, allowed are numbers from 0 up; correct it")
        values[name] = numbers if triple else numbers[0]
    return LocalizerSettings(**values)


@lru_cache(maxsize=1)
def shipped_settings() -> LocalizerSettings:
    """The settings of config/camera.yaml, read once."""
    return load_settings()
