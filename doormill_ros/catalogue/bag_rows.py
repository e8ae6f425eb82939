"""What the catalogue holds of a bag, read from the bag and from the inspection beside it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from datetime import UTC, datetime
from pathlib import Path

from doormill_ros.catalogue.errors import BadRunRecordError
from doormill_ros.catalogue.run import CataloguedInspection, CataloguedRun
from doormill_ros.catalogue.run_collector import RunCollector, topic_of
from doormill_ros.cell.output.inspection_files import BESIDE_BAG, DESCRIPTION
from doormill_ros.config import read_document
from doormill_ros.recording.bag_folders import content_of_bag
from doormill_ros.recording.bag_reader import read_bag
from doormill_ros.recording.completeness import check_whole
from doormill_ros.recording.errors import BagError, UnreadableBagError
from doormill_ros.recording.information import information_of
from doormill_ros.units import s_to_ns


@dataclass(frozen=True)
class BagRows:
    """Rows of one bag.

    Attributes:
        bag: Its folder, absolute.
        runs: In the order in which they began.
        inspections: Of them, found beside the bag.
        refused: Why a run of it or the inspection beside it is not among them; empty where all is well.
    """

    bag: str
    runs: tuple[CataloguedRun, ...]
    inspections: tuple[CataloguedInspection, ...] = ()
    refused: str = ""


def read_rows(folder: Path) -> BagRows:
    """The rows of a closed bag, or of one whose recorder was killed.

    Raises:
        UnreadableBagError: No such bag, or damaged.
        IncompleteBagError: It holds fewer messages than its metadata.yaml lists.
        BadRunRecordError: It tells of a run what no catalogue can hold.
    """
    collector = RunCollector(recorder_of(folder))
    try:
        for item in read_bag(folder, topic_of):
            collector.take(topic_of(item.topic), item.message, item.stamp_ns)
    except BadRunRecordError as error:
        raise BadRunRecordError(f"bag {folder}: {error.message}", bag=str(folder)) from error
    try:
        check_whole(folder)
    except OSError as error:
        raise _unreadable(folder, error) from error
    return finished(folder, collector)


def finished(folder: Path, collector: RunCollector) -> BagRows:
    """Rows of a closed bag, with its place, checksum and the inspection beside it.

    Raises:
        UnreadableBagError: Its files cannot be read.
        BadRunRecordError: Its path is no text.
    """
    _check_name(folder)
    try:
        content = content_of_bag(folder)
    except OSError as error:
        raise _unreadable(folder, error) from error
    bag = str(folder.resolve())
    rows = tuple(
        replace(run, bag=bag, bag_sha256=content.sha256, bag_bytes=content.size) for run in collector.runs()
    )
    beside, refused = folder.resolve().parent / BESIDE_BAG, collector.refused
    inspections: tuple[CataloguedInspection, ...] = ()
    if (beside / DESCRIPTION).is_file():
        try:
            one = read_inspection_row(beside)
            inspections = (one,) if one.run_id in {run.run_id for run in rows} else ()
        except BadRunRecordError as error:
            refused = refused or error.message
    return BagRows(bag, rows, inspections, refused)


def is_text(path: Path) -> bool:
    """Whether a catalogue can hold a path."""
    try:
        str(path).encode()
    except UnicodeEncodeError:
        return False
    return True


def _check_name(folder: Path) -> None:
    if not is_text(folder.resolve()):
        raise BadRunRecordError(
            f"{str(folder)!r} lies in a folder whose name is no UTF-8; rename the folder", folder=str(folder)
        )


def _unreadable(folder: Path, error: OSError) -> BagError:
    return UnreadableBagError(f"bag {folder} cannot be read: {error}; look at the disk", folder=str(folder))


def recorder_of(folder: Path) -> dict[str, str]:
    """What the recorder of a bag says of itself; nothing where metadata.yaml is missing.

    Raises:
        UnreadableBagError: metadata.yaml cannot be read.
    """
    custom = information_of(folder).get("custom_data")
    return {str(key): str(value) for key, value in custom.items()} if isinstance(custom, dict) else {}


def read_inspection_row(folder: Path) -> CataloguedInspection:
    """That a door was inspected, from the description alone; the points are the diagnosis' business.

    Raises:
        BadRunRecordError: It cannot be read, names no run or time, or its path is no text.
    """
    _check_name(folder)
    path = folder / DESCRIPTION
    document = read_document(path, BadRunRecordError, "see docs/inspection.md")
    values = document if isinstance(document, dict) else {}
    run_id, measured_at = values.get("run_id"), values.get("measured_at")
    try:
        moment = datetime.fromisoformat(str(measured_at))
        moment = moment if moment.tzinfo else moment.replace(tzinfo=UTC)
        inspected_ns = s_to_ns(moment.timestamp())
    except (ValueError, OverflowError):
        inspected_ns = -1
    if not isinstance(run_id, str) or not run_id.isprintable() or not run_id or inspected_ns < 0:
        raise BadRunRecordError(
            f"{path} has run_id {run_id!r} and measured_at {measured_at!r}, allowed are the name of a run and a time "
            "as 2026-11-22T08:00:00Z; correct them",
            path=str(path),
        )
    return CataloguedInspection(run_id, str(folder.resolve()), inspected_ns)
