"""Which bag holds which run, in a folder to which recorders add."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from doormill_ros.cell.graph.topic_names import (
    DOOR_LOCALIZATION,
    DOOR_RECIPE,
    EXECUTED_PATH,
    PATH_TARGETS,
    RUN_RESULT,
    name_of,
)
from doormill_ros.recording.bag_folders import latest_in_bags, newest_bags, size_of_bag
from doormill_ros.recording.bag_reader import bag_files, is_broken_off, read_bag, topics_of
from doormill_ros.recording.errors import BagError
from doormill_ros.recording.mcap_scan import scan

#: What else is asked of an inspected door's run. Topics have no common order: a bag that is being recorded may hold the
#: end of a run before these.
ASKED = (DOOR_RECIPE, DOOR_LOCALIZATION, PATH_TARGETS)
#: What a simulated controller tells beside these; a real one never does.
SIMULATED_TOPICS = "/simulation/"


@dataclass(frozen=True)
class RecordedEnd:
    """Where a run is recorded, and how it ended.

    Attributes:
        bag: The bag's folder.
        door_id: What it milled.
        model_version: It was corrected with; 0 for the model that the path generator was started with.
    """

    bag: Path
    door_id: str
    model_version: int


class RecordedRuns:
    """Runs in the bags below a folder; a bag is read again only when it has grown.

    Args:
        folder: Anywhere below it bags may be; it need not be there yet.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._known: dict[Path, tuple[int, dict[str, RecordedEnd]]] = {}
        # Size of the bag in which more of a run was looked for in vain.
        self._partial: dict[tuple[Path, str], int] = {}

    def find(self, run_id: str, bag: Path | None = None) -> RecordedEnd | None:
        """The run of an id; None where no bag holds its end, or one that is not closed yet holds no more than that.

        Args:
            run_id: Which run.
            bag: Looked into first; None for the folder only.
        """
        for folder in [*([bag] if bag is not None else []), *newest_bags(self._folder)]:
            found = self._runs(folder).get(run_id)
            if found is not None and self._is_whole(folder, run_id):
                return found
        return None

    def _is_whole(self, folder: Path, run_id: str) -> bool:
        size = self._known[folder][0]
        if self._partial.get((folder, run_id)) == size:
            return False
        if _is_whole(folder, run_id):
            return True
        self._partial[folder, run_id] = size
        return False

    def count(self, since: str, enough: int) -> int:
        """How many runs ended, from one on (empty: of all); counted to `enough` in the bags written to last."""
        return len(latest_in_bags(self._folder, self._runs, since, enough))

    def _runs(self, folder: Path) -> dict[str, RecordedEnd]:
        try:
            size = size_of_bag(folder)
        except OSError:
            return {}
        known = self._known.get(folder)
        if known is None or known[0] != size:
            known = self._known[folder] = size, _ends(folder)
        return known[1]


def _is_whole(bag: Path, run_id: str) -> bool:
    """Whether nothing more of a run is to come into a bag."""
    try:
        if not is_broken_off(bag):
            return True
        missing, wanted = {*ASKED, EXECUTED_PATH}, run_id.encode()
        simulated = False
        for item in (item for path in bag_files(bag) for item in scan(path)):
            simulated = simulated or SIMULATED_TOPICS in item.channel.topic
            # Deserializing the paths of a whole shift takes seconds; the id is in the message as it is written.
            if wanted in item.message.data:
                missing -= {name_of(item.channel.topic, missing)}
    except (BagError, OSError):
        return False
    return not missing - (set() if simulated else {EXECUTED_PATH})


def _ends(bag: Path) -> dict[str, RecordedEnd]:
    """Runs that ended in a bag, by id; what cannot be read of it holds none."""
    found: dict[str, RecordedEnd] = {}
    try:
        names = [topic for topic in topics_of(bag) if name_of(topic, [RUN_RESULT])]
        for item in read_bag(bag, names) if names else ():
            end = item.message
            # Bags of older software tell no version.
            found[end.run_id] = RecordedEnd(bag, end.door_id, int(getattr(end, "model_version", 0)))
    except (BagError, AttributeError, TypeError, ValueError):
        return found  # damaged, or another recorder's of other fields
    return found
