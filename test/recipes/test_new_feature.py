"""A new kind of feature is one file and one line in the registry: everything else follows from its fields."""

import json
import shutil
import subprocess
import sys

from doormill_ros.resources import resource
from support.source_tree import PACKAGE

KIND = '''
"""A square recess round nothing in particular."""

from dataclasses import dataclass
from typing import Annotated, ClassVar

from doormill_ros.recipes.door import DoorSize, Side
from doormill_ros.recipes.features.base import Feature
from doormill_ros.recipes.outline import RoundedRectangle
from doormill_ros.recipes.quantities import Quantity
from doormill_ros.recipes.features.time_budget import TimeBudget


@dataclass(frozen=True, kw_only=True)
class SquareRecess(Feature):
    """A square recess; width and depth [m]."""

    kind: ClassVar[str] = "square_recess"
    budget: ClassVar[TimeBudget | None] = TimeBudget("recesses", "{count} square recesses")
    sides: ClassVar[tuple[Side, ...]] = (Side.FRONT,)

    backset: Annotated[float, Quantity("mm", 0.0, 1350.0)]
    width: Annotated[float, Quantity("mm", 20.0, 200.0)]
    depth: Annotated[float, Quantity("mm", 0.5, 20.0)]

    @property
    def shape(self) -> RoundedRectangle:
        return RoundedRectangle(self.width, self.width, 0.009)

    def across(self, door: DoorSize) -> float:
        return self.backset

    def cut_depth(self, door: DoorSize) -> float:
        return self.depth
'''
LINE = '    "square_recess",\n'
USE = """
import json, sys
from pathlib import Path
from doormill_ros.recipes.errors import FieldError
from doormill_ros.recipes.documents import parse_yaml, to_yaml
from doormill_ros.recipes.drawing import draw_recipe
from doormill_ros.recipes.exchange.files import read_file, write_file
from doormill_ros.recipes.recipe import Recipe
from doormill_ros.recipes.store.database import RecipeDatabase
from doormill_ros.toolpath.door_checks import _budgets
from doormill_ros.toolpath.errors import PathSettingsError
from doormill_ros.toolpath.settings import load_settings

def refusal(**changes):
    wrong = json.loads(json.dumps(document))
    wrong["features"][-1] |= changes
    try:
        Recipe.from_document(wrong)
    except FieldError as error:
        return f"{error.code} {error}"

document = json.load(sys.stdin)
recipe = Recipe.from_document(document)
answer = {"width": recipe.features[-1].width, "yaml": Recipe.from_document(parse_yaml(to_yaml(recipe))) == recipe}
for ending in ("csv", "xlsx", "json"):
    write_file(f"recipe.{ending}", [recipe])
    answer[ending] = read_file(f"recipe.{ending}") == [recipe]
with RecipeDatabase("recipes.sqlite") as database:
    saved = database.save(recipe, "anna")
    answer["database"] = database.find_bar_code(recipe.bar_code) == saved
answer["drawn"] = "recess" in draw_recipe(recipe).to_svg()
answer["refused"] = [refusal(width_mm=19), refusal(colour=1), refusal(depth_mm=None), refusal(height_mm=205)]
times = {feature.id: 2.0 for feature in recipe.features}
answer["budgets"] = [str(budget) for budget in _budgets(times, 30.0, recipe, load_settings(Path("toolpath.yaml")))]
try:
    load_settings(Path("shipped.yaml"))
except PathSettingsError as error:
    answer["no budget"] = error.message
print(json.dumps(answer))
"""


def test_a_kind_from_a_new_file_and_a_line(tmp_path, document):
    package = tmp_path / "doormill_ros"
    shutil.copytree(PACKAGE, package, ignore=shutil.ignore_patterns("__pycache__"))
    features = package / "recipes" / "features"
    (features / "square_recess.py").write_text(KIND.lstrip())
    registry = features / "registry.py"
    text = registry.read_text(encoding="utf-8")
    after = '    "handle_hole",\n'
    assert text.count(after) == 1
    registry.write_text(text.replace(after, after + LINE), encoding="utf-8")

    settings = resource("config/toolpath.yaml").read_text(encoding="utf-8")
    (tmp_path / "shipped.yaml").write_text(settings, encoding="utf-8")
    ours = settings.replace("  probing:", "  recesses: 5.0\n  probing:")
    (tmp_path / "toolpath.yaml").write_text(ours, encoding="utf-8")

    hinge = document["features"][0]
    recess = {"kind": "square_recess", "id": "recess", "backset_mm": 300, "width_mm": 60, "depth_mm": 4}
    shared = ("side", "height_mm", "tool", "passes", "wrench_n_nm", "cutting")
    document["features"].append({**{key: hinge[key] for key in shared}, **recess})
    used = subprocess.run(
        [sys.executable, "-c", USE],
        input=json.dumps(document),
        capture_output=True,
        text=True,
        cwd=tmp_path,
        env={"PYTHONPATH": str(tmp_path), "PATH": "", "HOME": str(tmp_path)},
    )
    assert used.returncode == 0, used.stderr
    answer = json.loads(used.stdout)
    refused = answer.pop("refused")
    assert answer.pop("budgets") == [
        "2 hinges: 4.0 s of 33.0 s, kept",
        "lock case: 4.0 s of 24.0 s, kept",
        "hole: 2.0 s of 15.0 s, kept",
        "1 square recesses: 2.0 s of 5.0 s, kept",
        "door, with probing: 40.0 s of 80.0 s, kept",
    ]
    assert answer.pop("no budget").startswith(
        "shipped.yaml: cycle.recesses is missing, allowed is a positive number;"
    )
    assert answer == {
        "width": 0.06, "yaml": True, "csv": True, "xlsx": True, "json": True, "database": True, "drawn": True,
    }  # fmt: skip
    assert refused[0] == "105 features.5.width_mm: found 19 mm, allowed are 20 to 200 mm"
    assert refused[1].startswith(
        "101 features.5.colour: is not a field, allowed are kind, id, side, height_mm,"
    )
    assert refused[2] == "102 features.5.depth_mm: is missing, a value must be given"
    assert refused[3] is None
