"""Errors as data: classes made from rows behave as written ones, and the docs list every code."""

from __future__ import annotations

import copy
import pickle

import pytest

from doormill_ros.abb.errors import AbbError
from doormill_ros.abb.link_errors import ConnectError, LinkError, ReadTimeoutError
from doormill_ros.cell.errors import StageRefusedError
from doormill_ros.errors import DoormillError, catalogue, error_classes
from doormill_ros.recipes.errors import FieldError, OutOfRange
from scripts.list_errors import PAGE, README, page, readme_table, short_table


def test_a_row_is_a_class_of_its_module_with_code_sentence_and_base() -> None:
    assert OutOfRange.__module__ == "doormill_ros.recipes.errors"
    assert OutOfRange.__qualname__ == "OutOfRange"
    assert OutOfRange.__doc__ == "A number or a count beyond its limits."
    assert (OutOfRange.code, OutOfRange.__bases__) == (105, (FieldError,))
    with pytest.raises(FieldError) as caught:
        raise OutOfRange("features.0.depth_mm", "found 99, allowed are 1 to 20", found=99)
    assert str(caught.value) == "features.0.depth_mm: found 99, allowed are 1 to 20"
    assert (caught.value.field, caught.value.data["found"]) == ("features.0.depth_mm", 99)


def test_a_row_sets_the_attributes_that_its_base_declares() -> None:
    assert (LinkError.connection, LinkError.in_doubt) == (False, False)
    assert (ConnectError.connection, ConnectError.in_doubt) == (True, False)
    assert (ReadTimeoutError.connection, ReadTimeoutError.in_doubt) == (True, True)
    assert issubclass(ReadTimeoutError, AbbError)


@pytest.mark.parametrize(
    "error",
    [
        OutOfRange("field", "beyond", found=3),
        StageRefusedError("the camera is off", stage_code=209),
        ReadTimeoutError("late", after_s=2.0),
    ],
    ids=lambda e: type(e).__name__,
)
@pytest.mark.parametrize(
    "again", [copy.copy, lambda e: pickle.loads(pickle.dumps(e))], ids=["copy", "pickle"]
)
def test_an_error_travels(error: DoormillError, again) -> None:
    other = again(error)
    assert type(other) is type(error)
    assert (str(other), vars(other)) == (str(error), vars(error))


def test_every_error_stands_in_its_module_under_its_name() -> None:
    classes = error_classes()
    assert len(classes) > 150
    lost = [cls.__name__ for cls in classes if pickle.loads(pickle.dumps(cls)) is not cls]
    assert not lost


def test_the_page_of_codes_is_the_one_made_from_the_classes() -> None:
    codes = catalogue()
    assert len(codes) > 150
    assert PAGE.read_text(encoding="utf-8") == page(codes), "run python -m scripts.list_errors"


def test_the_readme_table_is_the_one_made_from_the_classes() -> None:
    assert readme_table(README.read_text(encoding="utf-8")) == short_table(catalogue()), (
        "run python -m scripts.list_errors"
    )
