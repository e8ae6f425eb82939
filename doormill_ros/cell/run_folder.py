"""Where a run of the cell puts what it makes."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from doormill_ros.cell.errors import BadParameterError
from doormill_ros.resources import AUDIT, MODELS


@dataclass(frozen=True)
class RunFolder:
    """Paths below one run's output folder.

    Attributes:
        root: The folder.
        shift: Folder of the shift that the run belongs to, which has the controller; None for a run by itself.
    """

    root: Path
    shift: Path | None = None

    @property
    def bag(self) -> Path:
        """MCAP bag folder."""
        return self.root / "bag"

    @property
    def targets(self) -> Path:
        """Folder with a copy of the target file."""
        return self.root / "targets"

    @property
    def controller(self) -> Path:
        """HOME folder of the simulated controller."""
        return (self.shift or self.root) / "controller" / "HOME"

    def controller_of(self, robot: str) -> Path:
        """HOME folder of the simulated controller of one of two robots."""
        return self.controller.parent / robot / "HOME"

    @property
    def inspection(self) -> Path:
        """What was measured on the milled door."""
        return self.root / "inspection"

    @property
    def models(self) -> Path:
        """Store of models, of the shift where the run belongs to one."""
        return (self.shift or self.root) / MODELS

    @property
    def audit(self) -> Path:
        """Audit log of the operator's page."""
        return self.root / AUDIT

    @property
    def inspections(self) -> Path:
        """What /model_monitor keeps, of the shift where the run belongs to one."""
        return (self.shift or self.root) / "inspections"

    @property
    def report(self) -> Path:
        """The report."""
        return self.root / "report.html"

    @property
    def parameters(self) -> Path:
        """Parameters of the nodes."""
        return self.root / "parameters.yaml"

    @property
    def summary(self) -> Path:
        """summary.json."""
        return self.root / "summary.json"

    def prepare(self) -> None:
        """Make the folder; what a former run left under these names is removed, nothing else.

        Raises:
            BadParameterError: The disk does not let it, such as for a file that is in the way.
        """
        with _told_of(self.root):
            self._prepare()

    def _prepare(self) -> None:
        own = () if self.shift else (self.controller.parent,)
        # What is kept of inspections names bags that go; models stay.
        own = own if self.shift else (*own, self.inspections)
        for path in (self.bag, self.targets, self.inspection, *own):
            if path.exists():
                shutil.rmtree(path)
        for path in (self.report, self.summary, self.parameters):
            path.unlink(missing_ok=True)
        self.root.mkdir(parents=True, exist_ok=True)
        self.controller.mkdir(parents=True, exist_ok=True)


@dataclass(frozen=True)
class ShiftFolder:
    """Paths below the output folder of a shift of doors."""

    root: Path

    def run(self, number: int) -> RunFolder:
        """Folder of a door's run, the first one is 0."""
        return RunFolder(self.root / f"door_{number:03d}", self.root)

    @property
    def controller(self) -> Path:
        """HOME folder of the simulated controller."""
        return self.run(0).controller

    @property
    def summary(self) -> Path:
        """shift.json."""
        return self.root / "shift.json"

    def prepare(self) -> None:
        """Make the folder; a former shift's doors, inspections and controller are removed, nothing else.

        Raises:
            BadParameterError: The disk does not let it, such as for a file that is in the way.
        """
        with _told_of(self.root):
            self._prepare()

    def _prepare(self) -> None:
        doors = [path for path in self.root.glob("door_*") if path.name.removeprefix("door_").isdigit()]
        for path in (*doors, self.controller.parent, self.run(0).inspections):
            if path.exists():
                shutil.rmtree(path)
        self.summary.unlink(missing_ok=True)
        self.controller.mkdir(parents=True)


@contextmanager
def _told_of(root: Path) -> Iterator[None]:
    """Say what is wrong with the folder that somebody chose."""
    try:
        yield
    except OSError as error:
        raise BadParameterError(
            f"folder {root} cannot be made anew: {error.filename or root}: {error.strerror}; name another one, "
            "or make way"
        ) from error


def point_latest(root: Path, latest: Path) -> None:
    """Let the symbolic link `latest` name the newest run's folder."""
    link = latest.with_name(latest.name + ".new")
    link.unlink(missing_ok=True)
    link.symlink_to(root.resolve().relative_to(latest.parent.resolve()))
    link.replace(latest)
