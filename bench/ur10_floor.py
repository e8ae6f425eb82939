"""What is left of the measured UR10, and why more of it cannot be had: docs/diagnosis-ur10.md, two minutes of one core.

Three views of the residuals of `diagnose_poses` on the three series, which the kept run puts into the page:

    python bench/record.py bench/ur10_floor.py

- Poses that the robot came back to within a few rows: how well the arm repeats, and how well its readings do.
- The error of a joint at two readings of nearly the same angle, in rows that are far apart: over which distance it is
  the same. Chance is what independent errors would give.
- Series left out as a whole: rows where another series had visited the angle of joint 1, and the others.
"""

from __future__ import annotations

import sys
from itertools import pairwise
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))

# ruff: noqa: E402
from diagnosis_ur10 import DATA, NAMES, PAGE, say
from page_part import END, put
from scipy.spatial import cKDTree
from ur10_tables import UM, rms, table

from doormill_ros.diagnosis.pose.coverage import bin_of, covered
from doormill_ros.diagnosis.pose.diagnosis import PoseDiagnosis, diagnose_poses
from doormill_ros.measurements.sets.pose_set import read_pose_set
from doormill_ros.robot_model.pose.chain import derivatives, joint_turn

#: Poses are the same within this distance of cosines and sines of their angles.
SAME = 3e-4
#: Rows within which a joint came back, and beyond which neighbours in angle count as apart.
SOON, APART = 30, 25
#: Distances of angles [mrad].
DISTANCES = (0.0, 0.2, 0.8, 3.0, 12.0, 50.0)
#: Joints that move the target enough to be told by its position.
SEEN = range(1, 6)
#: Rows of a series that are compared with each other, at most.
ROWS = 3000


class Left:
    """What the fit leaves of the ordinary rows of a series.

    Attributes:
        rows: Their indices, shape (n,).
        q: Angles, shape (n, J) [rad].
        fitted, blocks, series: Position errors of a fit with them, without their block, without the series, (n, 3) [m].
        turn: Motion of the target for a unit turn of every joint, shape (n, J, 3).
    """

    def __init__(self, found: PoseDiagnosis, series: int) -> None:
        """Pick them."""
        problem, after = found.extended.problem, found.after
        self.rows = np.flatnonzero(~found.gross[series])
        self.q = found.sets[series].q[self.rows]
        self.fitted, self.blocks, self.series = (
            kind[series][self.rows, :3] for kind in (after.train, after.blocks, after.series)
        )
        D = derivatives(problem.frames(series), problem.placements[series])[self.rows, :, :3]
        self.turn = D[:, [joint_turn(k + 1) for k in range(self.q.shape[1])]]


def repeats(name: str, left: Left) -> list[str] | None:
    """Poses that came twice: error, its change from one to the other, and the change of the measured place alone."""
    unit = np.concatenate([np.cos(left.q), np.sin(left.q)], axis=1)
    pairs = np.sort(cKDTree(unit).query_pairs(SAME, output_type="ndarray"), axis=1)
    pairs = pairs[np.abs(np.diff(left.rows[pairs], axis=1)[:, 0]) <= SOON]
    if len(pairs) < SOON:
        return None
    a, b = pairs.T
    change = left.blocks[b] - left.blocks[a]
    angle = np.angle(np.exp(1j * (left.q[b] - left.q[a])))
    # The model moved with the readings: without that it is the arm alone.
    arm = change + np.einsum("nk,nkc->nc", angle, left.turn[a])
    told = (rms([left.blocks[a], left.blocks[b]]), *(rms([one]) / np.sqrt(2.0) for one in (change, arm)))
    spread = np.sqrt(np.mean(angle**2, axis=0) / 2.0)
    return [name, str(len(pairs)), *(f"{UM * one:.0f}" for one in told), f"{UM * spread[:3].max():.0f}"]


def likeness(name: str, left: Left) -> list[list[str]]:
    """By joint and distance of the angles, the size of the error that two rows have in common."""
    some = slice(None, None, -(-len(left.rows) // ROWS))
    rows = left.rows[some]
    apart = np.abs(rows[:, None] - rows) > APART
    lines = []
    for joint in SEEN:
        turn = left.turn[some, joint - 1]
        pull, weight = np.sum(turn * left.fitted[some], axis=1), np.sum(turn**2, axis=1)
        both, weights = np.outer(pull, pull), np.outer(weight, weight)
        away = 1e3 * np.abs(np.angle(np.exp(1j * (left.q[some, None, joint - 1] - left.q[some, joint - 1]))))
        cells = []
        for low, high in pairwise(DISTANCES):
            near = apart & (away >= low) & (away < high)
            common, chance = both[near].sum(), np.sqrt(2.0 * np.sum(both[near] ** 2))
            size = np.sqrt(max(common, 0.0) / weights[near].sum())
            cells.append(f"{UM * size:.0f} (chance {UM * np.sqrt(chance / weights[near].sum()):.0f})")
        lines.append([name, f"joint {joint}", *cells])
    return lines


def visits(name: str, left: Left, others: list[Left]) -> list[str]:
    """Error of a series left out where another one visited the angle of joint 1, and where none did."""
    seen = covered(np.concatenate([other.q[:, 0] for other in others]))[bin_of(left.q[:, 0])]
    parts = [left.series[seen], left.series[~seen]]
    return [
        name,
        f"{100 * np.mean(seen):.0f} %",
        *(f"{UM * rms([one]):.0f}" if len(one) else "-" for one in parts),
    ]


def main() -> int:
    """Print the tables and put them into the page."""
    found = diagnose_poses([read_pose_set(DATA / name) for name in NAMES])
    say("diagnosed")
    lefts = [Left(found, series) for series in range(len(NAMES))]
    pairs = list(zip(NAMES, lefts, strict=True))
    bins = [f"{low:g} to {high:g} mrad" for low, high in pairwise(DISTANCES)]
    same = [told for name, left in pairs if (told := repeats(name, left)) is not None]
    alike = [line for name, left in pairs for line in likeness(name, left)]
    outside = [visits(name, left, [one for one in lefts if one is not left]) for name, left in pairs]
    parts = {
        "repeats": table(
            [
                "series",
                "pairs",
                "error",
                "change of the error",
                "change of the arm",
                "readings, joints 1 to 3 [urad]",
            ],
            same,
        ),
        "alike": table(["series", "joint", *bins], alike),
        "visited": table(
            ["series", "rows where joint 1 was seen", "error there", "error elsewhere"], outside
        ),
    }
    for part, text in parts.items():
        place = f"bench/{Path(__file__).name} {part}"
        print(f"<!-- begin: {place} -->\n{text}\n{END}\n")
        if not put(PAGE, place, text):
            say(f"{PAGE.name} has no place for {part}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
