"""Follows the inspected doors of a cell: keeps them, has them questioned, proposes models, stops milling at a limit."""

from __future__ import annotations

import logging
import threading
from collections import deque
from collections.abc import Callable
from pathlib import Path

from doormill_ros.catalogue.known_bags import known_bag
from doormill_ros.cell.output.inspection_files import DESCRIPTION
from doormill_ros.errors import DoormillError, unexpected
from doormill_ros.measurements.inspections.inspection import inspections_in
from doormill_ros.models.record import StoreRecord
from doormill_ros.models.store import ModelStore
from doormill_ros.monitor.complaint import complained_of
from doormill_ros.monitor.door_question import DoorQuestion, checksum
from doormill_ros.monitor.errors import KeepingError, QuestionError, UnknownRunError
from doormill_ros.monitor.finding import UNKNOWN, DoorFinding, finding_of
from doormill_ros.monitor.kept_doors import DoorPoints, KeptDoor, KeptDoors, points_of
from doormill_ros.monitor.question import DiagnosisAnswer
from doormill_ros.monitor.questioner import Questioner
from doormill_ros.monitor.recorded_runs import RecordedRuns
from doormill_ros.monitor.rehearsal import rehearse
from doormill_ros.monitor.stop import stop_sentence
from doormill_ros.monitor.watch_state import WatchSettings, WatchState

SHOWN = 100  # doors
PERIOD = 2.0  # s, between two looks for bags that inspections wait for
STOP_LIMIT = 5.0  # s
_LOG = logging.getLogger(__name__)


class ModelWatch:
    """Everything that a cell's monitor does with inspected doors, without ROS; called from any thread.

    Args:
        folder: For inspections.
        bags: Where runs are recorded.
        store: Of models.
        settings: What to go by now.
        questioner: Asks the doors; whoever made it starts it after the watch, and stops it before.
        changed: Called after every change of the state, from any thread.
        lies: Called with a run whose inspection came to `folder`, or lies elsewhere in it now; from any thread.
    """

    def __init__(
        self,
        folder: Path,
        bags: Path,
        store: Path,
        settings: Callable[[], WatchSettings],
        questioner: Questioner,
        changed: Callable[[], None],
        lies: Callable[[str], None] = lambda run_id: None,
    ) -> None:
        self._lies = lies
        self._kept = KeptDoors(folder, RecordedRuns(bags))
        self._store = ModelStore(store)
        self._settings = settings
        self._changed = changed
        self._questioner = questioner
        questioner.tell(DoorQuestion, self._take_verdict, changed)
        self._keeping, self._judging = threading.RLock(), threading.RLock()
        self._came: deque[DoorPoints] = deque()
        self._wake = threading.Event()
        self._ended = False
        self._thread = threading.Thread(target=self._take_in, name="inspections", daemon=True)
        self._finding: DoorFinding | None = None
        self._expected: dict[int, float] = {}  # error of the next door by version
        self._better = 0  # version of the last finding's model
        self._trouble: DoormillError | None = None

    def start(self) -> None:
        """Begin with what is kept and was answered before.

        Raises:
            ModelStoreError: The store cannot be read.
        """
        self._store.record()
        last = self._questioner.last(DoorQuestion)
        if last is not None:
            try:
                self._conclude(last)
            except QuestionError:
                last = None  # of other software, or damaged
        self._thread.start()
        if last is None or last.asked != self._question().asked:
            self._ask()

    def stop(self) -> None:
        """Take nothing more."""
        self._ended = True
        self._wake.set()
        if self._thread.is_alive():
            self._thread.join(STOP_LIMIT)

    def state(self) -> WatchState:
        """What is known now.

        Raises:
            ModelStoreError: The store cannot be read.
        """
        record, doors = self._store.record(), self._kept.doors()
        trouble = self._trouble
        stop = record.stop
        proposed = self._proposed(record)
        return WatchState(
            finding=self._finding,
            version=record.in_use,
            proposed=proposed,
            expected=self._expected.get(record.in_use, UNKNOWN),
            expected_proposed=self._expected.get(proposed, UNKNOWN) if proposed else UNKNOWN,
            limit=self._settings().limit,
            stopped=stop.message if stop is not None and stop.version == record.in_use else "",
            waiting=len(self._kept.waiting),
            asking=self._questioner.asking(DoorQuestion),
            error_code=0 if trouble is None else trouble.code,
            message="" if trouble is None else trouble.message,
            doors=tuple(doors[-SHOWN:]),
        )

    def take(self, points: DoorPoints) -> None:
        """Keep an inspection as soon as there is time; what is wrong with it becomes part of the state."""
        self._came.append(points)
        self._wake.set()

    def hand_in(self, path: Path, tell: Callable[[DoorPoints], None]) -> list[KeptDoor]:
        """Keep the inspection that a folder or its inspection.yaml is, or those in a folder.

        Args:
            path: Of the folder or the file.
            tell: Gets each that is kept or waits.

        Raises:
            DataSetError, InspectionMessageError: One cannot be read or kept; then none is.
            UnknownRunError: No bag holds the run of one of them; the others are kept, and it waits.
            KeepingError: One cannot be written; those before it are kept.
        """
        inspections = inspections_in(path.parent if path.name == DESCRIPTION else path, known_bag)
        handed = [(points_of(inspection), inspection.bag) for inspection in inspections]
        for points, _ in handed:
            rehearse(points)
        taken, unknown = [], None
        try:
            for points, bag in handed:
                try:
                    taken.append(self._keep(points, bag))
                except UnknownRunError as error:
                    unknown = error
                tell(points)
        finally:
            if taken:
                self._ask()
            self._changed()
        if unknown is not None:
            raise unknown
        return taken

    def accept(self, version: int, who: str, why: str) -> int:
        """As `ModelStore.accept`; the doors are questioned anew."""
        return self._order(lambda: self._store.accept(version, who, why))

    def revert(self, version: int, who: str, why: str) -> int:
        """As `ModelStore.revert`; the doors are questioned anew."""
        return self._order(lambda: self._store.revert(version, who, why))

    def settle(self) -> None:
        """Go by the settings as they are now.

        Raises:
            ModelStoreError: The store cannot be read or written.
        """
        last = self._questioner.last(DoorQuestion)
        if last is None or last.asked != self._question().asked:
            self._ask()
        self._judge()
        self._changed()

    def _order(self, give: Callable[[], int]) -> int:
        with self._judging:
            version = give()
            self._judge()
        self._ask()
        self._changed()
        return version

    def _take_in(self) -> None:
        while not self._ended:
            self._wake.wait(PERIOD)
            self._wake.clear()
            try:
                self._take_up()
            except Exception as error:  # whatever it is, the inspections after it are taken
                self._trouble = _unforeseen(error, "hand the inspection in again")
                self._changed()

    def _take_up(self) -> None:
        """Keep what came, and what waited for a bag that is there now; ask about it."""
        taken, told = 0, False
        while self._came and not self._ended:
            told = True
            try:
                self._keep(self._came.popleft())
                taken, self._trouble = taken + 1, None
            except DoormillError as error:
                self._trouble = error
        with self._keeping:
            found = self._kept.take_up()
        for door in found:
            self._lies(door.run_id)
        if found and isinstance(self._trouble, UnknownRunError):
            self._trouble = None
        if (taken or found) and not self._ended:
            self._ask()
        if taken or found or told:
            self._changed()

    def _keep(self, points: DoorPoints, bag: Path | None = None) -> KeptDoor:
        """As `KeptDoors.keep`."""
        try:
            with self._keeping:
                door = self._kept.keep(points, bag)
        except (UnknownRunError, KeepingError):
            self._lies(points.run_id)  # where it waits
            raise
        self._lies(points.run_id)
        return door

    def _question(self) -> DoorQuestion:
        settings, doors = self._settings(), self._kept.doors()
        chosen = [door.run_id for door in doors if door.run_id >= settings.since][-settings.doors :]
        folders = [(run_id, self._kept.folder(run_id)) for run_id in chosen]
        used = self._store.model(self._store.record().in_use)
        return DoorQuestion(
            tuple(folders),
            used.version,
            used.path or settings.model,
            tuple(checksum(folder) for _, folder in folders),
        )

    def _ask(self) -> None:
        try:
            question = self._question()
        except DoormillError as error:
            self._trouble = error
            return
        if question.doors:
            self._questioner.ask(question)

    def _take_verdict(self, verdict: DiagnosisAnswer) -> None:
        try:
            if verdict.document is None:
                self._blame(verdict)
            else:
                self._conclude(verdict)
        except DoormillError as error:
            self._trouble = error
        except Exception as error:  # whatever it is, the questions after it are asked
            self._trouble = _unforeseen(error, "the doors are questioned again with the next inspection")

    def _blame(self, verdict: DiagnosisAnswer) -> None:
        """Set the door aside of which the diagnosis complains, and ask about the others."""
        spoiled = complained_of(verdict.asked["runs"], verdict.failure)
        if not spoiled:
            self._trouble = QuestionError(verdict.failure)
            return
        with self._keeping:
            for run_id in spoiled:
                self._kept.refuse(run_id, verdict.failure)
                self._lies(run_id)
        self._trouble = QuestionError(
            f"the inspection of run {spoiled[0]} was set aside: {verdict.failure}; hand it in again put right",
            run_id=spoiled[0],
        )
        self._ask()

    def _conclude(self, verdict: DiagnosisAnswer) -> None:
        """Make a finding of an answer, propose its model if that is better, and stop milling or let it go on."""
        door_of = {door.run_id: door.door_id for door in self._kept.doors()}
        try:
            found = finding_of(verdict.document or {}, door_of)
        except (KeyError, TypeError, ValueError) as error:
            raise QuestionError(
                f"the diagnosis left what nobody can read: {error!r}; it is asked anew"
            ) from error
        runs = verdict.asked["runs"]
        with self._judging:
            self._finding = found
            if verdict.asked["version"] == self._store.record().in_use:
                self._expected, self._better = {verdict.asked["version"]: found.expected}, 0
                if found.better:
                    source = f"inspections of {len(runs)} doors, {runs[0]} to {runs[-1]}"
                    self._better = self._store.propose(verdict.model, source)
                    self._expected[self._better] = found.expected_found
                else:
                    self._store.withdraw()
            self._judge()
        if isinstance(self._trouble, QuestionError) and not self._trouble.data:
            self._trouble = None

    def _proposed(self, record: StoreRecord) -> int:
        """The better model of the last finding; 0 where there is none or it is in use."""
        known = self._better != record.in_use and record.version(self._better) is not None
        return self._better if known else 0

    def _judge(self) -> None:
        """Stop milling where the error that is expected passes the limit; let it go on where it does not."""
        with self._judging:
            record, limit = self._store.record(), self._settings().limit
            expected = self._expected.get(record.in_use, UNKNOWN)
            if expected < 0.0 and limit > 0.0:
                return
            if limit <= 0.0 or expected <= limit:
                self._store.stop("")
                return
            proposed = self._proposed(record)
            left = self._expected.get(proposed, UNKNOWN)
            self._store.stop(stop_sentence(expected, limit, record.in_use, proposed, left))


def _unforeseen(error: Exception, advice: str) -> DoormillError:
    """What is told of an error that nobody thought of; the log has all of it."""
    _LOG.error("inspected doors", exc_info=error)
    return QuestionError(f"{unexpected(error)}; see the log, {advice}")
