"""Score laws without a name in moving joints and poses: `python bench/unnamed_score.py --sets 24`.

Arms that obey a hidden law, alone and beside a named cause, are recorded by simulations that share no code with the
diagnosis (test/support/motion_laws, test/support/pose_laws). Each set goes through the `diagnose` command with a second
series of the same arm as `--check`; read are only the files that it leaves.
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import subprocess
import sys
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT), str(ROOT / "test")]

from support.motion_laws.world import draw as draw_motion  # noqa: E402
from support.pose_laws.world import draw as draw_poses  # noqa: E402

KINDS = {"motion": draw_motion, "pose": draw_poses}


@dataclass(frozen=True)
class Score:
    """One set: what was said of what was hidden.

    Attributes:
        truth: As the world's.
        verdict: Of the diagnosis.
        wrong: Causes named that are neither hidden nor a part of the law.
        said: Place, driver and law of each unnamed effect.
        place, driver: Whether one stands at the right place; there with a driver that is as true.
        crossed: Held-out residual within the set over the noise: named causes alone, with laws.
        unseen: The same of the second series.
        seconds: Of computing.
    """

    truth: Mapping[str, Any]
    verdict: str
    wrong: tuple[str, ...]
    said: tuple[str, ...]
    place: bool
    driver: bool
    crossed: tuple[float, float]
    unseen: tuple[float, float]
    seconds: float


def judge(truth: Mapping[str, Any], document: Mapping[str, Any], seconds: float) -> Score:
    """Compare diagnosis.json with the truth."""
    may = {tuple(key) for key in truth["may_be_named"]}
    wrong = []
    for finding in document["causes"]:
        keys = [finding, *finding.get("confusable_with", []), *finding.get("tied_with", [])]
        # A base that moves while a series is recorded is told as a drift of that series.
        places = [
            (key["cause"], "base" if key["where"].split()[0] == "set" else key["where"]) for key in keys
        ]
        if not any(key in may for key in places):
            wrong.append(f"{finding['cause']} {finding['where']}")
    unnamed = document.get("unnamed") or []
    here = [entry for entry in unnamed if entry["where"] == truth["where"]]
    floor, (check,) = document["noise_floor"], document["checks"]
    inner = document["extended"]["holdout_rmse"]
    described = document["characterised"]["holdout_rmse"] if unnamed else inner
    outer = check["extended"]["rmse"]
    return Score(
        truth=truth,
        verdict=document["verdict"],
        wrong=tuple(wrong),
        said=tuple(f"{one['where']}: {one['driver']}: {one['law']}" for one in unnamed),
        place=bool(here),
        driver=any(one["driver"] in (truth["driver"], *truth["also"]) for one in here),
        crossed=(inner / floor, described / floor),
        unseen=(outer / floor, check.get("characterised", check["extended"])["rmse"] / floor),
        seconds=seconds,
    )


def diagnose(folder: Path, kind: str, seed: int) -> Score:
    """Write a world's two series below a folder, run the command on them and judge what it wrote.

    Raises:
        RuntimeError: The command failed.
    """
    world = KINDS[kind](seed)
    world.write(folder / "set")
    world.write(folder / "unseen", **{"recording" if kind == "motion" else "part": 1})
    command = [sys.executable, "-m", "doormill_ros.tools.diagnose", "--data", str(folder / "set")]
    command += ["--check", str(folder / "unseen"), "--out", str(folder / "out")]
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    run = subprocess.run(
        command, cwd=ROOT, env={**os.environ, "OMP_NUM_THREADS": "1"}, capture_output=True, text=True
    )
    if run.returncode:
        raise RuntimeError(f"diagnose ended with {run.returncode} on seed {seed}: {run.stderr.strip()}")
    document = json.loads((folder / "out" / "diagnosis.json").read_text(encoding="utf-8"))
    return judge(world.truth, document, resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before)


def line(score: Score) -> str:
    """One set."""
    truth = score.truth
    beside = f" beside {truth['beside']}" if truth["beside"] else ""
    return (
        f"{truth['seed']:4d} {truth['law']} at {truth['where']} ({truth['driver']}, {truth['amplitude']:.1f}){beside}: "
        f"{score.verdict}; {'WRONG ' + ', '.join(score.wrong) + '; ' if score.wrong else ''}"
        f"{'' if score.place else 'PLACE '}{'' if score.driver else 'DRIVER '}said {' | '.join(score.said) or '-'}; "
        f"held out {score.crossed[0]:.2f} -> {score.crossed[1]:.2f}, unseen {score.unseen[0]:.2f} -> "
        f"{score.unseen[1]:.2f}; {score.seconds:.1f} s"
    )


def summary(kind: str, scores: Sequence[Score]) -> str:
    """The figures of a kind together."""
    n = len(scores)
    rows = [
        ("sets", str(n)),
        ("with a wrong name", str(sum(bool(one.wrong) for one in scores))),
        ("place right", str(sum(one.place for one in scores))),
        ("driver right", str(sum(one.driver for one in scores))),
    ]
    for name, values in (
        ("held out over noise", [one.crossed[1] for one in scores]),
        ("unseen over noise", [one.unseen[1] for one in scores]),
    ):
        rows.append((f"{name}: median, 90 %", f"{np.median(values):.2f}, {np.quantile(values, 0.9):.2f}"))
    return "\n".join(f"{kind}: {name:32s} {value}" for name, value in rows)


def main() -> int:
    """Run the campaign and print it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--kind", choices=list(KINDS), nargs="+", default=list(KINDS))
    parser.add_argument("--sets", type=int, default=24, help="of each kind")
    parser.add_argument("--first", type=int, default=0, help="first seed")
    parser.add_argument("--keep", type=Path, help="folder to leave sets and diagnoses in")
    chosen = parser.parse_args()
    found = {}
    for kind in chosen.kind:
        found[kind] = []
        with tempfile.TemporaryDirectory() as temporary:
            for seed in range(chosen.first, chosen.first + chosen.sets):
                found[kind].append(
                    diagnose((chosen.keep or Path(temporary)) / kind / f"{seed:04d}", kind, seed)
                )
                print(line(found[kind][-1]), flush=True)
    for kind, scores in found.items():
        print(summary(kind, scores))
    return 0


if __name__ == "__main__":
    sys.exit(main())
