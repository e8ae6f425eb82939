"""The checks of a recipe name the fields that a kind of feature says, also of a kind that they do not know."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import pytest

from doormill_ros.recipes.checks import check_geometry
from doormill_ros.recipes.door import DoorSize, Side
from doormill_ros.recipes.errors import FieldError
from doormill_ros.recipes.features.base import Feature
from doormill_ros.recipes.features.registry import FEATURES
from doormill_ros.recipes.outline import RoundedRectangle
from doormill_ros.recipes.recipe import Recipe
from doormill_ros.values import keys

KEYS = ("across_key", "depth_key", "radius_key", "case_key")


@dataclass(frozen=True, kw_only=True)
class Recess(Feature):
    """A recess with words of its own [m]; not in the registry."""

    kind: ClassVar[str] = "recess"
    sides: ClassVar[tuple[Side, ...]] = (Side.FRONT,)

    inward: float = 0.3
    sunk: float = 0.005
    rounding: float = 0.02
    beside: str | None = None

    @property
    def shape(self) -> RoundedRectangle:
        return RoundedRectangle(0.06, 0.06, self.rounding)

    @property
    def belongs_to(self) -> str | None:
        return self.beside

    def across(self, door: DoorSize) -> float:
        return self.inward

    def cut_depth(self, door: DoorSize) -> float:
        return self.sunk


@dataclass(frozen=True, kw_only=True)
class TellingRecess(Recess):
    """One that says what its fields are."""

    across_key: ClassVar[str] = "inward"
    depth_key: ClassVar[str] = "sunk"
    radius_key: ClassVar[str] = "rounding"
    case_key: ClassVar[str] = "beside"


FAULTS = {"inward": 0.02, "sunk": 0.04, "rounding": 0.05, "beside": "nothing"}


def refused(kind: type[Recess], document: dict[str, Any], **changes: Any) -> str:
    """The field that the refusal names."""
    recipe = Recipe.from_document(document)
    hinge = recipe.features[0]
    shared = ("tool", "cutting", "passes", "height")
    given = {name: getattr(hinge, name) for name in shared} | {"wrench_table": hinge.wrench_table}
    recess = kind(id="recess", side=Side.FRONT, **given, **changes)
    with pytest.raises(FieldError) as caught:
        check_geometry(recipe.size, recipe.mass, [recess])
    return caught.value.field


@pytest.mark.parametrize("field", FAULTS)
def test_an_unknown_kind_is_refused_by_its_own_field_or_as_a_whole(
    document: dict[str, Any], field: str
) -> None:
    changes = {field: FAULTS[field]}
    assert refused(TellingRecess, document, **changes) == f"features.0.{field}"
    assert refused(Recess, document, **changes) == "features.0"


@pytest.mark.parametrize("kind", FEATURES.values(), ids=FEATURES)
def test_every_kind_names_fields_that_it_has(kind: type[Feature]) -> None:
    named = [getattr(kind, key) for key in KEYS]
    assert set(filter(None, named)) <= set(keys(kind))
