"""Doors of two tools, from their table to the wood: the executables import tools and doors, and `cell` mills them."""

from __future__ import annotations

import json
import os
import subprocess
from pathlib import Path
from typing import Any

import pytest
import yaml

from doormill_ros.pipeline.plan import load_setup, plan
from doormill_ros.recipes.store.database import RecipeDatabase
from doormill_ros.recording.bag_reader import read_bag
from doormill_ros.resources import resource
from doormill_ros.toolpath.mills.tool_life import cut_lengths
from support.cell_processes import executable
from support.two_tools import FILE, face_plate_door, two_tool_door, with_face_plate
from support.waiting import LIMIT

MILLS = {"lock_case": "rack_mill_16", "hinge_1": "rack_mill_12"}


@pytest.fixture(scope="module")
def milled(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a run by one robot and one by two, beside the database that both were milled from."""
    folder = tmp_path_factory.mktemp("two_tools")
    environment = {
        **os.environ,
        "XDG_DATA_HOME": str(folder / "data"),
        "ROS_LOG_DIR": str(folder / "ros"),
        "DOORMILL_DATABASE": f"sqlite:///{folder / 'recipes.sqlite'}",
    }

    def call(*command: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [executable(command[0]), *command[1:]],
            cwd=folder,
            env=environment,
            timeout=LIMIT,
            capture_output=True,
            text=True,
            check=False,
        )

    early = call("recipes", "import", str(FILE))
    assert (early.returncode, "recipes tools import" in early.stderr) == (2, True)
    plate = folder / "face_plate_door.yaml"
    plate.write_text(
        yaml.safe_dump({**with_face_plate(), "door_id": "face_plate_door", "bar_code": "7040000000062"})
    )
    for command in (
        ("recipes", "tools", "import", str(resource("config/tools.yaml"))),
        ("recipes", "import", str(FILE)),
        ("cell", "--door", "two_tool_door", "--out", "run"),
        ("recipes", "import", str(plate)),
        ("cell", "--door", "face_plate_door", "--robots", "2", "--out", "shared"),
    ):
        done = call(*command)
        assert done.returncode == 0, done.stderr
    return folder


def test_it_is_milled_within_its_tolerance_and_touches_nothing_else(milled: Path) -> None:
    summary: dict[str, Any] = json.loads((milled / "run" / "summary.json").read_text())
    assert (summary["outcome"], summary["error_code"]) == ("milled", 0)
    assert summary["touched"]["known"]
    assert summary["touched"]["samples"] == 0
    assert summary["feature_error"]["corrected_max"] < summary["feature_error"]["tolerance"]


def test_both_features_were_cut_and_gauged(milled: Path) -> None:
    (executed,) = [m.message for m in read_bag(milled / "run" / "bag", ["/simulation/executed_path"])]
    cut = {name for name, cuts in zip(executed.feature, executed.cutting, strict=True) if cuts}
    assert cut == set(MILLS)


def test_each_of_two_robots_changes_its_tools_and_touches_nothing_else(milled: Path) -> None:
    summary: dict[str, Any] = json.loads((milled / "shared" / "summary.json").read_text())
    assert (summary["outcome"], summary["error_code"]) == ("milled", 0)
    assert summary["touched"]["samples"] == 0
    assert summary["feature_error"]["corrected_max"] < summary["feature_error"]["tolerance"]
    topics = [f"/robot{number}/simulation/executed_path" for number in (1, 2)]
    paths = {m.topic: m.message for m in read_bag(milled / "shared" / "bag", topics)}
    assert [set(paths[topic].tool) for topic in topics] == [{"", *MILLS.values()}] * 2


def test_both_mills_are_worn_by_all_that_cut_with_them(milled: Path) -> None:
    """What the table counts is what the three programs of both runs cut, planned again."""
    with RecipeDatabase(f"sqlite:///{milled / 'recipes.sqlite'}") as database:
        cut = {name: database.tools.get(name).tool.cut for name in MILLS.values()}
    setup, expected = load_setup(), dict.fromkeys(MILLS.values(), 0.0)
    for recipe, shares in ((two_tool_door(), [""]), (face_plate_door(), ["first", "second"])):
        T_cell_door = setup.layout.T_base_door(recipe.width, recipe.thickness)
        for share in shares:
            program = plan(recipe, T_cell_door, setup.of(share) if share else setup).program
            for name, length in cut_lengths(program, recipe).items():
                expected[name] += length
    # Half the ways round that walls and floors are made of is the least that each cuts of the first door.
    assert expected["rack_mill_16"] > 2 * 0.104
    assert expected["rack_mill_12"] > 2 * (0.068 + 0.018)
    # A door that was found stands a little beside the nominal one.
    assert cut == pytest.approx(expected, rel=1e-3)
