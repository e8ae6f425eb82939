"""Runs the diagnosis of the thesis' own loading tests and writes its files."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from doormill_ros.diagnosis.core.telling.document import write_diagnosis
from doormill_ros.diagnosis.core.words.margin import Margin
from doormill_ros.robot_model.extended_document import model_document
from doormill_ros.robot_model.model_file import MODEL_FILE
from doormill_ros.thesis.diagnosis import AS_GOOD, ThesisCandidate, ThesisDiagnosis, diagnose_thesis
from doormill_ros.thesis.loading_tests import load_thesis_data
from doormill_ros.thesis.page import render_thesis_report
from doormill_ros.thesis.preload import PreloadReading, read_preload_test
from doormill_ros.thesis.recovery import recover
from doormill_ros.thesis.wording import candidates_sentence, joint_3_sentence

SCHEMA = "doormill/thesis-diagnosis/1"


def run_thesis(out: Path) -> str:
    """Question tables 4.2 and 4.3, write diagnosis.json, model.yaml and report.html.

    Returns:
        The verdict in one line.
    """
    data = load_thesis_data()
    found, gap = diagnose_thesis(data), read_preload_test(data)
    model = model_document(
        data.robot.name,
        recover(data).stiffness,
        [],
        "the thesis' loading tests, verdict partly_explained",
        found.unchanged,
    )
    write_diagnosis(out, _document(found, gap), model, render_thesis_report(found, gap))
    names = " or ".join(f"{c.cause!r} ({c.value:.3g} {c.cause.parameters[0].unit})" for c in found.candidates)
    return (
        f"partly_explained: {names}; squared deviations of tests 1 to 5 {found.before:.0f} -> {found.misfit[1]:.1f} to "
        f"{found.candidates[-1].misfit:.1f}, which five lengths cannot decide"
    )


def _document(found: ThesisDiagnosis, gap: PreloadReading) -> dict[str, Any]:
    lengths = ("measured", "simulated", "own_joint", "all_joints", "extended", "held_out")
    return {
        "schema": SCHEMA,
        "verdict": "partly_explained",
        "causes": [
            {
                "cause": found.cause.name,
                "where": found.cause.where,
                "parameters": _parameters(found.candidates[0]),
                "confusable_with": [
                    {
                        "cause": c.cause.name,
                        "where": c.cause.where,
                        "parameters": _parameters(c),
                        "score_difference": c.misfit - found.misfit[1],
                    }
                    for c in found.candidates[1:]
                ],
            }
        ],
        "misfit": {"before": found.misfit[0], "after": found.misfit[1]},
        "table_4_2": [
            {
                "joint": row.joint,
                **{n: None if np.isnan(v := float(getattr(row, n))) else v for n in lengths},
                "left_out": row.left_out,
            }
            for row in found.rows
        ],
        "test_6_range": list(found.test_6_range),
        "table_4_3": {
            "torque": gap.torque,
            "gap": {"value": gap.gap, "std": gap.gap_std, "ci95": list(gap.gap_ci95), "unit": "rad"},
            "friction": {"value": gap.friction, "std": gap.friction_std, "unit": "N m"},
            "stiffness_if_friction": gap.stiffness_if_friction,
        },
        "joint_3_over_joint_1": {
            "test 3": found.joint_3[0],
            "test 3, load straight down on joints 2 and 3": found.joint_3_plain,
            "tests 3 and 5": found.joint_3[1],
        },
        "remarks": [candidates_sentence(found), joint_3_sentence(found)],
        "extended_model": MODEL_FILE,
        "model_unchanged": found.unchanged,
        "margins": [
            Margin(
                "a further candidate does as well", found.next_misfit - found.misfit[1], AS_GOOD, "score"
            ).document()
        ],
    }


def _parameters(candidate: ThesisCandidate) -> dict[str, Any]:
    parameter = candidate.cause.parameters[0]
    return {parameter.name: {"value": candidate.value, "std": candidate.std, "unit": parameter.unit}}
