"""Recordings of moving joints: encoders on both sides of the gears question the springs between them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from doormill_ros.diagnosis.core.kind import Kind, Progress
from doormill_ros.diagnosis.core.telling.account import Account, told
from doormill_ros.diagnosis.core.words.wording import RADIANS, Words
from doormill_ros.diagnosis.law.page import TITLE, lead, picture, sentence
from doormill_ros.diagnosis.motion import pictures
from doormill_ros.diagnosis.motion.account import (
    by_joint,
    check_set,
    law_sections,
    named_causes,
    remarks,
)
from doormill_ros.diagnosis.motion.diagnosis import MotionDiagnosis, diagnose_motions
from doormill_ros.diagnosis.motion.laws import model_with_laws, with_laws
from doormill_ros.measurements.sets.motion_set import (
    MotionSet,
    check_same_joints,
    check_same_noise,
    read_motion_set,
)
from doormill_ros.pages.page import Block, Charts, PageSection, Paragraphs, Table
from doormill_ros.robot_model.motion.model import model_document
from doormill_ros.units import UM

METHOD = """The model in question says that the link lags behind the motor by torque over stiffness. Noise makes a
spring look harder than it is, so a torque with much white noise was filtered as far as it showed nothing else. Each
cause adds to that difference in proportion to its numbers; a skew and the width of a hysteresis are found by stepping.
Friction and damping are torques that the spring does not see. A damper beside the spring lets the twist follow the
torque, and a torque that is read late seems to follow the twist. Each
recording is cut into twenty contiguous blocks, every tenth is predicted by a fit that has not seen it. A cause is
named if that improves by far more than what is left has at the frequencies of the cause, in most blocks, by a
twentieth at least, and if no shape without a name does clearly better in its place; with several recordings also if
those left out as a whole do not lose by it. Standard deviations come from the scatter of whole blocks, because
neighbouring samples repeat each other. A lone encoder that is read early looks like damping, and is called so while the
motor gave the torque for it; early encoders that agree, or are earlier, have a negative skew. A recording that is
only checked gives nothing but its own constants."""


class Motions(Kind[MotionSet, MotionDiagnosis]):
    """Recordings of the same joints, each with offsets of its own.

    Samples repeat their neighbours and a joint's residual stays far above the encoders' noise: models are compared by
    what chance gives at the frequencies of a cause, not by independent rows.
    """

    def read(self, folder: Path, progress: Progress) -> Sequence[MotionSet]:
        """The recording in a folder."""
        return [read_motion_set(folder)]

    def check_together(self, sets: Sequence[MotionSet], others: Sequence[MotionSet]) -> None:
        """One robot, the same joints and springs; one noise of those that are diagnosed."""
        for other in (*sets[1:], *others):
            check_same_joints(sets[0], other)
        for other in sets[1:]:
            check_same_noise(sets[0], other)

    def diagnose(self, sets: Sequence[MotionSet], progress: Progress) -> MotionDiagnosis:
        """Find the causes of each joint, what all link encoders have in common, and laws for what no cause names."""
        return with_laws(diagnose_motions(sets, progress), progress)

    def check(self, diagnosis: MotionDiagnosis, other: MotionSet) -> dict[str, Any]:
        """Predicted by the published springs and by the extended model."""
        return check_set(diagnosis, other)

    def account(
        self,
        diagnosis: MotionDiagnosis,
        sets: Sequence[MotionSet],
        checks: Sequence[Mapping[str, Any]],
        progress: Progress,
    ) -> Account:
        """Every rmse is in radians, over all joints or by joint."""
        causes = named_causes(diagnosis)
        laws = law_sections(diagnosis)
        sections: dict[str, Any] = {"by_joint": by_joint(diagnosis), **laws}
        model = model_with_laws(diagnosis) if laws else diagnosis.model
        source = f"diagnosis of {', '.join(one.name for one in sets)}, verdict {diagnosis.verdict}"
        return told(
            diagnosis,
            Words(f"model of {sets[0].robot}", "samples", unseen="blocks", method=METHOD),
            RADIANS,
            diagnosis.noise_floor,
            causes,
            rows=sum(map(len, sets)),
            outliers=_slips(diagnosis),
            remarks=remarks(diagnosis),
            next_measurement=_next_measurement(diagnosis, laws.get("unnamed", ())),
            checks=checks,
            sections=sections,
            model=model_document(model, source),
            evidence=_evidence(diagnosis),
            candidates=[Charts([pictures.by_joint(diagnosis)], "wide")],
            closing=_closing(sets, checks),
        )


def _slips(diagnosis: MotionDiagnosis) -> list[int]:
    """Lines of samples.csv at which a reading slipped, of the first recording that has such."""
    lines: set[int] = set()
    for finding in diagnosis.joints:
        problem = finding.problem
        for i, data in enumerate(diagnosis.sets):
            lines |= {int(line) for line in data.line[~problem.kept[problem.recording == i]]}
    return sorted(lines)


def _next_measurement(diagnosis: MotionDiagnosis, laws: Sequence[Mapping[str, Any]]) -> str:
    """One sentence."""
    doubtful = [
        (cause, double.cause)
        for finding in diagnosis.joints
        for cause, doubles in zip(finding.extended.members, finding.doubles, strict=True)
        for double in doubles
    ]
    if doubtful:
        cause, double = doubtful[0]
        if cause.key == double.key:
            return f"To tell {cause!r} from {double.variant}, move {cause.where} over more of a turn."
        return (
            f"To tell {cause!r} from {double!r}, move {cause.where} slowly to and fro over its whole range with two "
            "payloads: the first changes speed and angle alone, the second the torque alone."
        )
    if laws:
        return (
            f"Move {laws[0]['where']} alone, at three speeds and with two payloads: that leaves its law without a "
            f"name one driver. Or {laws[0]['test']}."
        )
    if len(diagnosis.sets) == 1:
        return "Record the same joints on another path: nothing else shows whether a cause holds beyond one recording."
    return "Nothing is open that another recording of this kind would decide."


def _evidence(diagnosis: MotionDiagnosis) -> list[PageSection]:
    joints = diagnosis.joints
    return [
        *_laws(diagnosis),
        PageSection("Every joint", [_by_joint_table(diagnosis)]),
        PageSection("Course of the recording", [Charts(pictures.course(diagnosis), "halves")]),
        PageSection(
            "The pattern that gave it away: against the speed",
            [Charts([pictures.against_speed(one) for one in joints])],
        ),
        PageSection(
            "What is left, against the torque", [Charts([pictures.against_torque(one) for one in joints])]
        ),
        PageSection("Waves over the angle", [Charts([pictures.orders(one) for one in joints])]),
    ]


def _laws(diagnosis: MotionDiagnosis) -> list[PageSection]:
    found = [(one, laws) for one, laws in zip(diagnosis.joints, diagnosis.laws, strict=False) if laws]
    if not found:
        return []
    after = law_sections(diagnosis)["characterised"]["holdout_rmse"]
    blocks: list[Block] = [
        lead(diagnosis.holdout_rmse[1], after, diagnosis.noise_floor, RADIANS, "unseen samples")
    ]
    for _, laws in found:
        for law in laws.laws:
            blocks += [Paragraphs([sentence(law, RADIANS, "unseen samples")]), picture(laws, law, RADIANS)]
    return [PageSection(TITLE, blocks)]


def _by_joint_table(diagnosis: MotionDiagnosis) -> Block:
    rows = [
        [where, *(f"{one[key] / UM:.1f}" for key in ("baseline", "extended", "noise_floor"))]
        for where, one in by_joint(diagnosis).items()
    ]
    return Table(("Joint", "Springs as published [urad]", "Extended, blocks left out", "Noise"), rows)


def _closing(sets: Sequence[MotionSet], checks: Sequence[Mapping[str, Any]]) -> list[PageSection]:
    sections = []
    if checks:
        rows = [
            [one["set"], where, *(f"{figure / UM:.1f}" for figure in entry.values())]
            for one in checks
            for where, entry in one["by_joint"].items()
        ]
        head = ["Set", "Joint", "Springs as published [urad]", "Extended", "Extended, offset alone its own"]
        head += ["With laws"] * (len(rows[0]) - len(head))
        sections.append(PageSection("Checked recordings by joint", [Table(tuple(head), rows)]))
    sources = dict.fromkeys(data.source for data in sets if data.source)
    if sources:
        sections.append(PageSection("Data", [Paragraphs(list(sources))]))
    return sections
