"""Finds runs among all that are kept."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from doormill_ros.operator.history.history import Kept
from doormill_ros.operator.languages import Language, headline_in, outcome_in
from doormill_ros.operator.views.ended_run import EndedRun


@dataclass(frozen=True)
class Found:
    """What a search gave.

    Attributes:
        runs: Those found, the newest first.
        kept: How many were looked at.
        whole: These are all that are kept; else the oldest are missing.
    """

    runs: tuple[EndedRun, ...]
    kept: int
    whole: bool


def search_history(shown: Iterable[EndedRun], kept: Kept, search: str, language: Language) -> Found:
    """The runs in which every word of a search occurs, whatever the case.

    Args:
        shown: Runs that the page shows, whether they are kept or not.
        kept: Runs of the history's folder.
        search: Words divided by blanks, each a part of door id, result, error code, its headline or message; none:
            every run.
        language: Of result and headline.
    """
    words = search.casefold().split()
    runs = {run.run_id: run for run in (*shown, *kept.runs)}
    found = [run for run in runs.values() if not words or _has(run, words, language)]
    return Found(tuple(sorted(found, key=lambda run: run.ended, reverse=True)), len(runs), kept.whole)


def _has(run: EndedRun, words: list[str], language: Language) -> bool:
    # A line each, so that no word reaches from one into the next.
    headline = headline_in(language, run.error_code)
    parts = (run.door_id, outcome_in(language, run), str(run.error_code), headline, run.message)
    text = "\n".join(parts).casefold()
    return all(word in text for word in words)
