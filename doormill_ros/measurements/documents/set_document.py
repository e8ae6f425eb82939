"""A YAML document that can say on which line a value stands."""

from __future__ import annotations

import difflib
from collections.abc import Collection
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from doormill_ros.arrays import FloatArray
from doormill_ros.errors import DataSetError
from doormill_ros.files import NotUtf8, read_utf8
from doormill_ros.measurements.errors import DataFileError, SetDescriptionError
from doormill_ros.yaml_text import NotYaml, parse

_NEARLY = 0.85  #: share of letters that two names have in common [difflib's ratio], of which one is the other misspelt


def read_text(path: Path) -> str:
    """Text of a file of a set.

    Raises:
        DataFileError: Missing, unreadable, no regular file or not UTF-8.
    """
    try:
        return read_utf8(path)
    except OSError as error:
        raise DataFileError(
            f"{path}: line 1, column 1: cannot be opened ({error.strerror}), a set needs it",
            path=str(path),
        ) from error
    except NotUtf8 as error:
        raise DataFileError(f"{path}: {error}, save it as UTF-8", path=str(path)) from error


class SetDocument:
    """Typed access to a YAML mapping; every complaint names file, line and column.

    Attributes:
        path: The file.
        data: The plain document.
    """

    def __init__(self, path: Path) -> None:
        """Parse the file.

        Raises:
            DataFileError: The file cannot be read.
            SetDescriptionError: It is not YAML or no mapping.
        """
        self.path = path
        text = read_text(path)
        try:
            self.data: Any = parse(text)
        except NotYaml as error:
            where = error.where or " line 1, column 1"
            raise SetDescriptionError(f"{path}:{where}: not YAML: {error.problem}", path=str(path)) from error
        self._root = yaml.compose(text, Loader=yaml.SafeLoader)
        if not isinstance(self.data, dict):
            raise SetDescriptionError(f"{path}: line 1, column 1: holds no mapping of keys to values")

    def fail(self, keys: tuple[str, ...], problem: str) -> DataSetError:
        """The error for the value at a path of keys, placed where that value (or its parent) stands."""
        node = self._root
        for key in keys:
            values = node.value if isinstance(node, yaml.MappingNode) else []
            found = [value for name, value in values if name.value == key]
            if not found:
                break
            node = found[0]
        line, column = (0, 0) if node is None else (node.start_mark.line, node.start_mark.column)
        return SetDescriptionError(
            f"{self.path}: line {line + 1}, column {column + 1}: {'.'.join(keys)} {problem}",
            path=str(self.path),
            key=".".join(keys),
        )

    def get(self, *keys: str) -> Any:
        """The value at a path of keys.

        Raises:
            SetDescriptionError: A key is missing.
        """
        value: Any = self.data
        for key in keys:
            named = {str(name): item for name, item in value.items()} if isinstance(value, dict) else {}
            if key not in named:
                raise self.fail(keys, "is missing")
            value = named[key]
        return value

    def check_schema(self, allowed: str) -> None:
        """Refuse a document of another form.

        Raises:
            SetDescriptionError: Its schema is missing or not the one allowed.
        """
        if self.get("schema") != allowed:
            raise self.fail(("schema",), f"is {self.get('schema')!r}, allowed is {allowed}")

    def check_spelling(self, optional: Collection[str], *keys: str) -> None:
        """Refuse a key that is nearly one that may be left out: it would be taken for left out without a word.

        Others that nobody reads are a lab's own notes.

        Args:
            optional: Keys that may be left out.
            keys: Of the mapping that holds them; none for the document.

        Raises:
            SetDescriptionError: There is such a key.
        """
        mapping = self.get(*keys) if keys else self.data
        for key in map(str, mapping) if isinstance(mapping, dict) else ():
            near = difflib.get_close_matches(key.lower(), optional, n=1, cutoff=_NEARLY)
            if key not in optional and near:
                raise self.fail((*keys, key), f"is read by nothing; write {near[0]} if that is meant")

    def text(self, *keys: str) -> str:
        """A text, or the text of a number.

        Raises:
            SetDescriptionError: Missing, or a list or mapping.
        """
        value = self.get(*keys)
        if isinstance(value, list | dict):
            kind = "list" if isinstance(value, list) else "mapping"
            raise self.fail(keys, f"is a {kind}, allowed is text")
        return str(value)

    def vector(self, size: int, *keys: str) -> FloatArray:
        """Finite numbers, shape (size,).

        Raises:
            SetDescriptionError: Missing, wrong length or not finite numbers.
        """
        value = self.get(*keys)
        if not isinstance(value, list) or len(value) != size or not all(map(_is_number, value)):
            raise self.fail(keys, f"is {value!r}, allowed are {size} finite numbers")
        return np.array(value, dtype=float)

    def number(self, *keys: str, positive: bool = False) -> float:
        """One finite number.

        Raises:
            SetDescriptionError: Missing, no finite number, or not positive where it has to be.
        """
        value = self.get(*keys)
        if not _is_number(value):
            raise self.fail(keys, f"is {value!r}, allowed is a finite number")
        if positive and not float(value) > 0.0:
            raise self.fail(keys, f"is {value!r}, allowed is a positive number")
        return float(value)


def _is_number(value: Any) -> bool:
    # YAML 1.1 reads 8e-6 (no dot) as a string; people write it, so take it as the number it is.
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        return False
    try:
        return bool(np.isfinite(float(value)))
    except (ValueError, OverflowError):
        return False
