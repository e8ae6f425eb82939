"""A kind of data: how its sets are read, questioned, predicted and told; and the one course that all kinds take."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, ClassVar, Generic, TypeVar

import numpy as np

from doormill_ros.diagnosis.core.diagnosis import Diagnosis, P, diagnose_problem
from doormill_ros.diagnosis.core.fitting.problem import C
from doormill_ros.diagnosis.core.telling.account import Account, account_of, verdict_line
from doormill_ros.diagnosis.core.telling.document import diagnosis_document, write_diagnosis
from doormill_ros.diagnosis.core.telling.report import render_report
from doormill_ros.diagnosis.core.words.verdict import rmse
from doormill_ros.diagnosis.core.words.wording import Words

#: A set as it was read, and what a diagnosis of several knows.
S = TypeVar("S")
D = TypeVar("D")
#: Told of every step.
Progress = Callable[[str], None]


class Kind(ABC, Generic[S, D]):
    """One kind of data; `kinds` lists it by the schema of its sets."""

    @abstractmethod
    def read(self, folder: Path, progress: Progress) -> Sequence[S]:
        """The sets in a folder, mostly one.

        Raises:
            DataSetError: One cannot be read.
        """

    @abstractmethod
    def check_together(self, sets: Sequence[S], others: Sequence[S]) -> None:
        """Sets to diagnose and others to predict have to question one model.

        Raises:
            DataSetError: They do not.
        """

    @abstractmethod
    def diagnose(self, sets: Sequence[S], progress: Progress) -> D:
        """Question the model with all sets together."""

    @abstractmethod
    def check(self, diagnosis: D, other: S) -> dict[str, Any]:
        """Predict a set that no fit has seen: `set`, `rows`, and `rmse` of `baseline` and `extended`."""

    def check_all(self, diagnosis: D, others: Sequence[S]) -> list[dict[str, Any]]:
        """Predict several, each for itself unless they have something in common."""
        return [self.check(diagnosis, other) for other in others]

    @abstractmethod
    def account(
        self, diagnosis: D, sets: Sequence[S], checks: Sequence[Mapping[str, Any]], progress: Progress
    ) -> Account:
        """What was found, ready to be told."""


class SearchedKind(Kind[S, Diagnosis[P, C]], Generic[S, P, C]):
    """A kind whose residual is questioned by the core's search: it says what its problem is, the rest is common.

    Attributes:
        words: What it calls things.
        next_measurement: What to measure next, where that does not hang on what was found.
    """

    words: ClassVar[Words]
    next_measurement: ClassVar[str] = ""

    @abstractmethod
    def problem(self, sets: Sequence[S]) -> P:
        """All sets made ready for fitting."""

    @abstractmethod
    def name(self, one: S) -> str:
        """What a set is called."""

    def seen_alike(self, problem: P, diagnosed: P) -> P:
        """The problem, predicted in the way in which the diagnosed one was in the end."""
        return problem

    def check_together(self, sets: Sequence[S], others: Sequence[S]) -> None:
        """Whatever can be read can be taken together."""

    def diagnose(self, sets: Sequence[S], progress: Progress) -> Diagnosis[P, C]:
        """Search, examine and weigh."""
        return diagnose_problem(self.problem(sets), progress)

    def check(self, diagnosis: Diagnosis[P, C], other: S) -> dict[str, Any]:
        """Predict by the model in question, by the extended one, and with laws where there are any."""
        problem = self.seen_alike(self.problem([other]), diagnosis.problem)
        extended, laws = diagnosis.extended, diagnosis.characterised
        everything = np.ones(len(problem), dtype=bool)

        def off(members: Sequence[C], theta: Any) -> float:
            white = problem.predict(members, theta).white
            return rmse(problem.measured_part(white), everything, problem.components)

        return {
            "set": self.name(other),
            "rows": len(problem),
            "baseline": {"rmse": off((), np.zeros(0))},
            "extended": {"rmse": off(extended.members, extended.theta)},
            **({"characterised": {"rmse": off(laws.fit.members, laws.fit.theta)}} if laws else {}),
        }

    def account(
        self,
        diagnosis: Diagnosis[P, C],
        sets: Sequence[S],
        checks: Sequence[Mapping[str, Any]],
        progress: Progress,
    ) -> Account:
        """What every search tells; a kind with more to say extends it."""
        return account_of(diagnosis, self.words, self.next_measurement, checks)


def run(
    kind: Kind[S, D],
    data: Sequence[Path],
    check: Sequence[Path],
    out: Path,
    progress: Progress = lambda line: None,
) -> str:
    """Diagnose sets together, predict sets to check, write what was found.

    Args:
        kind: Of the data.
        data: Folders to diagnose.
        check: Folders to predict only.
        out: Folder for the results.
        progress: Told of every step.

    Returns:
        The verdict in one line.

    Raises:
        DataSetError: A set cannot be read or the sets do not belong together; nothing is written.
    """
    sets = [one for folder in data for one in kind.read(folder, progress)]
    others = [one for folder in check for one in kind.read(folder, progress)]
    kind.check_together(sets, others)
    diagnosis = kind.diagnose(sets, progress)
    if others:
        progress("predicting the sets to check")
    checks = kind.check_all(diagnosis, others)
    account = kind.account(diagnosis, sets, checks, progress)
    progress("writing the report")
    write_diagnosis(out, diagnosis_document(account), account.model, render_report(account))
    return verdict_line(account)
