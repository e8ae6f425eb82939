"""Everything that can be said about the thesis' own six tests, as one outcome."""

from __future__ import annotations

from typing import Any

from doormill_ros.arrays import FloatArray
from doormill_ros.identification.outcome import Outcome
from doormill_ros.robot.kinematics import Kinematics
from doormill_ros.thesis import printed_displacements, printed_methods
from doormill_ros.thesis.comparison import TestComparison, compare_with_simulation
from doormill_ros.thesis.contradiction import Contradiction, Evidence
from doormill_ros.thesis.fit import FIGURES, ThesisFit, fit_thesis, overall_std
from doormill_ros.thesis.loading_tests import ThesisData
from doormill_ros.thesis.recovery import Recovery, recover, repeatability
from doormill_ros.units import m_to_um

SOURCE = (
    "thesis; joint 1 from A.8, joint 2 from A.9, joints 3 to 6 from the ratios of table 4.1; deviations from "
    "repeated tests and from fitting all joints at once"
)


def find_contradictions(data: ThesisData, recovery: Recovery) -> list[Contradiction]:
    """Prove every contradiction from the printed figures."""
    evidence = Evidence(data, recovery, Kinematics(data.robot))
    return [rule(evidence) for rule in (*printed_displacements.RULES, *printed_methods.RULES)]


def outcome_of_thesis(data: ThesisData) -> Outcome:
    """Recover, fit, compare and collect contradictions."""
    recovery = recover(data)
    fit = fit_thesis(data)
    std = overall_std(recovery, fit)
    sides = {side: compare_with_simulation(data, recovery, std, side) for side in (1, -1)}
    contradictions = find_contradictions(data, recovery)
    lines = [*_stiffness_lines(data, recovery, fit, std), "", *_comparison_lines(sides), ""]
    lines.append("printed figures that contradict each other:")
    lines += map(str, contradictions)
    document = {
        "one_by_one": {
            "stiffness": recovery.stiffness,
            "printing_std": recovery.printing_std,
            "equations": recovery.equations,
            "ratio_2_to_1": recovery.ratio_2_to_1,
            "ratio_2_to_1_printed": data.ratios[1],
            "stiffness_4_from_rotation": recovery.stiffness_4_from_rotation,
            "load_4_implied": recovery.load_4_implied,
        },
        "all_at_once": {
            "stiffness": fit.stiffness,
            "std": fit.std,
            "std_of_repetition": fit.std_of_repetition,
            "chi_square": fit.chi_square,
            "degrees_of_freedom": fit.degrees_of_freedom,
            "figures": [
                {"figure": name, "printed": p, "fitted": f, "std": s}
                for name, p, f, s in zip(FIGURES, fit.target, fit.fitted, fit.sigma, strict=True)
            ],
        },
        "simulation_against_measurement": [_row(row) for row in sides[1]],
        "test_6_with_the_reflector_on_the_other_side": _row(sides[-1][5]),
        "contradictions": [vars(c) for c in contradictions],
    }
    return Outcome(data.robot, SOURCE, recovery.stiffness, std, lines, document)


def _stiffness_lines(data: ThesisData, recovery: Recovery, fit: ThesisFit, std: FloatArray) -> list[str]:
    lines = [
        "stiffness in N m/rad: as the thesis found it (deviation from rounding), all joints at once, overall deviation",
        "joint  equation        one by one             all at once             overall",
    ]
    for j in range(6):
        lines.append(
            f"{j + 1:>5}  {recovery.equations[j]:14} {recovery.stiffness[j]:10.4g} +- {recovery.printing_std[j]:<8.2g} "
            f"{fit.stiffness[j]:10.4g} +- {fit.std[j]:<8.2g} {std[j] / recovery.stiffness[j]:6.1%}"
        )
    lines += [
        f"K2/K1 {recovery.ratio_2_to_1:.4f} +- {recovery.ratio_2_to_1_std:.4f}, table 4.1 prints {data.ratios[1]}; "
        f"K4 from table 4.2 alone {recovery.stiffness_4_from_rotation:.4g}",
        f"a repeated test scatters by {m_to_um(repeatability(data)):.1f} um (table 4.3); chi-square of the nine "
        f"printed figures {fit.chi_square:.0f} with {fit.degrees_of_freedom} degrees of freedom",
    ]
    return lines


def _comparison_lines(sides: dict[int, list[TestComparison]]) -> list[str]:
    lines = [
        "displacements in um: the thesis' two columns; ours with the joint under test alone and with every joint; the "
        "joints that come nearest to the thesis' simulation",
        "test  measured simulated   own joint  all joints          nearest",
    ]
    for side, rows in sides.items():
        for row in rows if side > 0 else rows[5:]:
            nearest = "+".join(map(str, row.nearest_joints))
            lines.append(
                f"{row.joint:>4} {m_to_um(row.measured):9.1f} {m_to_um(row.simulated):9.1f} "
                f"{m_to_um(row.own_joint):11.1f} {m_to_um(row.predicted):9.1f} +- {m_to_um(row.predicted_std):<6.1f} "
                f"{m_to_um(row.nearest):7.1f} "
                f"(joint {nearest})" + ("" if side > 0 else "   reflector on the side away from the load")
            )
    return lines


def _row(row: TestComparison) -> dict[str, Any]:
    return {
        "test": row.joint,
        "measured": row.measured,
        "simulated": row.simulated,
        "simulated_components": row.simulated_components,
        "predicted": row.predicted,
        "predicted_std": row.predicted_std,
        "predicted_vector": row.predicted_vector,
        "own_joint": row.own_joint,
        "by_joint": row.by_joint,
        "nearest_joints": row.nearest_joints,
        "nearest": row.nearest,
        "cause": row.cause,
    }
