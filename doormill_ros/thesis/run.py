"""Runs the diagnosis of the thesis' own loading tests and writes its files."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from doormill_ros.diagnosis.loading.document import MODEL_FILE, write_diagnosis
from doormill_ros.robot_model.extended_model import SizedCause, model_document
from doormill_ros.thesis.diagnosis import (
    PreloadReading,
    ThesisDiagnosis,
    diagnose_thesis,
    read_preload_test,
)
from doormill_ros.thesis.loading_tests import load_thesis_data
from doormill_ros.thesis.page import render_thesis_report
from doormill_ros.thesis.recovery import recover

SCHEMA = "doormill/thesis-diagnosis/1"


def run_thesis(out: Path) -> str:
    """Question tables 4.2 and 4.3, write diagnosis.json, model.yaml and report.html.

    Returns:
        The verdict in one line.
    """
    data = load_thesis_data()
    found, gap = diagnose_thesis(data), read_preload_test(data)
    cause = SizedCause(found.cause, np.array([found.value]))
    model = model_document(
        data.robot.name,
        recover(data).stiffness,
        [cause],
        "the thesis' loading tests, verdict partly_explained",
    )
    write_diagnosis(out, _document(found, gap), model, render_thesis_report(found, gap))
    return (
        f"partly_explained: {found.cause!r}, {found.value:.3g} +- {found.std:.2g} {found.cause.parameters[0].unit}; "
        f"squared deviations of tests 1 to 5 {found.misfit[0]:.0f} -> {found.misfit[1]:.1f}"
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
                "parameters": {
                    found.cause.parameters[0].name: {
                        "value": found.value,
                        "std": found.std,
                        "unit": found.cause.parameters[0].unit,
                    }
                },
                "confusable_with": [{"cause": c.name, "where": c.where} for c in found.confusable],
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
        "extended_model": MODEL_FILE,
    }
