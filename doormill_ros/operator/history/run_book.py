"""Runs that ended and how their doors came out, on the page and in its file; which is told first is open."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

from doormill_ros.cell.output.inspection import MeasuredDoor
from doormill_ros.operator.history.history import append_history, kept_run, load_history
from doormill_ros.operator.views.ended_run import EndedRun
from doormill_ros.operator.views.view_store import ViewStore


class RunBook:
    """Enters ends of runs and what was measured of their doors."""

    def __init__(self, store: ViewStore, folder: Path) -> None:
        """Show the last runs that a folder keeps."""
        self._store, self._folder = store, folder
        self._in_cell = ""  # run whose door was measured in the cell last
        self._run_id, self._found, self._at = "", MeasuredDoor(), 0.0  # what was measured last
        store.update(lambda view: view.with_history(load_history(folder)))

    def ended(self, run: EndedRun) -> None:
        """A run ended.

        Raises:
            OSError: The file cannot be written.
        """
        run = replace(run, in_cell=run.measured and run.run_id == self._in_cell)
        known = any(one.run_id == run.run_id for one in self._store.view.history)
        self._store.update(lambda view: view.with_ended(run))
        if not known:
            append_history(self._folder, run)
            if self._run_id == run.run_id:
                self._amend()

    def measured_in_cell(self, run_id: str, door: MeasuredDoor, worst: Mapping[str, float]) -> None:
        """A door was measured in the cell, by the worst points of its features [m].

        Raises:
            OSError: The file cannot be written.
        """
        self._in_cell = run_id
        self._enter(run_id, door, 0.0, worst)

    def gauged(self, run_id: str, door: MeasuredDoor, at: float, worst: Mapping[str, float]) -> None:
        """A gauge measured a door at a time [s since the epoch], by the worst points of its features [m].

        Raises:
            OSError: The file cannot be written.
        """
        if run_id != self._in_cell:  # else who measured in the cell has told more, and the result holds it
            self._enter(run_id, door, at, worst)

    def _enter(self, run_id: str, door: MeasuredDoor, at: float, worst: Mapping[str, float]) -> None:
        self._run_id, self._found, self._at = run_id, door, at
        allowed = door.tolerance if math.isfinite(door.tolerance) else 0.0
        self._store.update(lambda view: view.with_measured(run_id, dict(worst), allowed))
        self._amend()

    def _amend(self) -> None:
        """Say of the run that was measured last how its door came out; its result may come before or after."""
        found = self._found, self._at, self._run_id == self._in_cell
        before = self._store.view.history
        self._store.update(lambda view: view.with_inspection(self._run_id, *found))
        amended = set(self._store.view.history) - set(before)
        if self._run_id != self._store.view.run_id and all(run.run_id != self._run_id for run in before):
            # It ended so long ago that the page shows it no more.
            kept = kept_run(self._folder, self._run_id)
            amended |= {kept.found(*found)} - {kept} if kept else set()
        for run in amended:
            append_history(self._folder, run)
