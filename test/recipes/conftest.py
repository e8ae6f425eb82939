import importlib.util
from pathlib import Path

import pytest

from doormill_ros.recipes.database import RecipeDatabase


def _load(name):
    path = Path(__file__).resolve().parent.parent / f"{name}.py"
    spec = importlib.util.spec_from_file_location(f"doormill_test_{name}", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="session")
def postgres():
    """One server a test process; it starts when the first test asks for it."""
    with _load("postgres").running_server() as server:
        yield server


@pytest.fixture(params=["sqlite", "postgresql"])
def url(request, tmp_path):
    """URL of an empty database, SQLite and PostgreSQL in turn."""
    if request.param == "sqlite":
        return f"sqlite:///{tmp_path / 'recipes.sqlite'}"
    return request.getfixturevalue("postgres").create_database()


@pytest.fixture
def database(url):
    with RecipeDatabase(url) as opened:
        yield opened
