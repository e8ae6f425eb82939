"""What a diagnosis of moving joints tells: causes with their parameters, figures by joint, laws without a name."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.diagnosis.core.examining.examination import Double
from doormill_ros.diagnosis.core.telling.account import NamedCause
from doormill_ros.diagnosis.core.words.wording import spoken
from doormill_ros.diagnosis.motion.diagnosis import ENCODERS, MotionDiagnosis
from doormill_ros.diagnosis.motion.examination import JointFinding
from doormill_ros.diagnosis.motion.laws import model_with_laws
from doormill_ros.diagnosis.motion.model import JointFit, coefficients, stiffness_of
from doormill_ros.diagnosis.motion.noise import no_slips, size_of
from doormill_ros.measurements.sets.motion_set import MotionSet
from doormill_ros.robot_model.motion.causes.time_skew import TimeSkew
from doormill_ros.robot_model.motion.model import JointModel
from doormill_ros.statistics import bootstrap_ratio, root_mean_square

Figures = dict[str, dict[str, Any]]


def by_joint(diagnosis: MotionDiagnosis) -> Figures:
    """Held-out RMSE of baseline and extended model of every joint, with its noise [rad]."""
    return {
        one.problem.where: {
            "baseline": one.problem.rmse(one.baseline.held_out),
            "extended": one.problem.rmse(one.extended.held_out),
            "noise_floor": one.problem.floor,
        }
        for one in diagnosis.joints
    }


def check_set(diagnosis: MotionDiagnosis, other: MotionSet) -> dict[str, Any]:
    """Predict a recording that no fit has seen; only its own constants are taken from it."""
    found: Figures = {}
    described = model_with_laws(diagnosis) if any(diagnosis.laws) else None
    for motion in other.motions:
        kept = no_slips(motion)
        plain = JointModel(motion.joint, motion.stiffness).residual(motion, kept=kept)
        model = diagnosis.model.of(motion.joint)
        found[f"joint {motion.joint}"] = {
            "baseline": size_of(plain),
            "extended": size_of(model.residual(motion, kept=kept)),
            "extended_with_offset_alone": size_of(model.residual(motion, own=False, kept=kept)),
        }
        if described is not None:
            left = described.of(motion.joint).residual(motion, company=other.motions, kept=kept)
            found[f"joint {motion.joint}"]["characterised"] = size_of(left)
    entry: dict[str, Any] = {"set": other.name, "rows": len(other)}
    for name in found[f"joint {other.joints[0]}"]:
        entry[name] = {"rmse": root_mean_square([one[name] for one in found.values()])}
    return entry | {"by_joint": found}


def named_causes(diagnosis: MotionDiagnosis) -> list[NamedCause]:
    """Established causes; orders of one joint's periodic error together."""
    found = []
    joints, extended = diagnosis.joints, diagnosis.extended
    total = diagnosis.holdout_rmse[1]
    if extended.skew:
        found.append(
            NamedCause(
                cause=TimeSkew.name,
                where=ENCODERS,
                words=f"time skew of the {ENCODERS}",
                parameters={"skew": {"value": extended.skew, "std": extended.skew_std, "unit": "s"}},
                without=diagnosis.without_skew,
            )
        )
    for finding, told in zip(joints, diagnosis.told, strict=True):
        members = finding.extended.members
        for key in dict.fromkeys(cause.key for cause in members):
            indices = [i for i, cause in enumerate(members) if cause.key == key]
            found.append(_named(finding, told, indices, total, len(joints)))
    return found


def _named(
    finding: JointFinding, told: JointFit, indices: Sequence[int], total: float, joints: int
) -> NamedCause:
    """One cause: its numbers as they are told, its worth as one of the named causes alone."""
    extended, problem = finding.extended, finding.problem
    first = extended.members[indices[0]]
    doubles: dict[tuple[str, ...], Double[Any, Any]] = {}
    parameters: Figures = {}
    for index in indices:
        parameters |= _parameters(told, index, problem.stiffness)
        for double in finding.doubles[index]:
            # Of other causes one reading, of a wave every order.
            same = double.cause.key == first.key
            doubles.setdefault(double.cause.identity if same else double.cause.key, double)
    rest = [cause for i, cause in enumerate(extended.members) if i not in indices]
    delay = finding.search.delay_without(extended.delay, first)
    without = problem.rmse(problem.settled(rest, delay).held_out)
    own = problem.rmse(extended.held_out)
    return NamedCause(
        cause=first.name,
        where=first.where,
        words=spoken(first),
        parameters=parameters,
        without=float(np.sqrt(max(total**2 + (without**2 - own**2) / joints, 0.0))),
        doubles=tuple(doubles.values()),
        more={"joint_holdout_rmse_without": without},
    )


def _parameters(told: JointFit, index: int, given: float) -> Figures:
    """Values of a member with standard deviations from the scatter of the blocks; `given` is the spring [N m / rad]."""
    cause = told.members[index]
    x = coefficients(told, index).copy()
    if cause.of_delay:
        x = x + told.delay
    spread = _spread(told, index)
    stiffness = stiffness_of(told.members, told.x, given)
    at = told.spring
    stiffness_std = 0.0 if at is None else stiffness**2 * float(told.std[at][0])
    found: Figures = {}
    now = cause.values(x, stiffness)
    for name, (value, unit) in now.items():
        variance = 0.0
        for i, std in enumerate(spread):
            moved = x.copy()
            moved[i] += std
            variance += (cause.values(moved, stiffness)[name][0] - value) ** 2
        variance += (cause.values(x, stiffness + stiffness_std)[name][0] - value) ** 2
        found[name] = {"value": value, "std": float(np.sqrt(variance)), "unit": unit}
        found[name] |= {key: cause.settings[key] for key in cause.told_settings}
    return found


def _spread(found: JointFit, index: int) -> FloatArray:
    """Standard deviations of the coefficients that `coefficients` gives."""
    if not found.members[index].phased:
        return found.std[index]
    deviations = [root_mean_square(std) for std in found.own_std[index]]
    return np.array([root_mean_square(deviations) / np.sqrt(len(deviations))])


def law_sections(diagnosis: MotionDiagnosis) -> dict[str, Any]:
    """`unnamed` and `characterised` of diagnosis.json; nothing where no law was found."""
    found = [laws for laws in diagnosis.laws if laws is not None]
    if not found:
        return {}
    parts, groups = [], []
    for finding, laws in zip(diagnosis.joints, diagnosis.laws, strict=True):
        problem = finding.problem
        if laws is None:
            counts = np.bincount(problem.block, weights=problem.kept, minlength=problem.block.max() + 1)
            parts.append(problem.rmse(finding.extended.held_out))
            groups.append(problem.by_block(finding.extended.held_out) / np.maximum(counts, 1.0))
        else:
            parts.append(laws.holdout_rmse)
            groups.append(laws.by_configuration)
    squares = np.mean(groups, axis=0)
    _, (low, high) = bootstrap_ratio(np.full(len(squares), squares.mean()), squares)
    value = root_mean_square(parts)
    return {
        "unnamed": [law.document() for laws in found for law in laws.laws],
        "characterised": {"holdout_rmse": value, "ci95": [value * low, value * high]},
    }


def remarks(diagnosis: MotionDiagnosis) -> list[str]:
    """Sentences for the reader."""
    lines = [
        "Every joint of every recording has an offset of its own; so has a bristle or a tooth where it lay when the "
        "recording began, and a fine scale without an index its phase.",
    ]
    if all(value is None for value in diagnosis.sets[0].noise):
        lines.append("The sets state no noise: it is estimated from how neighbouring samples differ.")
    for finding in diagnosis.joints:
        lines += [f"{cause!r} comes close but is not believed: {why}." for cause, why in finding.refused]
        slips = int((~finding.problem.kept).sum())
        if slips:
            lines.append(
                f"{slips} samples of {finding.problem.where} are slips of the reading and count in no figure."
            )
    return lines
