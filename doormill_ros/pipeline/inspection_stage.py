"""The last stage of a run: how the milled door came out, where somebody measures it."""

from __future__ import annotations

from contextlib import suppress

from doormill_ros.cell.errors import CellError
from doormill_ros.cell.output.inspection import MeasuredDoor
from doormill_ros.cell.run.run import Run
from doormill_ros.pipeline.partners import Inspector


def await_inspection(run: Run, inspector: Inspector, limit: float) -> MeasuredDoor:
    """How the milled door came out; one that nobody measures in time is not measured.

    Whoever is started again after the door was milled knows nothing of it and is not waited for.

    Args:
        run: In hand.
        inspector: Who measures milled doors, if anybody does.
        limit: Longest wait [s].
    """
    there = inspector.present
    with suppress(CellError):
        run.wait_until(
            lambda: there.isdisjoint(inspector.present) or inspector.found(run.run_id),
            limit,
            "nobody told how the milled door came out",
        )
    return inspector.found(run.run_id) or MeasuredDoor()
