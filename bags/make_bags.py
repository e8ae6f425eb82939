"""Record the reference bags anew: `. ./activate; python bags/make_bags.py [SCENARIO ...]`.

Each scenario of timeline.yaml is run by the cell, compared with what the timeline intends, and
packed tightly into bags/<scenario>. The old bag stays when the new recording is not as intended.
"""

from __future__ import annotations

import argparse
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

FOLDER = Path(__file__).resolve().parent
sys.path.insert(0, str(FOLDER.parent))

from bags.repack import repack_bag  # noqa: E402
from bags.timeline import Scenario, load_timeline, violations  # noqa: E402

ATTEMPTS = 3  # a busy machine may need two pictures where one is intended
LEVEL = 19  # of compression


def _parameters(
    scenario: Scenario, common: dict[str, dict[str, Any]], folder: Path
) -> dict[str, dict[str, Any]]:
    from doormill_ros.recipes.store.database import RecipeDatabase

    database = folder / "recipes.sqlite"
    with RecipeDatabase(f"sqlite:///{database}") as recipes:
        recipes.add_shipped()
        if scenario.recipe:
            recipes.import_file(FOLDER / scenario.recipe, author="reference bags")
    chosen = {"recipe_database": {"database_url": f"sqlite:///{database}"}}
    for node, values in (*common.items(), *scenario.parameters.items()):
        chosen.setdefault(node, {}).update(values)
    return chosen


def record(scenario: Scenario, common: dict[str, dict[str, Any]]) -> list[str]:
    """Run one scenario and replace its bag; what was not as intended when it never was."""
    from doormill_ros.nodes.one_process.cell import CellOptions, run_once

    wrong: list[str] = []
    for _ in range(ATTEMPTS):
        with tempfile.TemporaryDirectory(prefix="reference-bag-") as name:
            folder = Path(name)
            run_once(scenario.door, folder / "run", CellOptions(_parameters(scenario, common, folder)))
            packed = folder / scenario.name
            repack_bag(folder / "run" / "bag", packed, level=LEVEL)
            wrong = violations(scenario, packed)
            if not wrong:
                target = FOLDER / scenario.name
                shutil.rmtree(target, ignore_errors=True)
                shutil.copytree(packed, target)
                return []
        print(f"{scenario.name}: {'; '.join(wrong)}; again", file=sys.stderr)
    return wrong


def main() -> int:
    """Record; 1 when a scenario did not come out as intended."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("scenarios", nargs="*", help="which; default: all")
    chosen = parser.parse_args().scenarios
    common, scenarios = load_timeline(FOLDER / "timeline.yaml")
    wanted = [s for s in scenarios if not chosen or s.name in chosen]
    if len(wanted) > 1:
        # A process each: what one cell has latched must not reach the next.
        status = max(
            subprocess.run([sys.executable, __file__, s.name], check=False).returncode for s in wanted
        )
        print(f"together {sum(p.stat().st_size for p in FOLDER.rglob('*') if p.is_file()) / 1e6:.2f} MB")
        return status
    (scenario,) = wanted
    wrong = record(scenario, common)
    size = sum(p.stat().st_size for p in (FOLDER / scenario.name).rglob("*") if p.is_file())
    print(f"{scenario.name}: {'; '.join(wrong) or 'as intended'}, {size / 1e3:.0f} kB", flush=True)
    return int(bool(wrong))


if __name__ == "__main__":
    sys.exit(main())
