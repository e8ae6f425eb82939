"""What a diagnosis has to tell, the same for every kind of data; document, page and line are made of it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from doormill_ros.diagnosis.core.diagnosis import Diagnosis
from doormill_ros.diagnosis.core.examining.examination import Double
from doormill_ros.diagnosis.core.examining.finding import Finding
from doormill_ros.diagnosis.core.judgement import Judgement
from doormill_ros.diagnosis.core.telling.candidates import candidates_table
from doormill_ros.diagnosis.core.words.margin import Margin
from doormill_ros.diagnosis.core.words.verdict import CONSISTENT, UNEXPLAINED
from doormill_ros.diagnosis.core.words.wording import Unit, Words, spoken, spoken_findings
from doormill_ros.pages.page import Block, PageSection
from doormill_ros.robot_model.candidate import Cause


@dataclass(frozen=True, eq=False)
class NamedCause:
    """An established cause as it is told.

    Attributes:
        cause, where: Name and place.
        words: The two in words.
        parameters: Value, standard deviation and unit by name; lists for vectors.
        without: Held-out RMSE of the extended model less this cause.
        doubles: What would do as well.
        more: What else the kind of data says of a cause, for diagnosis.json.
    """

    cause: str
    where: str
    words: str
    parameters: Mapping[str, Mapping[str, Any]]
    without: float
    doubles: Sequence[Double[Any, Any]] = ()
    more: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class Account:
    """What a diagnosis has to tell.

    Attributes:
        words: What the kind of data calls things.
        unit: Of all residuals.
        verdict: consistent, explained, partly_explained or unexplained.
        noise_floor: What noise alone leaves.
        baseline, extended: `train_rmse`, `holdout_rmse` and whatever else the kind knows of the model in
            question and of the extended one.
        ratio, ratio_ci: Held-out RMSE extended over baseline, and its 95 % interval.
        rows: How many rows were measured.
        causes: What is established.
        listed: The causes as the line has them.
        headline: The causes as the head of the page has them.
        outliers: Rows that are gross errors.
        remarks: Sentences for the reader.
        margins: How far every decision was from its threshold.
        next_measurement: What to measure next, in a sentence.
        checks: What was said of sets that were only predicted: `set`, `rows`, `rmse` of `baseline` and `extended`.
        sections: What else the kind writes into diagnosis.json.
        model: The content of model.yaml; None where nothing can use one.
        evidence, candidates, next_blocks, closing: What the kind shows on the page, see `report`.
        tiles: Figures beside those that every kind has.
    """

    words: Words
    unit: Unit
    verdict: str
    noise_floor: float
    baseline: Mapping[str, float]
    extended: Mapping[str, float]
    ratio: float
    ratio_ci: tuple[float, float]
    rows: int
    causes: Sequence[NamedCause]
    listed: str
    headline: str
    outliers: Sequence[int]
    remarks: Sequence[str]
    margins: Sequence[Margin]
    next_measurement: str
    checks: Sequence[Mapping[str, Any]] = ()
    sections: Mapping[str, Any] = field(default_factory=dict)
    model: Mapping[str, Any] | None = None
    evidence: Sequence[PageSection] = ()
    candidates: Sequence[Block] = ()
    next_blocks: Sequence[Block] = ()
    closing: Sequence[PageSection] = ()
    tiles: Sequence[tuple[str, str]] = ()


def told(
    judgement: Judgement[Any, Any],
    words: Words,
    unit: Unit,
    noise_floor: float,
    causes: Sequence[NamedCause],
    **more: Any,
) -> Account:
    """What every judgement has to tell, its causes listed by their names.

    Args:
        judgement: What was found.
        words: What the kind calls things.
        unit: Of all residuals.
        noise_floor: What noise alone leaves.
        causes: What is established.
        more: What only the kind knows, and what it tells in another way, as in `Account`.
    """
    (before_train, after_train), (before, after) = judgement.train_rmse, judgement.holdout_rmse
    places: dict[str, list[str]] = {}
    for name, where in dict.fromkeys(cause.key for cause in judgement.examination.named):
        places.setdefault(name.replace("_", " "), []).append(where)
    common: dict[str, Any] = {
        "baseline": {"train_rmse": before_train, "holdout_rmse": before},
        "extended": {"train_rmse": after_train, "holdout_rmse": after},
        "listed": "; ".join(f"{name} ({', '.join(where)})" for name, where in places.items()),
        "headline": ", ".join([words.model.removeprefix("model of "), *places]),
    }
    return Account(
        words=words,
        unit=unit,
        verdict=judgement.verdict,
        noise_floor=noise_floor,
        ratio=judgement.ratio,
        ratio_ci=judgement.ratio_ci,
        margins=judgement.margins,
        causes=causes,
        **common | more,
    )


def account_of(
    diagnosis: Diagnosis[Any, Any],
    words: Words,
    next_measurement: str,
    checks: Sequence[Mapping[str, Any]] = (),
    name: Callable[[Cause], str] = repr,
    more: Callable[[Finding[Any]], Mapping[str, Any]] = lambda finding: {},
) -> Account:
    """What a search over causes found, ready to be told; the kind adds its own with `dataclasses.replace`.

    Args:
        diagnosis: What was found.
        words: What the kind calls things.
        next_measurement: What to measure next, in a sentence.
        checks: What was said of sets that were only predicted.
        name: A cause as the line has it.
        more: What else diagnosis.json says of a cause.
    """
    findings = [(finding.cause, *finding.tied) for finding in diagnosis.findings]
    return told(
        diagnosis,
        words,
        diagnosis.problem.unit,
        diagnosis.problem.noise_floor,
        [_named(finding, more(finding)) for finding in diagnosis.findings],
        rows=len(diagnosis.problem),
        listed=" and ".join(" or ".join(map(name, causes)) for causes in findings),
        headline=spoken_findings(findings),
        outliers=diagnosis.outliers,
        remarks=diagnosis.remarks,
        next_measurement=next_measurement,
        checks=checks,
        candidates=candidates_table(diagnosis, words),
        tiles=[(str(int(diagnosis.problem.configuration.max()) + 1), words.unseen)],
    )


def _named(finding: Finding[Any], more: Mapping[str, Any]) -> NamedCause:
    return NamedCause(
        cause=finding.cause.name,
        where=finding.cause.where,
        words=spoken(finding.cause),
        parameters=parameters_of(finding),
        without=finding.without,
        doubles=finding.equals,
        more=more,
    )


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


def verdict_line(account: Account) -> str:
    """The verdict and what it rests on, in one line."""
    unit, words, verdict = account.unit, account.words, account.verdict
    before, after, noise = (
        unit.figure(value)
        for value in (account.baseline["holdout_rmse"], account.extended["holdout_rmse"], account.noise_floor)
    )
    if verdict == CONSISTENT:
        if unit.relative:
            return f"{verdict}: the {words.residual} is {before} {unit.told}"
        told = f"{words.noise_alone} ({noise} {unit.told})"
        return f"{verdict}: the {words.residual} of {before} {unit.told} is the {told}"
    against = "" if unit.relative else f" against {noise} {unit.told} of {words.noise}"
    if verdict == UNEXPLAINED:
        return f"{verdict}: {before} {unit.told}{against}, and no known cause earns its place"
    floor = "" if unit.relative else f", {words.noise} {noise} {unit.told}"
    return f"{verdict}: {account.listed}; held-out {words.held_out} {before} -> {after} {unit.told}{floor}"
