"""How long bags stay, and what is kept for ever."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from doormill_ros.catalogue.database import Catalogue, Selection
from doormill_ros.catalogue.errors import BadRetentionError
from doormill_ros.catalogue.needs import Needs, find_needs
from doormill_ros.catalogue.run import CatalogueRow
from doormill_ros.cell.output.inspection_files import BESIDE_BAG, DESCRIPTION
from doormill_ros.recording.bag_folders import content_of_bag
from doormill_ros.recording.bag_reader import bag_files
from doormill_ros.recording.metadata import METADATA
from doormill_ros.recording.replay.expectation import FILE as EXPECTATION
from doormill_ros.units import days_to_s, gigabytes_to_bytes, s_to_ns

RETIRED = ".retired"  #: end of the name of a bag that is being deleted
LONGEST = 1e12  # s; no bag is so old
LOOKS = 50  #: round what lies near the bags while they are deleted, so that many bags do not cost the square of it
_LINKED = "it lies behind a link"


@dataclass(frozen=True)
class Retention:
    """What goes first is the oldest.

    Attributes:
        days: A bag whose last run began longer ago goes; None for no limit.
        gigabytes: While the bags together have more, one goes; None for no limit.
    """

    days: float | None = None
    gigabytes: float | None = None

    def __post_init__(self) -> None:
        """Refuse what would delete everything or nothing by mistake.

        Raises:
            BadRetentionError: Neither is given, or one is no number of at least 0.
        """
        limits = {"days": self.days, "gigabytes": self.gigabytes}
        given = {unit: value for unit, value in limits.items() if value is not None}
        if not given or not all(math.isfinite(value) and value >= 0.0 for value in given.values()):
            found = " and ".join(f"{value:g} {unit}" for unit, value in given.items())
            raise BadRetentionError(
                f"found {found or 'no limit'}, allowed are numbers from 0 on, at least one of days and gigabytes"
            )


@dataclass(frozen=True)
class Judged:
    """A bag and what becomes of it.

    Attributes:
        bag: Its folder.
        sha256: Checksum, see `BagContent`.
        size: Of what lies in it [bytes].
        begun_ns: When its last run began [ns since the epoch]; 0 where it tells of none.
        goes: Whether it is deleted.
        reason: Why it goes, or why it is kept though its time is over; empty where it is not.
        failed: It was to go, or its content was to be compared, and the disk refused.
    """

    bag: Path
    sha256: str
    size: int
    begun_ns: int
    goes: bool
    reason: str = ""
    failed: bool = False


def judge(
    catalogue: Catalogue, retention: Retention, now_ns: int, inspections: Sequence[Path] = ()
) -> list[Judged]:
    """What becomes of every bag that lies on this machine, the oldest first; nothing is deleted.

    Args:
        catalogue: Names the bags. What it does not know is left alone.
        retention: How long they stay.
        now_ns: The time [ns since the epoch].
        inspections: Folders that may hold inspections, beside those in which the bags lie.
    """
    bags = sorted(_here(_bags(catalogue.rows())), key=lambda bag: (bag.begun_ns, bag.path))
    sizes = {bag.path: 0 if _is_linked(bag.path) else _size(bag.path) for bag in bags}
    limit = None if retention.days is None else now_ns - s_to_ns(min(days_to_s(retention.days), LONGEST))
    total = sum(sizes.values())
    allowed = math.inf if retention.gigabytes is None else gigabytes_to_bytes(retention.gigabytes)
    judged, needs = [], None
    for bag in bags:
        over = []
        if limit is not None and bag.begun_ns < limit:
            over.append(f"older than {retention.days:g} days")
        if total > allowed:
            over.append(f"the bags have more than {retention.gigabytes:g} GB")
        if over and needs is None:
            needs = find_needs((*inspections, *(bag.path.parent for bag in bags)))
        size, failed = sizes[bag.path], False
        try:
            needed = bag.needed(needs) if over and needs is not None else ""
        except OSError as error:
            needed, failed = f"it cannot be read: {error.strerror or error}", True
        goes = bool(over) and not needed
        reason = needed or ", ".join(over)
        judged.append(Judged(bag.path, bag.sha256, size, bag.begun_ns, goes, reason, failed))
        total -= size if goes else 0
    return judged


def retain(
    catalogue: Catalogue, retention: Retention, now_ns: int, inspections: Sequence[Path] = ()
) -> Iterator[Judged]:
    """Delete what goes, one bag at a time; arguments as for `judge`. The rows of its runs stay.

    To judge many bags takes long: whether one is needed is asked again before it goes, of the catalogue and the bag
    each time, of what lies near the bags `LOOKS` times in all. A bag that the disk does not let go stops no other.
    """
    for bag in _bags(catalogue.rows()):
        # Whoever was ended in the middle of it left one of these.
        if _retired(bag.path).is_dir() and not bag.path.exists() and not _is_linked(bag.path):
            left = Judged(bag.path, bag.sha256, 0, bag.begun_ns, goes=True)
            if (done := _deleted(catalogue, left)).failed:
                yield done
    found = judge(catalogue, retention, now_ns, inspections)
    places = (*inspections, *(judged.bag.parent for judged in found))
    going, needs = 0, Needs()
    for judged in found:
        if judged.goes:
            if going % math.ceil(len(found) / LOOKS) == 0:
                needs = find_needs(places)
            going += 1
            judged = _gone_or_kept(catalogue, judged, needs)
        yield judged


def _gone_or_kept(catalogue: Catalogue, judged: Judged, needs: Needs) -> Judged:
    """Delete a bag, unless something came meanwhile that needs it."""
    known = _bags(catalogue.rows(Selection(bag=str(judged.bag))))
    same = (bag for bag in known if bag.sha256 == judged.sha256)
    try:
        wanted = next((bag.wanted(needs) for bag in same), "the catalogue knows it by another name now")
        if wanted:
            return replace(judged, goes=False, reason=wanted)
        # In one step out of everybody's sight: a bag is there or gone, never half of it.
        judged.bag.rename(_retired(judged.bag))
    except OSError as error:
        return _refused(judged, error)
    return _deleted(catalogue, judged)


def _deleted(catalogue: Catalogue, judged: Judged) -> Judged:
    try:
        _delete(catalogue, judged.bag, judged.sha256)
    except OSError as error:
        return _refused(judged, error)
    return judged


def _refused(judged: Judged, error: OSError) -> Judged:
    reason = f"it cannot be deleted: {error.strerror or error}; look at its folder's owner and the disk"
    return replace(judged, goes=False, reason=reason, failed=True)


def _delete(catalogue: Catalogue, bag: Path, sha256: str) -> None:
    """Delete a bag that is out of sight; its empty folder stays until the catalogue knows."""
    retired = _retired(bag)
    for entry in retired.iterdir():
        entry.unlink()
    catalogue.forget_bag(str(bag), sha256)
    retired.rmdir()


@dataclass(frozen=True)
class _Bag:
    path: Path
    sha256: str
    rows: tuple[CatalogueRow, ...]

    @property
    def begun_ns(self) -> int:
        return max(row.run.begun_ns or row.run.ended_ns or 0 for row in self.rows)

    def needed(self, needs: Needs) -> str:
        """Why it is kept for ever; empty where it may go.

        Raises:
            OSError: It cannot be read.
        """
        wanted = self.wanted(needs)
        if not wanted and (not self.sha256 or self.sha256 != content_of_bag(self.path).sha256):
            return "it is not what the catalogue knows: catalogue rebuild it first"
        return wanted

    def wanted(self, needs: Needs) -> str:
        """As `needed`, its content aside, which takes long to read.

        The disk is asked as well as the catalogue: what was put there since, or cannot be read, needs the bag too.
        """
        if _is_linked(self.path):
            return _LINKED
        for row in self.rows:
            if row.kept:
                return f"kept: {row.kept}"
            if row.inspection is not None:
                return f"the inspection {row.inspection.inspection} needs it"
        if not self.begun_ns:
            return "nobody knows how old it is"
        if (self.path.parent / BESIDE_BAG / DESCRIPTION).exists():
            return f"the inspection {self.path.parent / BESIDE_BAG} needs it"
        inspected = needs.of(self.path, [row.run.run_id for row in self.rows])
        if inspected:
            return inspected
        if (self.path / EXPECTATION).exists():
            return f"its {EXPECTATION} is an expectation"
        own = {METADATA, *(file.name for file in bag_files(self.path))}
        others = sorted({entry.name for entry in self.path.iterdir()} - own)
        if others:
            return f"it holds {others[0]}, which no recorder writes"
        return ""


def _bags(rows: Iterable[CatalogueRow]) -> list[_Bag]:
    """Every bag that the rows name, wherever it lies."""
    by_bag: dict[tuple[str, str], list[CatalogueRow]] = {}
    for row in rows:
        if row.run.bag:
            by_bag.setdefault((row.run.bag, row.run.bag_sha256), []).append(row)
    return [_Bag(Path(bag), sha256, tuple(rows)) for (bag, sha256), rows in by_bag.items()]


def _here(bags: Iterable[_Bag]) -> list[_Bag]:
    """Those that lie on this machine; of several of one path, as other machines may have, the one that lies there."""
    by_path: dict[Path, list[_Bag]] = {}
    for bag in bags:
        if bag.path.is_dir():
            by_path.setdefault(bag.path, []).append(bag)
    return [_lying(of_path) for of_path in by_path.values()]


def _lying(bags: Sequence[_Bag]) -> _Bag:
    if len(bags) == 1:
        return bags[0]
    try:
        sha256 = content_of_bag(bags[0].path).sha256
    except OSError:
        return bags[0]
    return next((bag for bag in bags if bag.sha256 == sha256), bags[0])


def _size(bag: Path) -> int:
    try:
        return sum(path.stat().st_size for path in bag_files(bag))
    except OSError:
        return 0  # somebody takes it away


def _is_linked(bag: Path) -> bool:
    return bag.is_symlink() or bag.parent.resolve() != bag.parent


def _retired(bag: Path) -> Path:
    return bag.with_name(f".{bag.name}{RETIRED}")
