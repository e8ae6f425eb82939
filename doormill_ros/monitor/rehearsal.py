"""Tells whether an inspection can be kept before it is."""

from __future__ import annotations

import tempfile
from contextlib import suppress
from pathlib import Path

from doormill_ros.monitor.errors import UnknownRunError
from doormill_ros.monitor.kept_doors import DoorPoints, KeptDoors
from doormill_ros.monitor.recorded_runs import RecordedRuns


def rehearse(points: DoorPoints) -> None:
    """Keep an inspection where nothing stays.

    Raises:
        InspectionMessageError, DataSetError: As `KeptDoors.keep`.
        KeepingError: No room for what is temporary.
    """
    with tempfile.TemporaryDirectory(prefix="doormill_inspection_") as name:
        folder = Path(name)
        with suppress(UnknownRunError):  # there are no bags
            KeptDoors(folder / "kept", RecordedRuns(folder / "bags")).keep(points)
