"""A recipe as the database holds it: its text, by which rules it was checked, and the seal on both.

Holding the features against the door costs four times as much as reading them, and was done before the recipe was
stored. A stored text that bears an unbroken seal and was checked by the very rules of this installation is
therefore only read; any other is checked in full. Whoever mills takes the recipe as a document and checks it again.
"""

from __future__ import annotations

import functools
import hashlib
import json
from pathlib import Path
from typing import Any

import sqlalchemy as sa

from doormill_ros.recipes.errors import DamagedRecord
from doormill_ros.recipes.recipe import Recipe
from doormill_ros.recipes.stamp import STAMP
from doormill_ros.recipes.tabled_tool import TABLE, LookUp, completed

RULE_FILES = (
    "checks.py",
    "cutting.py",
    "door.py",
    "force_origin.py",
    "outline.py",
    "program.py",
    "quantities.py",
    "reading.py",
    "recipe.py",
    "solid.py",
    "tabled_tool.py",
    "tool.py",
    "wrench.py",
    "features/*.py",
)
SHARED_FILES = ("config.py", "values.py")  #: of the package above, which read every configuration


@functools.cache
def rules() -> str:
    """Name of the rules by which this installation checks recipes: 16 digits of their code's hash.

    Taken from the code itself, so that no change of a check can be forgotten here.
    """
    folder = Path(__file__).parent
    digest = hashlib.sha256()
    paths = [path for pattern in RULE_FILES for path in sorted(folder.glob(pattern))]
    for path in (*paths, *(folder.parent / name for name in SHARED_FILES)):
        digest.update(path.read_bytes())
    return digest.hexdigest()[:16]


def content_of(recipe: Recipe) -> str:
    """The text that is stored, one line of JSON: the recipe's document without its stamp and the table's tools."""
    document = {key: value for key, value in recipe.to_document().items() if key not in (*STAMP, TABLE)}
    return json.dumps(document, ensure_ascii=False, allow_nan=False, separators=(",", ":"))


def seal(content: str, checked_by: str) -> str:
    """SHA-256 of a stored text and of the rules that it was checked by."""
    sealed = f"{checked_by}\n{content}" if checked_by else content
    return hashlib.sha256(sealed.encode()).hexdigest()


def recipe_of(row: sa.Row[Any], look_up: LookUp) -> Recipe:
    """The recipe of a row of `recipe_version`, with the table's tools as they are now.

    Args:
        row: Of the database.
        look_up: Gives those of some tools that the table has, by name.

    Raises:
        DamagedRecord: The stored text is not what was stored.
        UnknownTool: It names a tool that the table no longer has.
        FieldError: It was checked by other rules or with other tools, and those of this installation refuse it.
    """
    if seal(row.document, row.rules) != row.sha256:
        raise DamagedRecord(
            f"version {row.version} of door {row.door_id!r} is not what was stored; restore a backup",
            found=row.sha256,
        )
    document = json.loads(row.document)
    document.update((name, getattr(row, name)) for name in STAMP)
    document = completed(document, look_up)
    # With what figures of the table it was checked nobody knows.
    known = row.rules == rules() and TABLE not in document
    return Recipe.from_checked(document) if known else Recipe.from_document(document)
