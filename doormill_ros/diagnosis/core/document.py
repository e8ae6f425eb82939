"""Writes a diagnosis: diagnosis.json, model.yaml and report.html, all or none."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import yaml

from doormill_ros.diagnosis.core.diagnosis import Diagnosis
from doormill_ros.diagnosis.core.finding import Finding
from doormill_ros.diagnosis.core.ranking import QUANTUM
from doormill_ros.files import write_atomically

SCHEMA = "doormill/diagnosis/1"
MODEL_FILE = "model.yaml"


def diagnosis_document(diagnosis: Diagnosis[Any, Any], next_measurement: str, **more: Any) -> dict[str, Any]:
    """The content of diagnosis.json."""
    return {
        "schema": SCHEMA,
        "verdict": diagnosis.verdict,
        "noise_floor": diagnosis.problem.noise_floor,
        "baseline": {"train_rmse": diagnosis.train_rmse[0], "holdout_rmse": diagnosis.holdout_rmse[0]},
        "extended": {"train_rmse": diagnosis.train_rmse[1], "holdout_rmse": diagnosis.holdout_rmse[1]},
        "gain": {"holdout_rmse_ratio": diagnosis.ratio, "ci95": list(diagnosis.ratio_ci)},
        "causes": [_cause(finding) for finding in diagnosis.findings],
        "outliers": list(diagnosis.outliers),
        "next_measurement": next_measurement,
        "extended_model": MODEL_FILE,
        "remarks": list(diagnosis.remarks),
        **more,
    }


def _cause(finding: Finding[Any]) -> dict[str, Any]:
    return {
        "cause": finding.cause.name,
        "where": finding.cause.where,
        "parameters": parameters_of(finding),
        "holdout_rmse_without": finding.without,
        "confusable_with": [{"cause": c.name, "where": c.where} for c in finding.confusable],
        **({"tied_with": _tied(finding)} if finding.tied else {}),
    }


def _tied(finding: Finding[Any]) -> list[dict[str, Any]]:
    """What differs in score by less than counts, with the difference in whole quanta of a score."""
    return [
        {
            "cause": equal.cause.name,
            "where": equal.cause.where,
            "score_difference": QUANTUM * round(equal.behind / QUANTUM),
        }
        for equal in finding.equals
        if equal.tied
    ]


def parameters_of(finding: Finding[Any]) -> dict[str, dict[str, Any]]:
    """Value, standard deviation and unit by name; lists for vectors."""
    named: dict[str, dict[str, Any]] = {}
    at = 0
    for parameter in finding.cause.parameters:
        value = [float(v) for v in finding.values[at : at + parameter.size]]
        std = [float(v) for v in finding.std[at : at + parameter.size]]
        at += parameter.size
        single = parameter.size == 1
        named[parameter.name] = {
            "value": value[0] if single else value,
            "std": std[0] if single else std,
            "unit": parameter.unit,
        }
    return named


def write_diagnosis(out: Path, document: dict[str, Any], model: dict[str, Any], report: str) -> None:
    """Write the three files; each appears complete or not at all."""
    out.mkdir(parents=True, exist_ok=True)
    contents = {
        MODEL_FILE: yaml.safe_dump(model, sort_keys=False),
        "report.html": report,
        "diagnosis.json": json.dumps(document, indent=2, allow_nan=False) + "\n",
    }
    for name, text in contents.items():
        write_atomically(out / name, text)
