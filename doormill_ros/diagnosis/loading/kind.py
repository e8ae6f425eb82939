"""Loading tests: displacements of a loaded robot question its joint springs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from doormill_ros.diagnosis.core.kind import Progress, SearchedKind
from doormill_ros.diagnosis.core.telling.account import Account, account_of
from doormill_ros.diagnosis.core.words.wording import Words
from doormill_ros.diagnosis.loading.evidence import evidence, next_trials_table
from doormill_ros.diagnosis.loading.laws import law_sections, sized_laws, with_laws
from doormill_ros.diagnosis.loading.next_measurement import NextMeasurement, plan_next
from doormill_ros.diagnosis.loading.path_shift import doubt, path_shift
from doormill_ros.diagnosis.loading.problem import FEWEST, LoadingDiagnosis, LoadingProblem
from doormill_ros.measurements.sets.join_sets import check_same_model, join_sets
from doormill_ros.measurements.sets.measurement_set import MeasurementSet, read_measurement_set
from doormill_ros.robot_model.elastic.causes.cause import ElasticCause
from doormill_ros.robot_model.extended_document import model_document
from doormill_ros.robot_model.extended_model import SizedCause

METHOD = """The simulation turns every joint by torque over stiffness. Its residuals are weighed by the noise of
tracker and force sensor in every trial. Every cause of the library, at every place, was fitted alone and in
combination, by least squares that gross errors cannot steer. Each model was scored on whole configurations left out
of its fit; a cause is named only if it improves that score by far more than chance could with so many candidates, if
shapes that belong to no known cause do not fit as well, and if it says the same in every part of the data. All
residuals called unseen or held-out are of trials that the fit had not seen. Where the direction of a last motion is
not recorded, whether a gap was open in a trial is read from that trial itself."""


class LoadingTests(SearchedKind[MeasurementSet, LoadingProblem, ElasticCause]):
    """Loading tests of one robot, taken together."""

    words = Words("simulation", "trials", method=METHOD)

    def read(self, folder: Path, progress: Progress) -> Sequence[MeasurementSet]:
        """The test in a folder."""
        return [read_measurement_set(folder)]

    def check_together(self, sets: Sequence[MeasurementSet], others: Sequence[MeasurementSet]) -> None:
        """One robot and one model; what is diagnosed together shares sensor and reflectors too."""
        joined = join_sets(sets)
        for other in others:
            check_same_model(joined, other)

    def problem(self, sets: Sequence[MeasurementSet]) -> LoadingProblem:
        """All trials of all tests."""
        return LoadingProblem(join_sets(sets))

    def seen_alike(self, problem: LoadingProblem, diagnosed: LoadingProblem) -> LoadingProblem:
        """With finite joint angles where the diagnosed tests needed them."""
        return problem.with_angles(diagnosed.finite)

    def name(self, one: MeasurementSet) -> str:
        """Its folder."""
        return one.path.name

    def diagnose(self, sets: Sequence[MeasurementSet], progress: Progress) -> LoadingDiagnosis:
        """With laws for what no cause names."""
        found = super().diagnose(sets, progress)
        if (count := len(found.problem)) < FEWEST:
            few = f"No cause is named of fewer than {FEWEST} trials, and there are {count}."
            return replace(found, remarks=(*found.remarks, few))
        return with_laws(found, progress)

    def account(
        self,
        diagnosis: LoadingDiagnosis,
        sets: Sequence[MeasurementSet],
        checks: Sequence[Mapping[str, Any]],
        progress: Progress,
    ) -> Account:
        """With the trials to measure next, and what the extended model changes on a part."""
        progress("choosing the next trials")
        plan = plan_next(diagnosis)
        progress("sending the extended model through the path generator")
        shift = path_shift(diagnosis)
        unchanged = doubt(diagnosis)
        sections: dict[str, Any] = {"next_trials": _trials(plan)}
        if shift is not None:
            sections["path_shift"] = {"door": shift.door, "largest": shift.largest, "unit": "m"}
        sections |= law_sections(diagnosis.characterised)
        if unchanged:
            diagnosis = replace(diagnosis, remarks=(*diagnosis.remarks, unchanged))
            sections["model_unchanged"] = unchanged
        return replace(
            account_of(diagnosis, self.words, plan.sentence, checks),
            sections=sections,
            model=extended_model_document(diagnosis, sets[0].path.name, unchanged),
            evidence=evidence(diagnosis, shift),
            next_blocks=next_trials_table(plan),
        )


def extended_model_document(diagnosis: LoadingDiagnosis, source: str, unchanged: str = "") -> dict[str, Any]:
    """The content of model.yaml; without any cause where there is a reason for that."""
    data = diagnosis.problem.data
    return model_document(
        data.robot,
        data.joint_stiffness,
        [] if unchanged else [SizedCause(finding.cause, finding.values) for finding in diagnosis.findings],
        f"diagnosis of {source}, verdict {diagnosis.verdict}",
        unchanged,
        [] if unchanged else sized_laws(diagnosis),
    )


def _trials(plan: NextMeasurement) -> list[dict[str, Any]]:
    return [
        {
            "q": trial.q.tolist(),
            "force": trial.force,
            "load_direction": f"base {trial.load}",
            "wrench": trial.wrench.tolist(),
            "last_motion": trial.direction,
            "reflector": trial.reflector,
            "expected_difference": trial.difference,
            "expected_log_odds": trial.information,
        }
        for trial in plan.trials
    ]
