"""Score how the diagnosis describes laws that have no name: `python bench/laws_score.py --sets 32`.

Robots that give way by a hidden law, alone (seeds 0 to 15 of each 32) and beside a named cause, are measured by a
simulated lab (test/support/law_worlds) that shares no code with the diagnosis. Each set goes through the `diagnose`
command with its held-out configurations as `--check`; read are only the files that it leaves.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT), str(ROOT / "test")]

from support.law_worlds.world import draw  # noqa: E402

#: Two words for one place.
PLACES = {"flange": "tool", "cell": "tracker"}


@dataclass(frozen=True)
class Score:
    """One set: what was said of what was hidden.

    Attributes:
        truth: As `World.truth`.
        verdict: Of the diagnosis.
        wrong: Causes named that are not hidden, nor confusable with the one that is.
        wrong_here: Those of them that stand where the law sits.
        cause: Whether the named cause was named, None without one.
        said: Place, driver and law of each unnamed effect.
        place, driver, exact: Whether one stands at the right place; there with a driver that is as true; with the very
            one.
        baseline, extended, described: Residual of the held-out configurations over the floor of the best possible
            model there; `described` is that of `extended` where nothing is characterised.
        crossed: The cross-validated residual within the set over its floor.
    """

    truth: Mapping[str, Any]
    verdict: str
    wrong: tuple[str, ...]
    wrong_here: tuple[str, ...]
    cause: bool | None
    said: tuple[str, ...]
    place: bool
    driver: bool
    exact: bool
    baseline: float
    extended: float
    described: float
    crossed: float


def place_of(where: str) -> str:
    """A place in the words of the truth: 'reflector ee' is also said as 'ee', 'tool' as 'flange'."""
    where = where.strip()
    return PLACES.get(where, where)


def same_place(said: str, hidden: str) -> bool:
    """Whether both mean one place."""
    return place_of(said) == hidden or f"reflector {said.strip()}" == hidden


def judge(truth: Mapping[str, Any], document: Mapping[str, Any]) -> Score:
    """Compare diagnosis.json with the truth."""
    hidden = truth["named"]
    wrong, found = [], False
    for finding in document["causes"]:
        keys = [finding, *finding.get("confusable_with", []), *finding.get("tied_with", [])]
        if hidden and any((k["cause"], k["where"]) == (hidden["cause"], hidden["where"]) for k in keys):
            found = True
        else:
            wrong.append(finding)
    unnamed = document.get("unnamed") or []
    here = [entry for entry in unnamed if same_place(entry["where"], truth["where"])]
    check, floor = document["checks"][0], truth["noise"]["floor_unseen"]
    described = check.get("characterised") or check["extended"]
    crossed = (document.get("characterised") or document["extended"])["holdout_rmse"]
    return Score(
        truth=truth,
        verdict=document["verdict"],
        wrong=tuple(f"{c['cause']} {c['where']}" for c in wrong),
        wrong_here=tuple(
            f"{c['cause']} {c['where']}" for c in wrong if same_place(c["where"], truth["where"])
        ),
        cause=found if hidden else None,
        said=tuple(f"{e['where']}: {e['driver']}: {e.get('law', '')}" for e in unnamed),
        place=bool(here),
        driver=any(e["driver"] in (truth["driver"], *truth["also"]) for e in here),
        exact=any(e["driver"] == truth["driver"] for e in here),
        baseline=check["baseline"]["rmse"] / floor,
        extended=check["extended"]["rmse"] / floor,
        described=described["rmse"] / floor,
        crossed=crossed / truth["noise"]["floor"],
    )


def diagnose(folder: Path, seed: int) -> Score:
    """Write a world's two sets below a folder, run the command on them and judge what it wrote.

    Raises:
        RuntimeError: The command failed.
    """
    world = draw(seed)
    world.write(folder / "set")
    world.write_unseen(folder / "unseen")
    truth = world.truth
    (folder / "truth.json").write_text(json.dumps(truth, indent=2), encoding="utf-8")
    command = [sys.executable, "-m", "doormill_ros.tools.diagnose", "--data", str(folder / "set")]
    command += ["--check", str(folder / "unseen"), "--out", str(folder / "out")]
    run = subprocess.run(
        command, cwd=ROOT, env={**os.environ, "OMP_NUM_THREADS": "1"}, capture_output=True, text=True
    )
    if run.returncode:
        raise RuntimeError(f"diagnose ended with {run.returncode} on seed {seed}: {run.stderr.strip()}")
    return judge(truth, json.loads((folder / "out" / "diagnosis.json").read_text(encoding="utf-8")))


def line(score: Score) -> str:
    """One set."""
    truth = score.truth
    hidden = f"{truth['law']}{' ' + truth['form'] if truth['form'] else ''} at {truth['where']}"
    if truth["named"]:
        hidden += f", {truth['named']['cause']} {truth['named']['where']}"
    return (
        f"{truth['seed']:4d} {hidden} ({truth['driver']}, {truth['amplitude']:.1f}): {score.verdict}; "
        f"{'WRONG ' + ', '.join(score.wrong) + '; ' if score.wrong else ''}"
        f"said {' | '.join(score.said) or '-'}; "
        f"held out {score.baseline:.2f} -> {score.extended:.2f} -> {score.described:.2f}"
    )


def row(name: str, scores: Sequence[Score]) -> str:
    """Figures of several sets."""
    n, causes = len(scores), [s.cause for s in scores if s.cause is not None]
    after = np.array([s.described for s in scores])
    counts = (
        f"{sum(bool(s.wrong) for s in scores):3d} {sum(bool(s.wrong_here) for s in scores):4d} "
        f"{sum(causes):4d}/{len(causes):<3d} {sum(s.place for s in scores):5d} {sum(s.driver for s in scores):6d} "
        f"{sum(s.exact for s in scores):5d}"
    )
    middle, high = np.median(after), np.quantile(after, 0.9)
    return (
        f"{name:20s} {n:4d}  {counts}   {np.median([s.baseline for s in scores]):6.2f} "
        f"{np.median([s.extended for s in scores]):6.2f} {middle:6.2f} {high:6.2f}  "
        f"{np.median([s.crossed for s in scores]):6.2f}"
    )


HEAD = """
                            wrong names  cause            driver          held-out residual over floor          crossed
law                  sets  any  here  named/of  place  true  exact  before  named  described: median, 90 %  median"""


def table(scores: Sequence[Score]) -> str:
    """By law, alone and beside a cause, and all together."""
    groups = {
        law: [s for s in scores if s.truth["law"] == law] for law in sorted({s.truth["law"] for s in scores})
    }
    groups["alone"] = [s for s in scores if not s.truth["named"]]
    groups["beside a cause"] = [s for s in scores if s.truth["named"]]
    groups["all"] = list(scores)
    return "\n".join([HEAD, *(row(name, group) for name, group in groups.items() if group)])


def main() -> int:
    """Run the campaign and print it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--sets", type=int, default=32)
    parser.add_argument("--first", type=int, default=0, help="first seed")
    parser.add_argument("--step", type=int, default=1, help="seeds apart; 5 meets all laws in 16 sets")
    parser.add_argument("--keep", type=Path, help="folder to leave sets, truths and diagnoses in")
    parser.add_argument("--workers", type=int, default=1, help="sets at once")
    chosen = parser.parse_args()
    seeds = range(chosen.first, chosen.first + chosen.sets * chosen.step, chosen.step)
    scores = []
    with tempfile.TemporaryDirectory() as temporary, ThreadPoolExecutor(chosen.workers) as pool:
        folders = [(chosen.keep or Path(temporary)) / f"{seed:04d}" for seed in seeds]
        # A thread waits for a process that computes.
        for score in pool.map(diagnose, folders, seeds):
            scores.append(score)
            print(line(score), flush=True)
    print(table(scores))
    return 0


if __name__ == "__main__":
    sys.exit(main())
