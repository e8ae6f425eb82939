"""What the files of all models have in common: where they stand, their schema, and how one is refused."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, TypeVar

from doormill_ros.config import read_document
from doormill_ros.errors import DoormillError
from doormill_ros.robot.errors import RobotError

#: What a diagnosis calls the model that it leaves in its folder.
MODEL_FILE = "model.yaml"

M = TypeVar("M")


def model_path(path: Path) -> Path:
    """The model in a folder, or the file itself."""
    return path / MODEL_FILE if path.is_dir() else path


def schema_of(document: Any) -> Any:
    """What a document says it is; the name of its type where it is no mapping."""
    return document.get("schema") if isinstance(document, dict) else type(document).__name__


def _said(cause: Exception) -> str:
    return f"the key {cause} is missing" if isinstance(cause, KeyError) else str(cause)


@contextmanager
def inside(place: str) -> Iterator[None]:
    """Put a place of a document in front of what is said of the part that is read there.

    Raises:
        ValueError: The part is of no use.
    """
    try:
        yield
    except (KeyError, TypeError, ValueError, OverflowError, RobotError) as cause:
        raise ValueError(f"{place}: {_said(cause)}") from cause


def read_model(
    path: Path, schema: str, error: type[DoormillError], build: Callable[[dict[str, Any]], M]
) -> M:
    """Read a model's file, or that of the folder that holds it.

    Args:
        path: File or folder.
        schema: That the file has to have.
        error: Leaf that is raised.
        build: Makes the model of the document; what it raises for a document of no use becomes `error`.

    Raises:
        DoormillError: `error`; the file cannot be read or used.
    """
    path = model_path(path)
    document = read_document(path, error)
    if not isinstance(document, dict) or document.get("schema") != schema:
        raise error(f"{path} has schema {schema_of(document)}, allowed is {schema}", path=str(path))
    try:
        return build(document)
    except (KeyError, TypeError, ValueError, RobotError) as cause:
        raise error(
            f"{path} cannot be used: {_said(cause)}; write it anew with diagnose", path=str(path)
        ) from cause
