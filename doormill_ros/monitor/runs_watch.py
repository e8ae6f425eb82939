"""Follows the bags of a cell's runs: has the last ones questioned every few runs, and keeps what follows."""

from __future__ import annotations

import logging
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from doormill_ros.diagnosis.runs.limits import FEWEST
from doormill_ros.errors import DoormillError, unexpected
from doormill_ros.monitor.errors import RunsQuestionError
from doormill_ros.monitor.question import DiagnosisAnswer
from doormill_ros.monitor.questioner import Questioner
from doormill_ros.monitor.recorded_runs import RecordedRuns
from doormill_ros.monitor.runs_finding import RunsFinding, few_runs, runs_finding
from doormill_ros.monitor.runs_question import RunsQuestion
from doormill_ros.monitor.watch_state import WatchSettings
from doormill_ros.recording.bag_folders import newest_bags, size_of_bag
from doormill_ros.recording.bag_reader import is_broken_off
from doormill_ros.recording.errors import BagError

EVERY = 3  #: ended runs from one question to the next
LONGEST = 600.0  #: s, after which fewer are asked about, too
LOOK = 10.0  # s, between two looks for bags
STOP_LIMIT = 5.0  # s
_LOG = logging.getLogger(__name__)


@dataclass(frozen=True)
class RunsState:
    """What is known at one moment.

    Attributes:
        finding: What the runs say; None before the first answer, or where nobody asks.
        since: The first run that counts; empty: all do.
        asking: A newer verdict is on its way.
        error_code, message: What is wrong; 0 and empty when nothing is.
    """

    finding: RunsFinding | None = None
    since: str = ""
    asking: bool = False
    error_code: int = 0
    message: str = ""


class RunsWatch:
    """What a cell's monitor does with bags alone, without ROS; called from any thread.

    Args:
        bags: Folder below which runs are recorded.
        settings: What to go by now.
        questioner: Asks the bags; whoever made it starts it after the watch, and stops it before.
        changed: Called after every change of the state, from any thread.
        look: Between two looks for bags [s].
    """

    def __init__(
        self,
        bags: Path,
        settings: Callable[[], WatchSettings],
        questioner: Questioner,
        changed: Callable[[], None],
        look: float = LOOK,
    ) -> None:
        self._bags, self._settings, self._changed, self._period = bags, settings, changed, look
        self._recorded = RecordedRuns(bags)
        self._questioner = questioner
        questioner.tell(RunsQuestion, self._take, self._rest)
        self._ended_runs: set[str] = set()  # since the last question
        self._closed: set[Path] = set()  # bags that get nothing more
        self._new = 0  # of them, since the last question
        self._by: tuple[int, str] | None = None  # what the last question went by
        self._asked_at = float("-inf")
        self._finding: RunsFinding | None = None
        self._trouble: DoormillError | None = None
        self._wake = threading.Event()
        self._no_more, self._nothing_left = threading.Event(), threading.Event()
        self._stopped = False
        self._thread = threading.Thread(target=self._run, name="runs", daemon=True)

    def start(self) -> None:
        """Begin with what was answered before."""
        last = self._questioner.last(RunsQuestion)
        settings = self._settings()
        if last is not None and settings.runs and last.asked["since"] == settings.since:
            self._conclude(last)
            if self._trouble is None and last.asked == self._question().asked:
                self._note_asked(settings)
                self._closed = self._newly_closed()
            self._trouble = None  # an answer of no use is asked for anew
        self._thread.start()

    def stop(self) -> None:
        """Look for nothing more."""
        self._stopped = True
        self._wake.set()
        if self._thread.is_alive():
            self._thread.join(STOP_LIMIT)

    def state(self) -> RunsState:
        """What is known now."""
        trouble = self._trouble
        return RunsState(
            self._finding,
            self._settings().since,
            self._questioner.asking(RunsQuestion),
            0 if trouble is None else trouble.code,
            "" if trouble is None else trouble.message,
        )

    def ended(self, run_id: str) -> None:
        """A run ended; its bag may be closed much later."""
        self._ended_runs.add(run_id)

    def settle(self) -> None:
        """Go by the settings as they are now."""
        self._wake.set()

    def at_end(self, limit: float) -> RunsState:
        """What all runs say once no more come, however few came since the last question; or after so long [s]."""
        self._no_more.set()
        self._wake.set()
        self._nothing_left.wait(limit)
        return self.state()

    def _run(self) -> None:
        while not self._stopped:
            no_more = self._no_more.is_set()
            try:
                self._look()
            except Exception as error:  # whatever it is, the runs after it are asked
                self._take_trouble(error)
                self._changed()
            if no_more and not self._questioner.asking(RunsQuestion):
                self._nothing_left.set()
            self._wake.wait(self._period)
            self._wake.clear()

    def _look(self) -> None:
        """Ask, where enough has ended since the last question and none is in hand."""
        settings = self._settings()
        if not settings.runs:
            self._forget()
            return
        if self._questioner.asking(RunsQuestion):
            return  # what ends meanwhile is asked together afterwards
        closed = self._newly_closed()
        self._closed |= closed
        self._new += len(closed)
        if not self._is_due(settings):
            return
        self._note_asked(settings)
        count = self._recorded.count(settings.since, FEWEST)
        if count < FEWEST:
            self._finding, self._trouble = few_runs(count), None
        else:
            self._questioner.ask(self._question())
        self._changed()

    def _is_due(self, settings: WatchSettings) -> bool:
        if self._by != (settings.runs, settings.since):
            return True
        few = self._finding is None or self._finding.questioned < FEWEST
        waited = self._no_more.is_set() or time.monotonic() - self._asked_at > LONGEST
        return max(self._new, len(self._ended_runs)) >= (1 if few or waited else EVERY)

    def _note_asked(self, settings: WatchSettings) -> None:
        by = settings.runs, settings.since
        if self._by is not None and self._by[1] != by[1]:
            self._finding = None  # of runs that no longer count
        self._by, self._asked_at, self._new = by, time.monotonic(), 0
        self._ended_runs.clear()

    def _forget(self) -> None:
        known = self._finding is not None or self._trouble is not None
        self._finding = self._trouble = self._by = None
        if known:
            self._changed()

    def _newly_closed(self) -> set[Path]:
        """Bags that were closed since the last look."""
        found = set()
        for bag in newest_bags(self._bags):
            try:
                if bag not in self._closed and not is_broken_off(bag):
                    found.add(bag)
            except BagError:
                continue  # it is named when it is asked
        return found

    def _question(self) -> RunsQuestion:
        settings = self._settings()
        count = max(settings.runs, FEWEST)
        bags = []
        for bag in newest_bags(self._bags)[:count]:
            try:
                size = size_of_bag(bag)
            except OSError:
                continue  # removed at this moment
            bags.append((str(bag.relative_to(self._bags)), size))
        return RunsQuestion(self._bags, count, settings.since, tuple(bags))

    def _take(self, answer: DiagnosisAnswer) -> None:
        try:
            self._conclude(answer)
        except Exception as error:  # whatever it is, the questions after it are asked
            self._take_trouble(error)

    def _rest(self) -> None:
        self._changed()
        self._wake.set()

    def _conclude(self, answer: DiagnosisAnswer) -> None:
        """Make a finding of an answer, unless it is of runs that no longer count."""
        if answer.document is None:
            self._trouble = RunsQuestionError(
                f"{answer.failure}; the bags are asked again after the next runs"
            )
            return
        try:
            found = runs_finding(answer.document)
        except (KeyError, TypeError, ValueError) as error:
            self._trouble = RunsQuestionError(
                f"the diagnosis left what nobody can read: {error!r}; it is asked anew"
            )
            return
        settings = self._settings()
        if settings.runs and answer.asked["since"] == settings.since:
            self._finding, self._trouble = found, None

    def _take_trouble(self, error: Exception) -> None:
        _LOG.error("bags of runs", exc_info=error)
        self._trouble = RunsQuestionError(f"{unexpected(error)}; see the log, the bags are asked again")
