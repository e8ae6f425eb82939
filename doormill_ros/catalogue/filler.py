"""The thread that notes the runs of a recording in the catalogue as they end."""

from __future__ import annotations

import functools
import logging
import queue
import threading
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from doormill_ros.catalogue.run_collector import RunCollector
from doormill_ros.cell.graph.topic_names import RUN_RESULT
from doormill_ros.errors import DoormillError, unexpected

if TYPE_CHECKING:
    from doormill_ros.catalogue.database import Catalogue

MOST_HELD = 200  # messages of runs that do not end
STOP_LIMIT = 10.0  # s, for a database to answer once the recording is over

_LOG = logging.getLogger(__name__)


class RunFiller:
    """Fills the catalogue from one recording; a database that is away costs rows, never messages of the bag.

    Args:
        url: Of the catalogue, see `Catalogue`.
        bag: Folder that is recorded into.
        recorder: What stands in the bag's metadata of its recorder.
        decode: Makes a message of what was received on a topic.

    Attributes:
        failure: Why a run is not noted and what to do; empty while all is well.
    """

    def __init__(
        self, url: str, bag: Path, recorder: Mapping[str, str], decode: Callable[[str, bytes], Any]
    ) -> None:
        self.failure = ""
        self._url = url
        self._bag = bag
        self._decode = decode
        self._collector = RunCollector(recorder)
        self._catalogue: Catalogue | None = None
        self._read = threading.Event()  # the closed bag is
        self._begun = False  # a run of this bag is noted
        self._received: queue.SimpleQueue[tuple[str, bytes, int] | None] = queue.SimpleQueue()
        self._thread = threading.Thread(target=self._fill, name="catalogue_filler", daemon=True)

    def start(self) -> None:
        """Begin to note what is taken."""
        self._thread.start()

    def take(self, topic: str, data: bytes, stamp_ns: int) -> None:
        """A message was received, from any thread.

        Args:
            topic: One of `run_collector.TOPICS`.
            data: The message, serialized.
            stamp_ns: When it is recorded [ns since the epoch].
        """
        self._received.put((topic, data, stamp_ns))

    def stop(self) -> None:
        """Note what the closed bag holds, with its checksum and the inspection beside it.

        A database that does not answer is left, and `failure` says so: it may be silent for ever.
        """
        self._received.put(None)
        if self._ended(self._thread):
            finishing = functools.partial(self._try, self._finish)
            thread = threading.Thread(target=finishing, name="catalogue_filler", daemon=True)
            thread.start()
            # To read the bag takes as long as it is large; to store its rows does not.
            self._read.wait()
            self._ended(thread)

    def _ended(self, thread: threading.Thread) -> bool:
        thread.join(STOP_LIMIT)
        if thread.is_alive():
            why = f"it does not answer within {STOP_LIMIT:g} s"
            self.failure = f"runs are not in the catalogue: {why}; catalogue rebuild {self._bag} adds them"
        return not thread.is_alive()

    def _fill(self) -> None:
        # Read when a run has ended: before, the processor is the door's, which waits for its targets.
        held: list[tuple[str, bytes, int]] = []
        while (item := self._received.get()) is not None:
            held.append(item)
            if item[0] == RUN_RESULT or len(held) >= MOST_HELD:
                self._take_all(held)
        self._take_all(held)

    def _take_all(self, held: list[tuple[str, bytes, int]]) -> None:
        for item in held:
            self._try(functools.partial(self._take, *item))
        held.clear()

    def _take(self, topic: str, data: bytes, stamp_ns: int) -> None:
        if self._collector.take(topic, self._decode(topic, data), stamp_ns):
            bag = str(self._bag.resolve())
            runs = [replace(run, bag=bag) for run in self._collector.runs(touched=True)]
            catalogue = self._open()
            if self._begun:
                catalogue.add(runs)
            else:  # takes the place of a recording that was made here before
                catalogue.store(bag, runs)
                self._begun = True
            self._collector.noted()

    def _finish(self) -> None:
        try:
            if not self._collector.runs():
                return
            from doormill_ros.catalogue.bag_rows import finished  # late, as below

            rows = finished(self._bag, self._collector)
            self._read.set()
            self._open().store(rows.bag, rows.runs, rows.inspections)
        finally:
            self._read.set()
            if self._catalogue is not None:
                self._catalogue.close()

    def _open(self) -> Catalogue:
        # Late: the database's library is half of a recorder's start, and no run has ended before.
        from doormill_ros.catalogue.database import Catalogue

        self._catalogue = self._catalogue or Catalogue(self._url)
        return self._catalogue

    def _try(self, action: Callable[[], None]) -> None:
        try:
            action()
            self.failure = ""
        except Exception as error:  # whatever it is, the runs after it are noted
            if isinstance(error, DoormillError):
                why = error.message
            else:
                _LOG.exception("a run cannot be noted in the catalogue")
                why = unexpected(error)
            self.failure = f"runs are not in the catalogue: {why}; catalogue rebuild {self._bag} adds them"
