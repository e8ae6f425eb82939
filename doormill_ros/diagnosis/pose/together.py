"""What series of poses need to be asked together, told before anything is fitted."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.diagnosis.pose.fitting.fit import BLOCKS
from doormill_ros.diagnosis.pose.fitting.placement import rows_needed
from doormill_ros.measurements.errors import PosePlacementError, PoseTableError, SetMixError
from doormill_ros.measurements.sets.pose_set import PoseSet, placement_owners

_SAME = 1e-6  #: joint angles nearer than this are one [rad]


def check_together(sets: Sequence[PoseSet]) -> None:
    """Sets that are given together have to question the same model.

    Raises:
        SetMixError: They do not.
    """
    first = sets[0]
    for other in sets[1:]:
        for name, mine, theirs in (("robot", first.robot, other.robot), ("model.dh", first.dh, other.dh)):
            if not np.array_equal(mine, theirs):
                raise SetMixError(
                    f"{other.path / 'set.yaml'}: line 1, column 1: {name} is not the one in {first.path}; "
                    "sets given together need the same"
                )


def check_names(sets: Sequence[PoseSet]) -> None:
    """What befell one series alone is told, and fitted, by its name.

    Raises:
        SetMixError: Two have the same.
    """
    known: dict[str, PoseSet] = {}
    for data in sets:
        other = known.setdefault(data.name, data)
        if other is not data:
            raise SetMixError(
                f"{data.path / 'set.yaml'}: line 1, column 1: the folder is called {data.name} as {other.path} is; "
                "sets diagnosed together are told apart by that name: rename one of the folders"
            )


def check_rows(sets: Sequence[PoseSet]) -> None:
    """A series that is diagnosed has a posture at least in every block that is left out.

    Raises:
        PoseTableError: One has fewer.
    """
    for data in sets:
        if (count := _postures(data.q)) < BLOCKS:
            table = data.path / "poses.csv"
            raise PoseTableError(
                f"{table}: line {len(data) + 1}, column row: the table holds {len(data)} rows of {count} postures, a "
                f"series that is diagnosed needs {BLOCKS} at least, since blocks of them are left out in turn: measure "
                "more poses, or give the set as one to check",
                path=str(table),
                line=len(data) + 1,
                column="row",
            )


def check_marked(sets: Sequence[PoseSet], others: Sequence[PoseSet]) -> None:
    """A series that is checked is placed by its marked rows, and by those of others with the same placement.

    Args:
        sets: That are diagnosed: what has the placement of one of them needs no rows of its own.
        others: That are checked.

    Raises:
        PosePlacementError: One has too few of them.
    """
    owner = placement_owners([*sets, *others])[len(sets) :]
    for mine in sorted({own for own in owner if own >= len(sets)}):
        company = [one for one, own in zip(others, owner, strict=True) if own == mine]
        count = sum(_postures(one.q[one.placement]) for one in company)
        needed = rows_needed(any(one.oriented for one in company))
        if count < needed:
            table = company[0].path / "poses.csv"
            raise PosePlacementError(
                f"{table}: line 1, column placement: {count} different postures are marked with placement 1, a set "
                f"that is checked is placed by {needed} at least; mark more rows",
                path=str(table),
                line=1,
                column="placement",
            )


def _postures(q: FloatArray) -> int:
    """How many different postures rows have, joint angles of shape (n, J) [rad]."""
    return len(np.unique(np.round(q / _SAME), axis=0))
