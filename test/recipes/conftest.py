import copy

import pytest

from doormill_ros.recipes.store.database import RecipeDatabase
from doormill_ros.tools.recipes import main
from support import postgres as server_of_the_tests


@pytest.fixture(scope="session")
def postgres():
    """One server a test process; it starts when the first test asks for it."""
    module = server_of_the_tests
    try:
        module.find_binaries()
    except RuntimeError as error:
        pytest.fail(str(error), pytrace=False)
    with module.running_server() as server:
        yield server


@pytest.fixture(params=["sqlite", "postgresql"])
def url(request, tmp_path):
    """URL of an empty database, SQLite and PostgreSQL in turn."""
    if request.param == "sqlite":
        return f"sqlite:///{tmp_path / 'recipes.sqlite'}"
    return request.getfixturevalue("postgres").empty_database()


@pytest.fixture
def database(url):
    with RecipeDatabase(url) as opened:
        yield opened


@pytest.fixture
def run(url, capsys):
    """The tool `recipes` on that database: status, what it prints and what it complains of."""

    def call(*arguments):
        status = main(["--database", url, *map(str, arguments)])
        out, err = capsys.readouterr()
        return status, out, err

    return call


FORCES = {"default": [-100, 13, 25, -3, -26, 2]}
CUTTING = {"spindle_speed_rpm": 6000, "feed_mm_s": 40}
COMMON = {"passes": {"depth_step_mm": 10}, "wrench_n_nm": FORCES, "cutting": CUTTING}


@pytest.fixture
def document():
    """A door with every kind of feature."""
    hinge = {"side": "front", "backset_mm": 25, "width_mm": 30, "length_mm": 120, "depth_mm": 5}
    lock = {"side": "lock_edge", "height_mm": 1000}
    return copy.deepcopy(
        {
            "schema": "doormill/recipe/1",
            "door_id": "door_1",
            "bar_code": "4711",
            "height_mm": 2000,
            "width_mm": 800,
            "thickness_mm": 40,
            "hinge_side": "right",
            "material": "softwood",
            "mass_kg": 30,
            "placement": {"y_mm": 1.5},
            "tools": {
                "mill_16": {
                    "diameter_mm": 16,
                    "flutes": 2,
                    "cutting_length_mm": 100,
                    "max_spindle_speed_rpm": 18000,
                    "max_chip_load_mm": 0.6,
                },
                "mill_6": {
                    "diameter_mm": 6,
                    "flutes": 1,
                    "cutting_length_mm": 20,
                    "max_spindle_speed_rpm": 24000,
                },
            },
            "features": [
                {
                    "kind": "hinge_oblong",
                    "id": "hinge_1",
                    "height_mm": 200,
                    "tool": "mill_16",
                    **hinge,
                    **COMMON,
                },
                {
                    "kind": "hinge_leaf",
                    "id": "hinge_2",
                    "height_mm": 200,
                    "height_from": "top",
                    "corner_radius_mm": 8,
                    "tool": "mill_16",
                    **hinge,
                    **COMMON,
                },
                {
                    "kind": "lock_case",
                    "id": "case",
                    "width_mm": 18,
                    "length_mm": 160,
                    "depth_mm": 80,
                    "tool": "mill_16",
                    **lock,
                    **COMMON,
                },
                {
                    "kind": "face_plate",
                    "id": "plate",
                    "width_mm": 22,
                    "length_mm": 235,
                    "depth_mm": 3,
                    "corner_radius_mm": 3,
                    "lock_case": "case",
                    "tool": "mill_6",
                    **lock,
                    **COMMON,
                },
                {
                    "kind": "handle_hole",
                    "id": "hole",
                    "side": "front",
                    "height_mm": 1040,
                    "backset_mm": 50,
                    "diameter_mm": 22,
                    "lock_case": "case",
                    "tool": "mill_16",
                    **COMMON,
                },
            ],
        }
    )
