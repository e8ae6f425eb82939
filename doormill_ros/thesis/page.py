"""report.html of the thesis' own loading tests."""

from __future__ import annotations

import numpy as np

from doormill_ros.diagnosis.core.words.wording import MICRO, micrometres, spoken, with_deviation
from doormill_ros.pages.charts import BLUE, GREEN, GREY, RED, WIDE, BarRow, Curve, bars, scatter
from doormill_ros.pages.page import Charts, Page, PageSection, Paragraphs, Table, render
from doormill_ros.thesis.diagnosis import ThesisDiagnosis, ThesisRow
from doormill_ros.thesis.preload import PreloadReading
from doormill_ros.thesis.wording import candidates_sentence, joint_3_sentence
from doormill_ros.units import m_to_um

MILLION = 1e6


def thesis_headline(found: ThesisDiagnosis) -> str:
    """The verdict in one line."""
    names = ", ".join(spoken(candidate.cause) for candidate in found.candidates[:-1])
    return (
        f"Partly explained: {names} or {spoken(found.candidates[-1].cause)}; five lengths cannot decide which"
    )


def render_thesis_report(found: ThesisDiagnosis, gap: PreloadReading) -> str:
    """The page as HTML text without any outside resource."""
    low, high = found.test_6_range
    lead = (
        "The simulation of table 4.2 lets the joint under test give way alone. With all springs of table 4.1 acting, "
        f"tests 3 and 5 overshoot. {candidates_sentence(found)}"
    )
    held_out = (
        "Extended: by the first of them. Held out: the cause fitted without the test, so test 5 alone predicts test "
        "3 and the other way round. "
        f"Test 6 with all joints gives {micrometres(low)} or {micrometres(high)}, depending on the side on which its "
        "reflector sat, which is not printed."
    )
    following = (
        "Joint 1 with a second, larger weight, pre-loaded and not: the slope of the pre-loaded readings is the spring "
        f"alone, and the two readings above put it at {_closed(gap) / MILLION:.2f} or "
        f"{gap.stiffness_if_friction / MILLION:.2f} × 10⁶ N m / rad. Test 3 with a second reflector before joint 3: it "
        "shows what joint 2 does, and parts the candidates for joint 3 from joint 2."
    )
    sections = [
        PageSection(
            "Table 4.2: measured against simulated",
            [
                Charts([_lengths(found)], "wide"),
                _table(found),
                Paragraphs([joint_3_sentence(found), found.unchanged, held_out]),
            ],
        ),
        PageSection(
            "Table 4.3: joint 1 pre-loaded and not",
            [Charts([_angles(gap)], "wide"), Paragraphs([_readings(gap)])],
        ),
        PageSection("What to measure next", [Paragraphs([following])]),
    ]
    return render(Page(thesis_headline(found), sections, lead))


def _lengths(found: ThesisDiagnosis) -> str:
    rows = []
    for row in found.rows:
        rows += [
            BarRow(f"test {row.joint}: measured", [m_to_um(row.measured)], [GREEN]),
            BarRow("thesis' simulation", [m_to_um(row.simulated)], [RED]),
            BarRow("all joint springs", [m_to_um(row.all_joints)], [GREY]),
            BarRow("extended", [m_to_um(row.extended)], [BLUE]),
        ]
    return bars("displacement of the reflector", f"{MICRO}m", rows, width=WIDE)


def _table(found: ThesisDiagnosis) -> Table:
    heads = (
        "Test",
        "Measured",
        "Thesis' simulation",
        "Own joint alone",
        "All joints",
        "Extended",
        "Held out",
        "What was left out",
    )
    return Table(heads, [_cells(row) for row in found.rows])


def _cells(row: ThesisRow) -> list[str]:
    off = 100.0 * abs(row.simulated / row.measured - 1.0)
    return [
        str(row.joint),
        micrometres(row.measured),
        f"{micrometres(row.simulated)}, off by {off:.0f} %",
        micrometres(row.own_joint),
        micrometres(row.all_joints),
        micrometres(row.extended),
        "cannot be held out" if np.isnan(row.held_out) else micrometres(row.held_out),
        row.left_out,
    ]


def _closed(gap: PreloadReading) -> float:
    """Spring of joint 1 if table 4.3 is read as a gap [N m / rad]."""
    return gap.torque / (gap.torque / gap.stiffness_if_friction - gap.gap)


def _angles(gap: PreloadReading) -> str:
    """The two readings over the torque: one load tells one point of each line."""
    torque = np.array([0.0, 2.0 * gap.torque])
    point = np.array([gap.torque])
    opened, spring = m_to_um(gap.torque / gap.stiffness_if_friction), _closed(gap)
    closed = opened - m_to_um(gap.gap)
    held = np.array([gap.friction, 2.0 * gap.torque])
    return scatter(
        "what either reading says of other loads",
        "torque [N m]",
        f"angle of joint 1 [{MICRO}rad]",
        [
            Curve("not pre-loaded", RED, point, np.array([opened])),
            Curve("pre-loaded", BLUE, point, np.array([closed])),
        ],
        [
            Curve(
                "not pre-loaded",
                RED,
                torque[1:] * [0.02, 1.0],
                m_to_um(torque[1:] * [0.02, 1.0] / spring + gap.gap),
            ),
            Curve("pre-loaded", BLUE, torque, m_to_um(torque / spring)),
            Curve("friction", GREY, torque, m_to_um(torque / gap.stiffness_if_friction)),
            Curve("friction", GREY, held, m_to_um((held - gap.friction) / gap.stiffness_if_friction)),
        ],
        width=WIDE,
    )


def _readings(gap: PreloadReading) -> str:
    low, high = (m_to_um(v) for v in gap.gap_ci95)
    return (
        f"As a gap that pre-loading closes: {with_deviation([gap.gap], [gap.gap_std], 'rad')}, 95 % "
        f"interval {low:.0f} to {high:.0f} {MICRO}rad because there are only {sum(gap.readings)} readings. As friction "
        f"that carries load when pre-loaded: {with_deviation([gap.friction], [gap.friction_std], 'N m')} in "
        f"a joint of {gap.stiffness_if_friction / MILLION:.2f} × 10⁶ N m / rad. One load cannot tell."
    )
