"""How far the diagnosis brings the measured UR10: whole procedure repeated without the rows it is judged on.

python bench/diagnosis_ur10.py [--folds 5] [--only blocks|series] [--data test/data/ur10]

Unlike the figures in diagnosis.json, where the list of causes and orders comes from all rows, everything is
done anew here for every part left out: search, selection, fit.
"""

from __future__ import annotations

import argparse
import dataclasses
import sys
import time
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))

# ruff: noqa: E402
from doormill_ros.diagnosis.pose.check import check_set
from doormill_ros.diagnosis.pose.diagnosis import PoseDiagnosis, diagnose_poses
from doormill_ros.diagnosis.pose.fit import contiguous, fit_causes, place_nominally
from doormill_ros.diagnosis.pose.placement import Seen, place_together
from doormill_ros.measurements.pose_set import PoseSet, read_pose_set
from doormill_ros.robot_model.pose.causes.joint_sag import JointSag
from doormill_ros.robot_model.pose.causes.link_geometry import LinkGeometry
from doormill_ros.robot_model.pose.chain import residual
from doormill_ros.robot_model.pose.model import PoseModel

NAMES = ("grid", "joint-configurations", "random-poses")
#: A prediction this far off is a gross error of the row [um].
GROSS = 1000.0
_COLUMNS = ("row", "time", "temperature", "q", "position", "rotation", "placement")


def part_of(data: PoseSet, rows: np.ndarray) -> PoseSet:
    """Some rows of a series."""
    return dataclasses.replace(data, **{name: getattr(data, name)[rows] for name in _COLUMNS})


def predict(diagnosis: PoseDiagnosis, series: int, data: PoseSet) -> np.ndarray:
    """Residuals of rows of a series that was diagnosed without them; its placement comes from the rest."""
    placement = diagnosis.extended.problem.placements[series]
    return residual(diagnosis.model.frames(data.view), placement, data.position, data.rotation)


def figures(errors: np.ndarray) -> str:
    """Root mean square, the same without rows that are off like no nominal one (gross errors), and the median."""
    size = 1e6 * np.linalg.norm(errors[:, :3], axis=1)
    most = size[size < GROSS]
    turn = 1e6 * np.sqrt(np.mean(np.sum(errors[:, 3:] ** 2, axis=1)))
    return (
        f"rms {np.sqrt(np.mean(size**2)):.0f} um, without {len(size) - len(most)} rows beyond 1 mm "
        f"{np.sqrt(np.mean(most**2)):.0f} um, "
        f"median {np.median(size):.0f} um, rotation {turn:.0f} urad"
    )


def main() -> None:
    """Print the figures."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--folds", type=int, default=5, help="every so many-th block is left out together")
    parser.add_argument("--data", type=Path, default=ROOT / "test" / "data" / "ur10")
    parser.add_argument("--only", choices=("blocks", "series"), help="leave out these alone")
    chosen = parser.parse_args()
    sets = [read_pose_set(chosen.data / name) for name in NAMES]
    if chosen.only != "series":
        leave_blocks_out(sets, chosen.folds)
    if chosen.only != "blocks":
        leave_series_out(sets)


def leave_blocks_out(sets: list[PoseSet], folds: int) -> None:
    """Every so many-th block of each series predicted by a diagnosis without it."""
    start = time.perf_counter()
    errors = [np.zeros((len(data), 6)) for data in sets]
    for fold in range(folds):
        out = [np.concatenate(contiguous(len(data))[fold::folds]) for data in sets]
        rest = [np.setdiff1d(np.arange(len(data)), rows) for data, rows in zip(sets, out, strict=True)]
        found = diagnose_poses([part_of(data, rows) for data, rows in zip(sets, rest, strict=True)])
        for series, (data, rows) in enumerate(zip(sets, out, strict=True)):
            errors[series][rows] = predict(found, series, part_of(data, rows))
        names = ", ".join(map(repr, (score.cause for score in found.established)))
        print(f"fold {fold + 1}, {time.perf_counter() - start:.0f} s: {names}", flush=True)
    for data, error in zip(sets, errors, strict=True):
        print(f"blocks left out, {data.name}: {figures(error)}")
        sizes = [np.sqrt(np.mean(np.sum(error[b, :3] ** 2, axis=1))) for b in contiguous(len(data))]
        print("  by block:", " ".join(f"{1e6 * size:.0f}" for size in sizes), "um")
    print(f"blocks left out, all: {figures(np.concatenate(errors))}", flush=True)


def plain_calibration(sets: list[PoseSet], data: PoseSet) -> float:
    """Position error of a series for a robot calibrated on others with link geometry and sag alone [m]."""
    causes = [LinkGeometry(f"link {k}", data.dh) for k in range(1, 6)]
    fitted = fit_causes(
        sets, [*causes, *(JointSag(f"joint {k}") for k in range(2, 6))], place_nominally(sets)
    )
    problem = fitted.problem
    model = PoseModel(data.robot, data.dh, problem.views[0].links, problem.layout.causes, problem.x)
    T, marked = model.frames(data.view), data.placement
    placement = place_together([Seen(T[marked], data.position[marked], data.rotation[marked])], problem.sigma)
    error = residual(T, placement, data.position, data.rotation)[~marked, :3]
    return float(np.sqrt(np.mean(np.sum(error**2, axis=1))))


def leave_series_out(sets: list[PoseSet]) -> None:
    """Every series predicted by a diagnosis of the others, placed by its marked rows."""
    for index, data in enumerate(sets):
        others = [other for i, other in enumerate(sets) if i != index]
        found = diagnose_poses(others)
        checked = check_set(found, data)
        base, extended = checked["baseline"], checked["extended"]
        outside = ", ".join(
            f"{k} {100 * v:.0f} %" for k, v in checked["outside_coverage"].items() if v > 0.005
        )
        print(
            f"series left out, {data.name}: {1e6 * base['rmse']:.0f} -> {1e6 * extended['rmse']:.0f} um, rotation "
            f"{1e6 * base['rotation_rmse']:.0f} -> {1e6 * extended['rotation_rmse']:.0f} urad; link geometry and sag "
            f"alone {1e6 * plain_calibration(others, data):.0f} um; angles never visited: {outside or 'none'}",
            flush=True,
        )


if __name__ == "__main__":
    main()
