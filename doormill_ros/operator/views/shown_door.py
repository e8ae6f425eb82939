"""Whose door a picture shows: the localizer tells it apart from the picture, before or after it."""

from __future__ import annotations

from collections import OrderedDict
from typing import Generic, TypeVar

Picture = TypeVar("Picture")
KEPT = 4  #: of each that wait for the other


class ShownDoors(Generic[Picture]):
    """Joins pictures and door ids by the picture's stamp [ns since the epoch]; what nobody joins is forgotten."""

    def __init__(self) -> None:
        """Begin with nothing."""
        self._doors: OrderedDict[int, str] = OrderedDict()
        self._pictures: OrderedDict[int, Picture] = OrderedDict()

    def of_door(self, stamp: int, door_id: str) -> Picture | None:
        """The door of a stamp was told; its picture, where that came before."""
        _keep(self._doors, stamp, door_id)
        return self._pictures.pop(stamp, None)

    def of_picture(self, stamp: int, picture: Picture) -> str | None:
        """A picture came; the id of its door, where that was told before."""
        if stamp in self._doors:
            return self._doors[stamp]
        _keep(self._pictures, stamp, picture)
        return None


Value = TypeVar("Value")


def _keep(kept: OrderedDict[int, Value], stamp: int, value: Value) -> None:
    kept[stamp] = value
    while len(kept) > KEPT:
        kept.popitem(last=False)
