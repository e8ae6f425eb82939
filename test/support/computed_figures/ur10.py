"""What docs/diagnosis-ur10.md says of the measured series."""

from __future__ import annotations

from support.source_tree import DATA


def _rows(name: str) -> int:
    """Poses of a series."""
    return len((DATA / "ur10" / name / "poses.csv").read_text(encoding="utf-8").splitlines()) - 1


def grid() -> int:
    """Poses on a grid."""
    return _rows("grid")


def configurations() -> int:
    """Poses by joint configurations."""
    return _rows("joint-configurations")


def random() -> int:
    """Poses at random."""
    return _rows("random-poses")


def poses() -> int:
    """All of them."""
    return grid() + configurations() + random()
