from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

import pytest

from doormill_ros.recipes.documents import shipped_recipes
from doormill_ros.recipes.recipe import Recipe
from doormill_ros.recipes.store.database import RecipeDatabase
from support import postgres as server_of_the_tests
from support.sites import fill


@pytest.fixture(scope="session")
def server() -> Iterator[server_of_the_tests.Server]:
    """A PostgreSQL; its own pg_dump goes before one that may be older than it."""
    before = os.environ["PATH"]
    os.environ["PATH"] = f"{server_of_the_tests.find_binaries()}{os.pathsep}{before}"
    try:
        with server_of_the_tests.running_server() as running:
            yield running
    finally:
        os.environ["PATH"] = before


@pytest.fixture(scope="session")
def recipe() -> Recipe:
    return shipped_recipes()["thesis_190_0deg"]


@pytest.fixture
def site(tmp_path: Path, recipe: Recipe) -> Path:
    """A site with something in every part."""
    folder = tmp_path / "site"
    fill(folder)
    with RecipeDatabase(str(folder / "recipes.sqlite")) as database:
        database.save(recipe, "anna")
    return folder
