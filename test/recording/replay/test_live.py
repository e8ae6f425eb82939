"""Live replay: the recorded run is repeated by database, localizer, path generator and bridge."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest
import yaml

from doormill_ros.recipes.documents import shipped_recipes
from doormill_ros.recipes.store.database import RecipeDatabase
from support.source_tree import ROOT
from support.waiting import LIMIT

BAGS = ROOT / "bags"


def live(bag: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    environment = os.environ | {"PYTHONPATH": os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")])}
    command = [sys.executable, "-m", "doormill_ros.tools.replay", "--live", *arguments, str(bag)]
    return subprocess.run(
        command, env=environment, capture_output=True, text=True, timeout=LIMIT, check=False
    )


EVERY_STAGE = (
    "equal: 1 of /door/recipe, 1 of /door/localization, 1 of /path/targets, 1 of /abb/target_file, "
    "1 of /run/result"
)


@pytest.mark.parametrize("rate", ["1", "max"])
def test_the_nodes_answer_as_recorded(rate: str) -> None:
    done = live(BAGS / "thesis_190_0deg", "--rate", rate)
    assert done.returncode == 0, done.stdout + done.stderr
    assert EVERY_STAGE in done.stdout
    assert "not compared" not in done.stdout


REFUSALS = [
    ("unknown_door", "equal: 1 of /run/result"),
    ("no_picture", "equal: 1 of /door/recipe, 1 of /run/result"),
    ("outside_rotation", "equal: 1 of /door/recipe, 1 of /door/localization, 1 of /run/result"),
    (
        "unreachable",
        "equal: 1 of /door/recipe, 1 of /door/localization, 1 of /path/targets, 1 of /run/result",
    ),
    ("spindle_fault", EVERY_STAGE),
]


@pytest.mark.parametrize(("scenario", "said"), REFUSALS)
def test_the_nodes_refuse_as_recorded(scenario: str, said: str) -> None:
    done = live(BAGS / scenario, "--rate", "max")
    assert done.returncode == 0, done.stdout + done.stderr
    assert said in done.stdout


def test_a_database_that_holds_another_recipe_is_named(tmp_path: Path) -> None:
    url = f"sqlite:///{tmp_path / 'recipes.sqlite'}"
    with RecipeDatabase(url) as database:
        recipe = shipped_recipes()["thesis_190_0deg"]
        database.save(replace(recipe, mass=recipe.mass + 1.0), author="test")
    done = live(BAGS / "thesis_190_0deg", "--rate", "max", "--database", url)
    assert done.returncode == 1, done.stdout + done.stderr
    first = done.stdout.splitlines()[0]
    assert ": /door/recipe of " in first
    assert "document.mass" in first
    assert "made by the recipe database" in first


def test_a_difference_is_named(tmp_path: Path) -> None:
    """Another expectation stands for another code: the nodes run as installed."""
    bag = Path(shutil.copytree(BAGS / "outside_rotation", tmp_path / "bag"))
    update = [sys.executable, "-m", "doormill_ros.tools.replay", "--update", str(bag)]
    subprocess.run(update, check=True, capture_output=True, timeout=LIMIT, cwd=ROOT)
    document = yaml.safe_load((bag / "expected.yaml").read_text())
    (answers,) = document["runs"].values()
    answers[0]["values"]["error_code"] = 201
    (bag / "expected.yaml").write_text(yaml.safe_dump(document))
    done = live(bag, "--rate", "max")
    assert done.returncode == 1, done.stdout + done.stderr
    assert "/door/localization" in done.stdout
    assert "error_code: expected 201, found 204" in done.stdout
