"""What lists the kinds imports none of them, so that asking for one does not wait for all."""

from __future__ import annotations

import inspect

import pytest

from doormill_ros.diagnosis import kinds
from doormill_ros.diagnosis.core.kind import Kind
from doormill_ros.diagnosis.listed_kind import ListedKind
from doormill_ros.measurements.documents import schemas
from support.loaded_modules import loaded

SLOW = ("scipy", "matplotlib", "pinocchio", "cv2", "rosbags", "shapely", "pydantic")


def test_the_tool_starts_without_what_only_a_diagnosis_needs() -> None:
    names = loaded("import doormill_ros.tools.diagnose")
    assert "doormill_ros.diagnosis.kinds" in names
    assert {name.partition(".")[0] for name in names} & set(SLOW) == set()


@pytest.mark.parametrize("listed", kinds.KINDS, ids=lambda listed: listed.schema)
def test_a_kind_is_made_from_its_line(listed: ListedKind) -> None:
    kind = listed.make()
    assert isinstance(kind, Kind)
    assert bool(listed.option) == bool(listed.help)
    assert set(inspect.signature(type(kind)).parameters) == {one.name for one in listed.further}


def test_every_folder_of_measured_data_is_of_a_kind() -> None:
    """Raw loading tests become a set first; bags have no description."""
    named = {schema for name, schema in vars(schemas).items() if name.isupper()}
    assert {listed.schema for listed in kinds.KINDS} == named - {schemas.RAW_LOADING_TESTS} | {
        "doormill/bags"
    }
