"""Series of poses: where a tracker saw the target of an unloaded robot questions its nominal model."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from doormill_ros.arrays import BoolArray, FloatArray
from doormill_ros.diagnosis.core.kind import Kind, Progress
from doormill_ros.diagnosis.core.telling.account import Account, told
from doormill_ros.diagnosis.core.telling.document import cause_entry
from doormill_ros.diagnosis.core.words.wording import Unit, Words
from doormill_ros.diagnosis.law.page import TITLE, lead, picture, sentence
from doormill_ros.diagnosis.pose.check import check_set
from doormill_ros.diagnosis.pose.coverage import coverage
from doormill_ros.diagnosis.pose.diagnosis import PoseDiagnosis, diagnose_poses
from doormill_ros.diagnosis.pose.fitting.model import Errors, figures
from doormill_ros.diagnosis.pose.laws import model_with_laws, with_laws
from doormill_ros.diagnosis.pose.stance.standing import standing_document, standing_remarks
from doormill_ros.diagnosis.pose.telling.causes import (
    WITHIN,
    causes_of,
    doubts,
    indistinguishable,
    meanings,
    not_determined,
    rejected_entry,
)
from doormill_ros.diagnosis.pose.telling.certainty import certainty_section
from doormill_ros.diagnosis.pose.telling.evidence import (
    candidates_blocks,
    closing,
    evidence,
    next_poses_table,
)
from doormill_ros.diagnosis.pose.telling.next_poses import listed, plan_next, propose
from doormill_ros.diagnosis.pose.together import check_marked, check_names, check_rows, check_together
from doormill_ros.measurements.sets.pose_set import PoseSet, placement_owners, read_pose_set
from doormill_ros.pages.page import Block, PageSection, Paragraphs
from doormill_ros.robot_model.pose.model import model_document
from doormill_ros.units import m_to_um

#: Position errors are three-dimensional lengths, far above a tenth of a micrometre.
UNIT = Unit("m", "um", digits=0)

METHOD = """Every series has a placement of its own: base in tracker and target on flange. Each cause displaces
the robot's frames a little, in proportion to its numbers; all are fitted together by weighted least squares that
gross errors cannot steer. How large the numbers of a kind usually are is learnt from the data, so that what the data
do not call for vanishes. Each series is cut into ten contiguous blocks, every fifth block is predicted by a fit that
has not seen it; whole series are predicted with only the placement fitted, on rows marked for that. A cause is named
if taking it away makes the blocks left out worse by more than their scatter allows, in more than one series where
there are several."""


class Poses(Kind[PoseSet, PoseDiagnosis]):
    """Series of poses of one robot, each with a placement of its own.

    Hundreds of coefficients are fitted at once and their sizes learnt: everything that may act is in from the start,
    and what the core's search leaves is named.
    """

    def read(self, folder: Path, progress: Progress) -> Sequence[PoseSet]:
        """The series in a folder."""
        return [read_pose_set(folder)]

    def check_together(self, sets: Sequence[PoseSet], others: Sequence[PoseSet]) -> None:
        """One robot, one nominal table, a name and enough rows for each, and every placement that a set names."""
        check_together([*sets, *others])
        check_names(sets)
        check_rows(sets)
        placement_owners(sets)
        check_marked(sets, others)

    def diagnose(self, sets: Sequence[PoseSet], progress: Progress) -> PoseDiagnosis:
        """Fit everything that may act, and keep what earns its place on rows left out; then laws for the rest."""
        return with_laws(diagnose_poses(sets, progress), progress)

    def check(self, diagnosis: PoseDiagnosis, other: PoseSet) -> dict[str, Any]:
        """Placed by its marked rows, the others are predicted."""
        return check_set(diagnosis, other)

    def check_all(self, diagnosis: PoseDiagnosis, others: Sequence[PoseSet]) -> list[dict[str, Any]]:
        """The same of several, which may have one placement in common."""
        return [check_set(diagnosis, other, others) for other in others]

    def account(
        self,
        diagnosis: PoseDiagnosis,
        sets: Sequence[PoseSet],
        checks: Sequence[Mapping[str, Any]],
        progress: Progress,
    ) -> Account:
        """Every rmse is a 3-D position error and stands beside its rotation_rmse."""
        progress("choosing poses to measure next")
        poses = propose(diagnosis)
        causes = causes_of(diagnosis)
        series = [cause_entry(cause) for cause in causes if cause.where.startswith("set")]
        source = f"diagnosis of {', '.join(one.name for one in sets)}, verdict {diagnosis.verdict}"
        standing = diagnosis.question.standing
        sections = {**_sections(diagnosis), **standing_document(standing), "next_poses": listed(poses)}
        laws = diagnosis.laws
        sections |= {} if laws is None else laws.document()
        after = _figures(diagnosis, diagnosis.after)
        unseen = after.get("series_out_rmse")
        return told(
            diagnosis,
            Words(
                f"model of {sets[0].robot}",
                "poses",
                "position error",
                "error",
                "blocks",
                METHOD,
                assumed=any("position" in one.assumed for one in sets),
            ),
            UNIT,
            diagnosis.noise_floor,
            causes,
            baseline=_figures(diagnosis, diagnosis.before),
            extended=after,
            rows=sum(len(one) for one in sets),
            outliers=[
                int(row)
                for data, bad in zip(diagnosis.sets, diagnosis.gross, strict=True)
                for row in data.row[bad]
            ],
            remarks=[
                *standing_remarks(standing),
                *doubts(diagnosis, causes),
                *_remarks(diagnosis),
                *meanings(diagnosis, causes),
            ],
            next_measurement=plan_next(diagnosis, poses),
            checks=checks,
            sections=sections,
            model=model_document(model_with_laws(diagnosis), source, series),
            evidence=[*_law_page(diagnosis), *evidence(diagnosis, sections["sets"])],
            candidates=candidates_blocks(diagnosis, sections),
            next_blocks=next_poses_table(sections["next_poses"]),
            closing=closing(diagnosis, sections, checks),
            tiles=[] if unseen is None else [(UNIT.spoken(unseen), "extended model on unseen series")],
        )


def _law_page(diagnosis: PoseDiagnosis) -> list[PageSection]:
    found = diagnosis.laws
    if found is None:
        return []
    after, floor = found.holdout_rmse, diagnosis.noise_floor
    blocks: list[Block] = [lead(diagnosis.holdout_rmse[1], after, floor, UNIT, "unseen poses")]
    for law in found.laws:
        blocks += [Paragraphs([sentence(law, UNIT, "unseen poses")]), picture(found, law, UNIT)]
    return [PageSection(TITLE, blocks)]


def _figures(diagnosis: PoseDiagnosis, errors: Errors) -> dict[str, float]:
    kept = [~bad for bad in diagnosis.gross]
    found: dict[str, float] = {}
    for part, residuals in (
        ("train", errors.train),
        ("holdout", errors.blocks),
        ("series_out", errors.series),
    ):
        if residuals:
            found |= _both(diagnosis.sets, residuals, kept, f"{part}_")
    turned = found.get("holdout_rotation_rmse")
    return found if turned is None else found | {"rotation_rmse": turned}


def _both(
    sets: Sequence[PoseSet], errors: Sequence[FloatArray], kept: Sequence[BoolArray], part: str = ""
) -> dict[str, float]:
    """`rmse` and, where an orientation was measured, `rotation_rmse`, behind the name of a part."""
    position, rotation = figures(sets, errors, kept)
    found = {f"{part}rmse": position}
    return found if rotation is None else found | {f"{part}rotation_rmse": rotation}


def _sections(diagnosis: PoseDiagnosis) -> dict[str, Any]:
    """What diagnosis.json says of poses beyond what it says of every kind of data."""
    return {
        "outliers_by_set": {
            data.name: [int(row) for row in data.row[bad]]
            for data, bad in zip(diagnosis.sets, diagnosis.gross, strict=True)
            if bad.any()
        },
        "sets": [_series(diagnosis, index) for index in range(len(diagnosis.sets))],
        "only_within_one_series": [
            rejected_entry(diagnosis, score) for score in diagnosis.rejected if score.status in WITHIN
        ],
        "rejected": [
            rejected_entry(diagnosis, score) for score in diagnosis.rejected if score.status not in WITHIN
        ],
        "not_distinguishable_from_placement": indistinguishable(diagnosis),
        "not_determined": not_determined(diagnosis.sets),
        "coverage": coverage(diagnosis),
        "certainty": certainty_section(diagnosis),
    }


def _series(diagnosis: PoseDiagnosis, index: int) -> dict[str, Any]:
    data, kept = diagnosis.sets[index], [~diagnosis.gross[index]]
    entry: dict[str, Any] = {
        "set": data.name,
        "rows": len(data),
        "gross_errors": int(diagnosis.gross[index].sum()),
    }
    for name, errors in (("baseline", diagnosis.before), ("extended", diagnosis.after)):
        held = _both([data], [errors.blocks[index]], kept)
        entry[name] = {
            "train_rmse": figures([data], [errors.train[index]], kept)[0],
            "holdout_rmse": held.pop("rmse"),
            **held,
        }
        if errors.series:
            entry[name] |= _both([data], [errors.series[index]], kept, "series_out_")
    return entry


def _remarks(diagnosis: PoseDiagnosis) -> list[str]:
    """Sentences for the reader."""
    lines = [
        "Position errors are 3-D lengths; rows listed as gross errors count in no figure.",
        "Away from the joint angles listed under coverage the periodic errors fade and nothing is claimed.",
    ]
    for data in diagnosis.sets:
        told = {"position": UNIT.spoken(data.noise[0]), "rotation": f"{m_to_um(data.noise[1]):.0f} urad"}
        shown = [name for name in data.assumed if name == "position" or data.oriented]
        if shown:
            assumed = " and ".join(f"{told[name]} for the {name}" for name in shown)
            lines.append(
                f"{data.name} does not state all its noise: {assumed} of standard deviation per axis was assumed, and "
                "what counts as noise hangs on it. State `noise` in set.yaml."
            )
    if not any(data.links for data in diagnosis.sets) and diagnosis.extended.problem.views[0].links:
        lines.append("The sets state no masses; gravity torques use the maker's published ones.")
    if not diagnosis.extended.problem.views[0].links:
        lines.append(
            "No masses are known: sag under gravity is told by the turns that unknown moments of the links give each "
            "joint, not by a compliance. Where an axis lies level, those of its own link are like its first wave."
        )
    if not_determined(diagnosis.sets):
        lines.append(
            "Positions alone were measured: the target is a point, its orientation on the flange is not determined, "
            "and nothing is said about rotations."
        )
    if len({data.noise[0] for data in diagnosis.sets}) > 1:
        lines.append(
            "The sets state different noise: each row counts by its own, and gain and laws are told at the noise that "
            "the sets have in common; every other error is as measured."
        )
    if len(diagnosis.sets) == 1:
        lines.append("With a single series nothing shows whether a cause holds beyond it.")
    return lines
