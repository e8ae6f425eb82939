"""Where a run of the cell puts what it makes."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import NoReturn

from doormill_ros.cell.errors import BadParameterError
from doormill_ros.cell.output import earlier_run
from doormill_ros.resources import AUDIT, MODELS

#: Folders of a shift that the documentation has `diagnose` write to.
DIAGNOSES = ("diagnosis", "runs")


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
            BadParameterError: Something lies there that no run wrote, or somebody handed in, and nothing is touched; or
                the disk does not let it, such as for a file that is in the way.
        """
        with _told_of(self.root):
            self._check()
            self._prepare()

    def _check(self) -> None:
        """Refuse what must not be removed."""
        if self.shift is None and earlier_run.doors(self.root):
            _refuse(self.root, "holds a shift of doors, which one door cannot take the place of")
        ran = earlier_run.is_run(self.root)
        _refuse_strangers(self.root, earlier_run.strangers(self.root, ran))
        _refuse_strangers(self.root, earlier_run.strangers_in(self._shared(), ran))
        # Only for the doors of a shift something is measured there by the cell itself.
        if self.shift is None and earlier_run.inspected(self.root):
            _refuse_measured(self.root, self.inspection)
        _refuse_handed_in(self, (self.inspection, *self._shared()))

    def _shared(self) -> tuple[Path, ...]:
        """What a shift has for all of its runs, and a run by itself for its own."""
        # What is kept of inspections names bags that go; models stay.
        # The controller's disk last: by it what its own gauge measured is known.
        return () if self.shift else (self.inspections, self.controller.parent)

    def _prepare(self) -> None:
        for path in (self.bag, self.targets, self.inspection, *self._shared()):
            if path.exists():
                shutil.rmtree(path)
        # These last: by them a folder that is half removed is still known for a run's.
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

    def prepare(self, doors: int) -> None:
        """Make the folder; a former shift's doors, inspections, controller and diagnoses are removed, nothing else.

        Args:
            doors: How many the new shift has; a former one that had more of them inspected keeps its folder.

        Raises:
            BadParameterError: Something lies there that no shift wrote, or that this one would not measure anew, and
                nothing is touched; or the disk does not let it, such as for a file that is in the way.
        """
        with _told_of(self.root):
            self._check(doors)
            self._prepare()

    def _check(self, doors: int) -> None:
        """Refuse what must not be removed."""
        alone = RunFolder(self.root)
        if alone.bag.exists() or alone.summary.exists():
            _refuse(self.root, "holds a run by itself, which a shift cannot take the place of")
        former = earlier_run.doors(self.root)
        for path in former:
            run = RunFolder(path, self.root)
            _refuse_strangers(self.root, earlier_run.strangers_beside(path))
            run._check()
        lost = [path.name for path in former if int(path.name[5:]) >= doors and earlier_run.inspected(path)]
        if lost:
            _refuse(
                self.root,
                f"holds inspected doors that a shift of {doors} would remove and not mill anew, {', '.join(lost)}",
            )
        ran = earlier_run.is_shift(self.root)
        _refuse_strangers(self.root, earlier_run.strangers_in(self._kept(), ran))
        _refuse_strangers(self.root, (file for file in self._files() if file.exists() and not ran))
        _refuse_handed_in(alone, (alone.inspections,))
        for path in self._diagnoses():
            _refuse_strangers(self.root, earlier_run.strangers_in_diagnosis(path))

    def _kept(self) -> tuple[Path, ...]:
        return self.run(0).inspections, self.controller.parent

    def _files(self) -> tuple[Path, ...]:
        return self.summary, RunFolder(self.root).parameters

    def _diagnoses(self) -> list[Path]:
        """What `diagnose` said of the doors that go."""
        return [path for path in (self.root / name for name in DIAGNOSES) if earlier_run.is_diagnosis(path)]

    def _prepare(self) -> None:
        for path in (*self._diagnoses(), *earlier_run.doors(self.root), *self._kept()):
            if path.exists():
                shutil.rmtree(path)
        # These last: by them a folder that is half removed is still known for a shift's.
        for file in self._files():
            file.unlink(missing_ok=True)
        self.controller.mkdir(parents=True)


def _refuse_strangers(root: Path, strangers: Iterator[Path]) -> None:
    stranger = next(strangers, None)
    if stranger is not None:
        _refuse(root, f"holds {stranger}, which no run of the cell has left there")


def _refuse_handed_in(run: RunFolder, folders: tuple[Path, ...]) -> None:
    for folder in folders:
        for path in earlier_run.handed_in(folder, run.controller.parent):
            _refuse_measured(run.root, path)


def _refuse_measured(root: Path, path: Path) -> NoReturn:
    _refuse(
        root,
        f"holds an inspection that somebody measured (the simulated gauge has not noted it as its own), {path}, and "
        "a new run would remove it",
    )


def _refuse(root: Path, why: str) -> NoReturn:
    raise BadParameterError(f"folder {root} {why}; name another one, or move away what is in it")


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
