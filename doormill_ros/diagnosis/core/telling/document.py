"""Writes a diagnosis: diagnosis.json, report.html and, where something can use it, model.yaml."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import yaml

from doormill_ros.diagnosis.core.telling.account import Account, NamedCause
from doormill_ros.files import write_together
from doormill_ros.robot_model.candidate import Cause
from doormill_ros.robot_model.model_file import MODEL_FILE

SCHEMA = "doormill/diagnosis/1"


def diagnosis_document(account: Account) -> dict[str, Any]:
    """The content of diagnosis.json."""
    return {
        "schema": SCHEMA,
        "verdict": account.verdict,
        "unit": account.unit.symbol,
        "noise_floor": account.noise_floor,
        "baseline": dict(account.baseline),
        "extended": dict(account.extended),
        "gain": {"holdout_rmse_ratio": account.ratio, "ci95": list(account.ratio_ci)},
        "causes": [cause_entry(cause) for cause in account.causes],
        "outliers": list(account.outliers),
        "next_measurement": account.next_measurement,
        **({} if account.model is None else {"extended_model": MODEL_FILE}),
        "remarks": list(account.remarks),
        **account.sections,
        "checks": list(account.checks),
        "margins": [margin.document() for margin in account.margins],
    }


def cause_entry(named: NamedCause) -> dict[str, Any]:
    """One of the `causes` of diagnosis.json."""
    tied = [
        {"cause": double.cause.name, "where": double.cause.where, "score_difference": double.behind}
        for double in named.doubles
        if double.tied
    ]
    return {
        "cause": named.cause,
        "where": named.where,
        "parameters": dict(named.parameters),
        "holdout_rmse_without": named.without,
        "confusable_with": [_confusable(named, one.cause) for one in named.doubles],
        **({"tied_with": tied} if tied else {}),
        **named.more,
    }


def _confusable(named: NamedCause, other: Cause) -> dict[str, str]:
    """Another cause, or another reading of the same one with what tells them apart."""
    found = {"cause": other.name, "where": other.where}
    same = (named.cause, named.where) == other.key
    return found | ({"variant": other.variant} if same and other.variant else {})


def write_diagnosis(
    out: Path, document: Mapping[str, Any], model: Mapping[str, Any] | None, report: str
) -> None:
    """Write the files, diagnosis.json last; no model of an earlier question stays beside them.

    Raises:
        OSError: There is no room for all of them, or one cannot be written; an earlier diagnosis stays.
    """
    out.mkdir(parents=True, exist_ok=True)
    contents = {
        out / "report.html": report,
        out / "diagnosis.json": json.dumps(document, indent=2, allow_nan=False) + "\n",
    }
    stored = out / MODEL_FILE
    if model is None:
        write_together(contents, gone=[stored])
    else:
        write_together({stored: yaml.safe_dump(dict(model), sort_keys=False)} | contents)
