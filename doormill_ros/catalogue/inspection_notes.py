"""The thread that notes in the catalogue which inspections a folder keeps, so that their bags stay."""

from __future__ import annotations

import logging
import os
import threading
from collections.abc import Callable
from pathlib import Path

from doormill_ros.catalogue.bag_rows import read_inspection_row
from doormill_ros.catalogue.database import Catalogue
from doormill_ros.catalogue.errors import BadRunRecordError
from doormill_ros.catalogue.run import CataloguedInspection
from doormill_ros.cell.output.inspection_files import DESCRIPTION
from doormill_ros.errors import DoormillError, unexpected

RETRY = 30.0  # s, between two tries while the database is away
STOP_LIMIT = 5.0  # s
_LOG = logging.getLogger(__name__)


class InspectionNotes:
    """Notes the inspections of one folder; a database that is away keeps nobody waiting.

    Args:
        url: Of the catalogue, see `Catalogue`.
        folder: Below it each inspection lies in a folder that is named by its run.
        changed: Called from the thread when `failure` changed.

    Attributes:
        failure: Why inspections are not noted and what to do; empty while all is well.
    """

    def __init__(self, url: str, folder: Path, changed: Callable[[], None]) -> None:
        self.failure = ""
        self._url, self._folder, self._changed = url, folder.resolve(), changed
        self._pending: set[str] = set()
        self._compared = self._ended = False
        self._wake = threading.Condition()
        self._thread = threading.Thread(target=self._run, name="inspection_notes", daemon=True)

    def start(self) -> None:
        """Note what the folder holds and the catalogue does not know, and what comes from now on."""
        self._thread.start()

    def note(self, run_id: str) -> None:
        """The inspection of a run came, or lies elsewhere in the folder now; from any thread."""
        with self._wake:
            self._pending.add(run_id)
            self._wake.notify_all()

    def stop(self) -> None:
        """Note what came until now, and end."""
        with self._wake:
            self._ended = True
            self._wake.notify_all()
        if self._thread.is_alive():
            self._thread.join(STOP_LIMIT)

    def _run(self) -> None:
        while True:
            before = self.failure
            self._try()
            if self.failure != before:
                self._changed()
            with self._wake:
                if not self.failure:
                    self._wake.wait_for(lambda: self._ended or self._pending)
                else:
                    self._wake.wait_for(lambda: self._ended, RETRY)
                if self._ended and (self.failure or not self._pending):
                    return

    def _try(self) -> None:
        with self._wake:
            taken, self._pending = self._pending, set()
        try:
            with Catalogue(self._url) as catalogue:
                if not self._compared:
                    known = catalogue.inspections_below(str(self._folder))
                    taken |= {path.name for path in self._kept() if str(path) not in known}
                    self._compared = True
                for run_id in sorted(taken):
                    catalogue.replace_inspections(run_id, str(self._folder), self._rows(run_id))
            self.failure = ""
        except Exception as error:  # whatever it is, the inspections after it are noted
            if not isinstance(error, DoormillError):
                _LOG.exception("an inspection cannot be noted in the catalogue")
            why = error.message if isinstance(error, DoormillError) else unexpected(error)
            self.failure = f"inspections are not in the catalogue, which may let their bags go: {why}"
            with self._wake:
                self._pending |= taken

    def _kept(self) -> list[Path]:
        return [Path(name) for name, _, files in os.walk(self._folder) if DESCRIPTION in files]

    def _rows(self, run_id: str) -> list[CataloguedInspection]:
        found = []
        for path in self._folder.glob(f"*/{run_id}/{DESCRIPTION}"):
            if path.parent.is_symlink():
                continue  # of a question
            try:
                found.append(read_inspection_row(path.parent))
            except BadRunRecordError as error:
                _LOG.warning(error.message)  # another process moved it, or spoiled it
        return [row for row in found if row.run_id == run_id]
