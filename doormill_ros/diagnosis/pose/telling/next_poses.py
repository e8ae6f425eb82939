"""Says which poses to measure next: those that tell most about what the model is still unsure of."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.diagnosis.core.fitting.ranking import first_largest
from doormill_ros.diagnosis.pose.coverage import BINS, covered
from doormill_ros.diagnosis.pose.diagnosis import PoseDiagnosis
from doormill_ros.diagnosis.pose.laws import numbers_told
from doormill_ros.robot_model.pose.chain import derivatives, frames
from doormill_ros.robot_model.pose.layout import design, frame_twists
from doormill_ros.statistics import uniform
from doormill_ros.units import m_to_um, rad_to_deg

#: Poses for a degree of an unvisited range that give the highest listed orders three samples a wave.
_PER_BIN = 10


#: Poses that are proposed, and random ones among which they are chosen.
PROPOSED, POSSIBLE = 12, 300
#: Random postures that are looked at to find possible ones.
_TRIED = 20000


@dataclass(frozen=True, eq=False)
class NextPoses:
    """Poses to measure before the tracker of the last series is moved.

    Attributes:
        q: Joint angles, shape (n, J) [rad].
        information: What each adds to the ones before it, shape (n,) [nat].
        before, after: Expected position error from what is uncertain in the model, root mean square over all
            possible poses, now and with these poses measured [m].
    """

    q: FloatArray
    information: FloatArray
    before: float
    after: float


def propose(diagnosis: PoseDiagnosis, seed: int = 0) -> NextPoses | None:
    """Greedy choice of the poses with the largest expected information; None when no cause is established.

    A pose with derivatives A (whitened) tells 1/2 log det(1 + A C A^T) about coefficients of covariance C; then C
    shrinks as that of a Kalman filter does.
    """
    fitted = diagnosis.extended
    problem, C = fitted.problem, fitted.solution.covariance
    q = possible_poses(diagnosis, seed) if problem.layout.size else np.zeros((0, problem.joints))
    if not len(q):
        return None
    A = effect_on_pose(diagnosis, q) * problem.scale(len(problem.sets) - 1)[:, None]
    flat = A.reshape(-1, A.shape[2])
    spread = flat @ C @ flat.T  # covariance of all predicted poses, (6 n, 6 n)
    before = _position_error(spread, problem.sigmas[-1][0])
    chosen, told = [], []
    for _ in range(min(PROPOSED, len(q))):
        own = np.array([spread[6 * i : 6 * i + 6, 6 * i : 6 * i + 6] for i in range(len(q))])
        gain = 0.5 * np.linalg.slogdet(np.eye(6) + own)[1]
        best = first_largest(gain)
        chosen.append(best)
        told.append(float(gain[best]))
        seen = slice(6 * best, 6 * best + 6)
        spread = spread - spread[:, seen] @ np.linalg.solve(np.eye(6) + own[best], spread[seen])
    return NextPoses(q[chosen], np.array(told), before, _position_error(spread, problem.sigmas[-1][0]))


def listed(poses: NextPoses | None) -> list[dict[str, Any]]:
    """The poses for diagnosis.json: joint angles [rad] and what each adds [nat]."""
    if poses is None:
        return []
    return [
        {"q": [round(float(v), 4) for v in q], "information": float(gain)}
        for q, gain in zip(poses.q, poses.information, strict=True)
    ]


def _position_error(spread: FloatArray, sigma: float) -> float:
    variance = np.diag(spread).reshape(-1, 6)[:, :3]
    return float(sigma * np.sqrt(np.mean(np.sum(variance, axis=1))))


def possible_poses(diagnosis: PoseDiagnosis, seed: int) -> FloatArray:
    """Random postures, every joint through its whole turn, with the target where targets have been: (n, J) [rad].

    Neither lower nor nearer to the axis of joint 1 nor farther out than any measured one.
    """
    problem = diagnosis.extended.problem
    q = np.pi * (2.0 * uniform((_TRIED, problem.joints), seed) - 1.0)
    offset = problem.placements[-1].T_flange_target[:, 3]
    target = frames(diagnosis.model.view(q).transforms)[:, -1] @ offset
    seen = []
    for data, placement in zip(problem.sets, problem.placements, strict=True):
        T = placement.T_tracker_base
        seen.append((data.position - T[:3, 3]) @ T[:3, :3])
    measured = np.concatenate(seen)
    out, reach = np.linalg.norm(target[:, :2], axis=1), np.linalg.norm(measured[:, :2], axis=1)
    good = (target[:, 2] > measured[:, 2].min()) & (out > reach.min()) & (out < reach.max())
    result: FloatArray = q[good][:POSSIBLE]
    return result


def effect_on_pose(diagnosis: PoseDiagnosis, q: FloatArray) -> FloatArray:
    """Derivatives of the target's pose by all coefficients and placements, base axes, shape (n, 6, m)."""
    problem = diagnosis.extended.problem
    view = diagnosis.model.view(q)
    bases = design(view, problem.layout)
    placement = problem.placements[-1]
    D = derivatives(
        frames(view.transforms, frame_twists(bases, problem.x, len(q), problem.joints)), placement
    )
    A = np.zeros((len(q), 6, problem.size))
    for key, (ids, basis) in bases.items():
        A[:, :, ids] += D[:, key, :, None] * basis[:, None, :]
    own = problem.placement_ids(len(problem.sets) - 1)
    A[:, :, own] = np.swapaxes(D[:, problem.free[-1]], 1, 2)
    return A


def plan_next(diagnosis: PoseDiagnosis, poses: NextPoses | None) -> str:
    """One sentence, computed from the expected information, the coverage and the standard deviations."""
    wanted = []
    for k in range(diagnosis.sets[0].joints):
        visited = covered(np.concatenate([data.q[:, k] for data in diagnosis.sets]))
        edges = np.flatnonzero(np.diff(np.concatenate([[False], ~visited, [False]]).astype(int))).reshape(
            -1, 2
        )
        if len(edges):
            low, high = max(edges.tolist(), key=lambda e: e[1] - e[0])
            a, b = rad_to_deg(np.array([low, high]) * 2.0 * np.pi / BINS - np.pi)
            wanted.append(((high - low) / BINS, f"joint {k + 1} from {a:.0f} to {b:.0f} deg"))
    wanted.sort(reverse=True)
    parts = []
    if poses is not None:
        first = ", ".join(f"{a:.0f}" for a in rad_to_deg(poses.q[0]))
        parts.append(
            f"measure the {len(poses.q)} poses listed (the first at {first} deg; check the way there): of "
            f"{POSSIBLE} possible ones they tell most, and bring what is uncertain in the model from "
            f"{m_to_um(poses.before):.0f} to {m_to_um(poses.after):.0f} um, averaged over the space the tool worked in"
        )
    if wanted:
        ranges = ", ".join(text for _, text in wanted[:3])
        parts.append(
            f"take at least {_PER_BIN} poses for every 5 deg of the widest ranges no series has visited ({ranges})"
        )
    weakest = _weakest(diagnosis)
    if weakest:
        parts.append(f"vary the postures that tell {weakest} apart, it is known least for its size")
    parts.append(
        "come to each pose from both sides, since the last motion is read from the row before"
        if len(diagnosis.sets) > 1
        else "take a second series with another placement, to see what holds beyond this one"
    )
    return "; ".join(parts).capitalize() + "."


def _weakest(diagnosis: PoseDiagnosis) -> str:
    """The established cause whose main coefficient is known least for its size."""
    found = []
    told, deviation = numbers_told(diagnosis)
    for cause, part in diagnosis.extended.parts:
        x, std = told.x[part], deviation[part]
        found.append((float(np.max(np.abs(x) / np.maximum(std, 1e-30))), repr(cause).replace("_", " ")))
    return min(found)[1] if found else ""
