"""What the diagnosis says of the measured UR10: every figure of docs/diagnosis-ur10.md, about ten minutes of one core.

`diagnose` on the three series gives most of them. Its list of causes and orders comes from all rows; so the whole
procedure (search, selection, fit) is redone without the rows that are judged: without each fifth of the blocks, and
without each series. A whole run puts its tables into the page:

    python bench/record.py bench/diagnosis_ur10.py

`--every 10` takes each tenth row alone, to try the script.
"""

from __future__ import annotations

import argparse
import dataclasses
import json
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import yaml

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))

# ruff: noqa: E402
import ur10_tables as tables
from page_part import END, put
from ur10_tables import Redone

from doormill_ros.diagnosis.pose.check import check_set
from doormill_ros.diagnosis.pose.coverage import BINS
from doormill_ros.diagnosis.pose.diagnosis import PoseDiagnosis, diagnose_poses
from doormill_ros.diagnosis.pose.fitting.fit import contiguous, fit_causes, place_nominally
from doormill_ros.diagnosis.pose.fitting.placement import Seen, place_together
from doormill_ros.measurements.sets.pose_set import PoseSet, read_pose_set
from doormill_ros.robot_model.pose.causes.joint_sag import JointSag
from doormill_ros.robot_model.pose.causes.link_geometry import LinkGeometry
from doormill_ros.robot_model.pose.chain import residual
from doormill_ros.robot_model.pose.model import PoseModel

PAGE = ROOT / "docs" / "diagnosis-ur10.md"
DATA = ROOT / "test" / "data" / "ur10"
NAMES = ("grid", "joint-configurations", "random-poses")
#: Every so many-th block of each series is left out together.
FOLDS = 5
#: Rows of a series in which an arm that was switched on lately may still be warming up.
FIRST = 100
_COLUMNS = ("row", "time", "temperature", "q", "position", "rotation", "placement")


def part_of(data: PoseSet, rows: np.ndarray) -> PoseSet:
    """Some rows of a series."""
    return dataclasses.replace(data, **{name: getattr(data, name)[rows] for name in _COLUMNS})


def say(text: str) -> None:
    """Progress, beside what is kept."""
    print(f"{time.strftime('%H:%M:%S')} {text}", file=sys.stderr, flush=True)


def diagnosed(every: int) -> dict[str, Any]:
    """diagnosis.json of the three series, by the command."""
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, "-m", "doormill_ros.tools.diagnose", "--quiet", "--out", f"{folder}/out"]
        for name in NAMES:
            source, target = DATA / name, Path(folder) / name
            target.mkdir()
            head, *rows = (source / "poses.csv").read_text(encoding="utf-8").splitlines()
            (target / "poses.csv").write_text("\n".join([head, *rows[::every], ""]), encoding="utf-8")
            described = yaml.safe_load((source / "set.yaml").read_text(encoding="utf-8"))
            (target / "set.yaml").write_text(yaml.safe_dump(described), encoding="utf-8")
            command += ["--data", str(target)]
        subprocess.run(command, cwd=ROOT, stdout=subprocess.DEVNULL, check=True)
        found: dict[str, Any] = json.loads(
            (Path(folder) / "out" / "diagnosis.json").read_text(encoding="utf-8")
        )
    return found


def named(found: PoseDiagnosis) -> set[tuple[str, str]]:
    """Cause and place of what was named."""
    return {score.cause.key for score in found.established}


def without_blocks(sets: Sequence[PoseSet], counted: Sequence[np.ndarray]) -> Redone:
    """Every so many-th block of each series predicted by a diagnosis without it; its placement comes from the rest."""
    redone = Redone()
    errors = [np.zeros((len(data), 3)) for data in sets]
    for fold in range(FOLDS):
        out = [np.concatenate(contiguous(len(data))[fold::FOLDS]) for data in sets]
        rest = [np.setdiff1d(np.arange(len(data)), rows) for data, rows in zip(sets, out, strict=True)]
        found = diagnose_poses([part_of(data, rows) for data, rows in zip(sets, rest, strict=True)])
        for series, (data, rows) in enumerate(zip(sets, out, strict=True)):
            gone, placement = part_of(data, rows), found.extended.problem.placements[series]
            error = residual(found.model.frames(gone.view), placement, gone.position, gone.rotation)
            errors[series][rows] = error[:, :3]
        redone.named.append(named(found))
        say(f"without fifth {fold + 1}")
    redone.errors = {data.name: e[rows] for data, e, rows in zip(sets, errors, counted, strict=True)}
    return redone


def plain_model(sets: Sequence[PoseSet]) -> tuple[PoseModel, tuple[float, float]]:
    """A robot calibrated by link geometry and sag alone, and the noise that its fit took."""
    causes = [LinkGeometry(f"link {k}", sets[0].dh) for k in range(1, 6)]
    sag = (JointSag(f"joint {k}") for k in range(2, 6))
    problem = fit_causes(sets, [*causes, *sag], place_nominally(sets)).problem
    model = PoseModel(sets[0].robot, sets[0].dh, problem.views[0].links, problem.layout.causes, problem.x)
    return model, problem.sigmas[0]


def placed_error(
    model: PoseModel, sigma: tuple[float, float], data: PoseSet, counted: np.ndarray
) -> np.ndarray:
    """Position error of the rows of a series that count, shape (n, 3) [m]; its marked rows place it and do not."""
    T, marked = model.frames(data.view), data.placement
    placement = place_together([Seen(T[marked], data.position[marked], data.rotation[marked])], sigma)
    error: np.ndarray = residual(T, placement, data.position, data.rotation)[counted & ~marked, :3]
    return error


def without_series(
    sets: Sequence[PoseSet], counted: Sequence[np.ndarray]
) -> tuple[Redone, Redone, dict[str, dict[str, float]]]:
    """Every series predicted by a diagnosis of the others, by link geometry and sag; rows where no other was."""
    redone, plain, outside = Redone(), Redone(), {}
    for data, rows in zip(sets, counted, strict=True):
        others = [other for other in sets if other is not data]
        found = diagnose_poses(others)
        redone.named.append(named(found))
        redone.errors[data.name] = placed_error(found.model, found.extended.problem.sigmas[0], data, rows)
        plain.errors[data.name] = placed_error(*plain_model(others), data, rows)
        outside[data.name] = check_set(found, data)["outside_coverage"]
        say(f"without {data.name}")
    return redone, plain, outside


def main() -> int:
    """Print the tables; a whole run puts them into the page."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--every", type=int, default=1, help="each so many-th row alone")
    every = parser.parse_args().every
    document = diagnosed(every)
    say("diagnosed")
    sets = [read_pose_set(DATA / name) for name in NAMES]
    sets = [part_of(data, np.arange(len(data))[::every]) for data in sets]
    counted = [~np.isin(data.row, document["outliers_by_set"].get(data.name, [])) for data in sets]
    blocks = without_blocks(sets, counted)
    series, plain, outside = without_series(sets, counted)
    parts = {
        "verdict": tables.verdict(document),
        "errors": tables.errors(document, blocks, series, plain),
        "causes": tables.causes(document, blocks, series),
        "refused": tables.refused(document),
        "certainty": tables.certainty(document),
        "warming": tables.warming(blocks, FIRST),
        "angles": tables.unvisited(document, outside, BINS),
    }
    for part, text in parts.items():
        place = f"bench/{Path(__file__).name} {part}"
        print(f"<!-- begin: {place} -->\n{text}\n{END}\n")
        if every == 1 and not put(PAGE, place, text):
            say(f"{PAGE.name} has no place for {part}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
