"""Recipes know their kinds of features, exchange formats know recipes, the database knows both; nothing looks back."""

import pytest

from support.source_tree import PACKAGE, imports_of

MAY_KNOW = {
    "": {"", "features"},
    "features": {"", "features"},  # the package and the plug-ins that its registry lists
    "exchange": {"", "features", "exchange"},
    "store": {"", "features", "exchange", "store"},
}


def folder_of(module: str) -> str:
    parts = module.removeprefix("doormill_ros.recipes").strip(".").split(".")
    return parts[0] if parts[0] in MAY_KNOW else ""


@pytest.mark.parametrize("folder", MAY_KNOW)
def test_a_folder_knows_only_those_below_it(folder):
    root = PACKAGE / "recipes"
    files = (root / folder).glob("*.py") if not folder else (root / folder).rglob("*.py")
    known = {
        folder_of(module)
        for path in files
        for module in imports_of(path)
        if module.startswith("doormill_ros.recipes.")
    }
    assert known
    assert known <= MAY_KNOW[folder]
