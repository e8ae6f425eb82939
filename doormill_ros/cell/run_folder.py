"""Where a run of the cell puts what it makes."""

from __future__ import annotations

import shutil
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class RunFolder:
    """Paths below one run's output folder."""

    root: Path

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
        return self.root / "controller" / "HOME"

    @property
    def report(self) -> Path:
        """The report."""
        return self.root / "report.html"

    @property
    def summary(self) -> Path:
        """summary.json."""
        return self.root / "summary.json"

    def prepare(self) -> None:
        """Make the folder; what a former run left under these names is removed, nothing else."""
        for path in (self.bag, self.targets, self.controller.parent):
            if path.exists():
                shutil.rmtree(path)
        for path in (self.report, self.summary):
            path.unlink(missing_ok=True)
        self.controller.mkdir(parents=True)


def point_latest(root: Path, latest: Path) -> None:
    """Let the symbolic link `latest` name the newest run's folder."""
    link = latest.with_name(latest.name + ".new")
    link.unlink(missing_ok=True)
    link.symlink_to(root.resolve().relative_to(latest.parent.resolve()))
    link.replace(latest)
