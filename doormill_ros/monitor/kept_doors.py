"""Inspected doors that are kept: one folder a run, each an inspection with a line about its door beside it."""

from __future__ import annotations

import json
import os
import re
import shutil
import threading
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from pathlib import Path

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.cell.graph.topic_names import RUN_RESULT, name_of
from doormill_ros.errors import DoormillError
from doormill_ros.files import write_atomically
from doormill_ros.measurements.inspections.inspection import Inspection, read_inspection
from doormill_ros.measurements.inspections.inspection_writer import write_inspection
from doormill_ros.messages.stamps import seconds_of
from doormill_ros.monitor.errors import InspectionMessageError, KeepingError, UnknownRunError
from doormill_ros.monitor.recorded_runs import RecordedRuns
from doormill_ros.recording.bag_reader import read_bag, topics_of
from doormill_ros.statistics import root_mean_square

DOOR = "door.json"
RUN_ID = re.compile(r"[A-Za-z0-9][A-Za-z0-9_.:-]{0,99}")
REASON = "reason.txt"


@dataclass(frozen=True, eq=False)
class DoorPoints:
    """What was measured on a door; columns as in `Inspection`.

    Attributes:
        run_id: The run that milled it.
        measured_at: With its zone.
        noise: Standard deviation of one deviation [m].
        datum: What the deviations are against.
        feature, surface: One a point, n of them.
        point, normal: Shape (n, 3), door frame.
        deviation: Shape (n,) [m].
    """

    run_id: str
    measured_at: datetime
    noise: float
    datum: str
    feature: Sequence[str]
    surface: Sequence[str]
    point: FloatArray
    normal: FloatArray
    deviation: FloatArray


def points_of(inspection: Inspection) -> DoorPoints:
    """What was measured, of an inspection that was read."""
    return DoorPoints(
        inspection.run_id,
        inspection.measured_at,
        inspection.noise,
        inspection.datum,
        inspection.feature,
        np.where(inspection.wall, "wall", "floor").tolist(),
        inspection.point,
        inspection.normal,
        inspection.deviation,
    )


@dataclass(frozen=True)
class KeptDoor:
    """An inspected door whose run is recorded.

    Attributes:
        run_id: The run.
        door_id: What it milled.
        model_version: It was corrected with.
        measured_at: ISO 8601.
        rms: Of all deviations [m].
        largest: Of the deviations [m].
        milled_at: When its run ended by the bag, ISO 8601; empty for what was kept before that was asked.
    """

    run_id: str
    door_id: str
    model_version: int
    measured_at: str
    rms: float
    largest: float
    milled_at: str = ""


class KeptDoors:
    """Inspections of a cell: those with a bag, those that wait for one, and those that turned out to be of no use.

    Args:
        folder: Gets `doors`, `waiting` and `refused`.
        runs: Which bag holds which run.
    """

    def __init__(self, folder: Path, runs: RecordedRuns) -> None:
        self._doors, self._waiting, self._refused = (
            folder / name for name in ("doors", "waiting", "refused")
        )
        self._runs = runs
        self._reading = threading.Lock()
        self._known: dict[str, KeptDoor] | None = None  # a year has a hundred thousand of them

    @property
    def waiting(self) -> list[str]:
        """Runs whose inspection waits for a bag."""
        return sorted(path.name for path in self._waiting.glob("*") if path.is_dir())

    def doors(self) -> list[KeptDoor]:
        """All doors as they were milled, measured where not all tell that; what cannot be read is passed over."""
        with self._reading:
            found = list(self._read().values())
        known = all(door.milled_at for door in found)
        return sorted(found, key=lambda d: (d.milled_at if known else "", d.measured_at, d.run_id))

    def folder(self, run_id: str) -> Path:
        """The inspection of a kept door."""
        return self._doors / run_id

    def keep(self, points: DoorPoints, bag: Path | None = None) -> KeptDoor:
        """Keep what was measured on a door; a door that was measured before is measured anew.

        Args:
            points: What was measured.
            bag: That may hold the run; None: one of the bags' folder.

        Raises:
            InspectionMessageError: It names no run, or its columns differ in length.
            DataSetError: A value cannot be used.
            UnknownRunError: No bag holds the run yet; the inspection waits.
            KeepingError: It cannot be written.
        """
        _check(points)
        folder = (self._waiting / points.run_id).resolve()
        # Until its bag is found it names itself: a folder has to be there.
        beside = folder if bag is None else bag.resolve()
        try:
            shutil.rmtree(folder, ignore_errors=True)
            write_inspection(
                folder, beside, points.run_id, points.measured_at, points.noise, points, points.datum
            )
        except OSError as error:
            raise _unkept(folder, error) from error
        try:
            inspection = read_inspection(folder)
            if inspection.run_id != points.run_id:
                raise InspectionMessageError(
                    f"run id {points.run_id!r} does not read back from a file; use another"
                )
        except DoormillError:
            shutil.rmtree(folder, ignore_errors=True)
            raise
        return self._join(inspection)

    def take_up(self) -> list[KeptDoor]:
        """Those of the waiting inspections whose bag has come."""
        found = []
        for run_id in self.waiting:
            with suppress(DoormillError):  # it was read when it came, and waits on
                found.append(self._join(read_inspection(self._waiting / run_id)))
        return found

    def refuse(self, run_id: str, reason: str) -> None:
        """Set a door aside that the diagnosis cannot use; the inspection and the reason are kept.

        Raises:
            KeepingError: It cannot be moved.
        """
        aside = self._refused / run_id
        try:
            shutil.rmtree(aside, ignore_errors=True)
            self._refused.mkdir(parents=True, exist_ok=True)
            with self._reading:
                os.replace(self._doors / run_id, aside)
                self._read().pop(run_id, None)
            write_atomically(aside / REASON, reason + "\n")
        except OSError as error:
            raise _unkept(aside, error) from error

    def _read(self) -> dict[str, KeptDoor]:
        """The doors by run; nobody else writes them, so that they are read from the disk once."""
        if self._known is None:
            self._known = {}
            for path in self._doors.glob(f"*/{DOOR}"):
                with suppress(OSError, ValueError, TypeError, RecursionError):
                    self._known[path.parent.name] = _kept(path)
        return self._known

    def _join(self, inspection: Inspection) -> KeptDoor:
        """Give a waiting inspection its bag."""
        run_id = inspection.run_id
        end = self._runs.find(run_id, inspection.bag)
        if end is None:
            raise UnknownRunError(
                f"no bag holds all of a run {run_id!r} that has ended; the inspection of {len(inspection)} points "
                "waits for it: correct the run id and hand the inspection in again, or bring the bag into the bags' "
                "folder",
                run_id=run_id,
            )
        folder = self._doors / run_id
        door = KeptDoor(
            run_id,
            end.door_id,
            end.model_version,
            inspection.measured_at.isoformat(),
            root_mean_square(inspection.deviation),
            inspection.largest,
            _milled_at(end.bag, run_id),
        )
        try:
            with self._reading:
                self._read().pop(run_id, None)
                shutil.rmtree(folder, ignore_errors=True)
            points = points_of(inspection)
            bag = end.bag.resolve()
            write_inspection(
                folder.resolve(),
                bag,
                run_id,
                inspection.measured_at,
                inspection.noise,
                points,
                inspection.datum,
            )
            with self._reading:
                # Last: what has this file is whole.
                write_atomically(folder / DOOR, json.dumps(asdict(door)) + "\n")
                self._read()[run_id] = door
            shutil.rmtree(self._waiting / run_id, ignore_errors=True)
        except OSError as error:
            raise _unkept(folder, error) from error
        return door


def _milled_at(bag: Path, run_id: str) -> str:
    """When a run ended by its bag, ISO 8601."""
    names = [topic for topic in topics_of(bag) if name_of(topic, [RUN_RESULT])]
    stamps = [item.message.header.stamp for item in read_bag(bag, names) if item.message.run_id == run_id]
    moment = seconds_of(stamps[-1]) if stamps else 0.0
    return datetime.fromtimestamp(moment, UTC).isoformat(timespec="microseconds") if moment else ""


def _kept(path: Path) -> KeptDoor:
    door = KeptDoor(**json.loads(path.read_text(encoding="utf-8")))
    texts = (door.run_id, door.door_id, door.measured_at, door.milled_at)
    figures = (door.model_version, door.rms, door.largest)
    good = all(isinstance(text, str) for text in texts) and all(isinstance(x, int | float) for x in figures)
    if not good or door.run_id != path.parent.name:
        raise ValueError(f"{path} does not describe the door of its folder")
    return door


def _check(points: DoorPoints) -> None:
    if not RUN_ID.fullmatch(points.run_id):
        raise InspectionMessageError(
            f"the inspection is of run {points.run_id!r}, allowed are letters, digits and _.:- as in run/result"
        )
    counts = {
        "feature": len(points.feature),
        "surface": len(points.surface),
        "point": len(points.point),
        "normal": len(points.normal),
        "deviation": len(points.deviation),
    }
    if len(set(counts.values())) > 1 or not len(points.deviation):
        told = ", ".join(f"{count} of {name}" for name, count in counts.items())
        raise InspectionMessageError(
            f"the inspection of run {points.run_id} has {told}; one of each a point is wanted"
        )
    odd = next(
        (name for name in points.feature if not name.isprintable() or set(name) & set(',"') or not name), None
    )
    if odd is not None:
        raise InspectionMessageError(
            f"the inspection of run {points.run_id} names a feature {odd!r}, allowed are names of the recipe"
        )


def _unkept(folder: Path, error: OSError) -> DoormillError:
    return KeepingError(
        f"the inspection cannot be kept in {folder}: {error.strerror or error}; make room there and hand it in again",
        path=str(folder),
    )
