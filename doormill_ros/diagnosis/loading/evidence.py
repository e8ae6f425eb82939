"""What the page of a loading test shows as evidence: the pattern of each cause, residuals by every circumstance."""

from __future__ import annotations

from doormill_ros.diagnosis.core.words.wording import micrometres
from doormill_ros.diagnosis.loading import pictures
from doormill_ros.diagnosis.loading.law_page import law_page
from doormill_ros.diagnosis.loading.next_measurement import DECIDED, NextMeasurement
from doormill_ros.diagnosis.loading.path_shift import PathShift
from doormill_ros.diagnosis.loading.problem import LoadingDiagnosis
from doormill_ros.pages.page import Block, Charts, PageSection, Paragraphs, Table
from doormill_ros.units import m_to_mm, rad_to_deg


def evidence(diagnosis: LoadingDiagnosis, shift: PathShift | None) -> list[PageSection]:
    """Sections between the causes and the candidates; `shift` is what the causes change on a part."""
    sections = law_page(diagnosis)
    if diagnosis.findings:
        sections += [
            PageSection("The pattern that gave it away", _patterns(diagnosis)),
            PageSection("What it changes on a part", _part(shift)),
        ]
    elif shift is not None:
        sections.append(PageSection("What the laws change on a part", _part(shift)))
    sections.append(
        PageSection(
            "Measured against simulated",
            [
                Charts(pictures.before_and_after(diagnosis), "halves"),
                Paragraphs(
                    [
                        "Every dot is one axis of one trial; the grey bands, here and below, are twice the noise."
                    ]
                ),
            ],
        )
    )
    nameless = pictures.patterns_without_a_name(diagnosis)
    if nameless:
        title = "What remains looks like this, and no cause leaves it"
        sections.append(PageSection(title, [Charts(nameless, "wide")]))
    return [
        *sections,
        PageSection("Residual by joint", [Charts(pictures.residual_by_joint(diagnosis))]),
        PageSection("Residual by load and time", [Charts(pictures.residual_by_circumstance(diagnosis))]),
        PageSection(
            "Residual by direction, reflector and posture", [Charts(pictures.residual_by_group(diagnosis))]
        ),
    ]


def _patterns(diagnosis: LoadingDiagnosis) -> list[Block]:
    blocks: list[Block] = []
    for finding in diagnosis.findings:
        blocks.append(Paragraphs([f"{finding.cause.pattern().capitalize()}."]))
        blocks.append(Charts([pictures.pattern_of(diagnosis, finding)], "wide"))
    return blocks


def _part(shift: PathShift | None) -> list[Block]:
    if shift is None:
        sentence = "Nothing: the causes lie in the measuring chain, and the robot's own model stays as it is."
        return [Paragraphs([sentence])]
    rows = [[feature, f"{m_to_mm(away):.3f} mm"] for feature, away in shift.largest.items()]
    table = [Table(("Feature", "Largest shift of a target"), rows)] if rows else []
    return [Paragraphs([shift.sentence]), *table]


def next_trials_table(plan: NextMeasurement) -> list[Block]:
    """The trials that would decide, where some would."""
    if plan.odds < DECIDED:
        return []
    rows = [
        [
            str(i + 1),
            ", ".join(f"{a:.1f}" for a in rad_to_deg(t.q)),
            f"{t.force:.0f} N along base {t.load}",
            "forwards" if t.direction > 0 else "backwards",
            t.reflector,
            micrometres(t.difference),
        ]
        for i, t in enumerate(plan.trials)
    ]
    head = (
        "", "Joint angles [deg]", "Load", "Last motion of all joints", "Reflector", "The two models differ by",
    )  # fmt: skip
    return [Table(head, rows)]
