"""Answers searches in the history, and gives it away as a file; reads only."""

from __future__ import annotations

import asyncio
import json
from dataclasses import asdict
from pathlib import Path
from typing import Annotated

from fastapi import FastAPI, Query, Response
from starlette.concurrency import run_in_threadpool

from doormill_ros.operator.history.history import kept_runs
from doormill_ros.operator.history.history_csv import history_csv
from doormill_ros.operator.history.history_search import Found, search_history
from doormill_ros.operator.languages import Language
from doormill_ros.operator.views.ended_run import EndedRun
from doormill_ros.operator.views.short_text import short
from doormill_ros.operator.views.state import HISTORY
from doormill_ros.operator.views.view_store import ViewStore

LONGEST_SEARCH = 200  # characters
MOST_SHOWN = 200  # runs in an answer to the page

_Search = Annotated[str, Query(max_length=LONGEST_SEARCH)]


def serve_history(app: FastAPI, store: ViewStore, folder: Path | None) -> None:
    """Add `/history` and `/history.csv`.

    Args:
        app: Gets them.
        store: What is shown.
        folder: Where the runs are kept; None: those shown are all.
    """
    # One after the other: however many ask, one file is in memory.
    reading = asyncio.Lock()

    def find(search: str, language: Language) -> Found:
        return search_history(store.view.history, kept_runs(folder), search, language)

    def shown(search: str, language: Language, limit: int) -> str:
        found = find(search, language)
        runs = [_document(run) for run in found.runs[:limit]]
        return json.dumps({"found": len(found.runs), "kept": found.kept, "whole": found.whole, "runs": runs})

    def exported(search: str, language: Language) -> tuple[bytes, str]:
        found = find(search, language)
        return history_csv(found.runs), "history.csv" if found.whole else "history-newest.csv"

    @app.get("/history")
    async def history(
        search: _Search = "",
        limit: Annotated[int, Query(ge=1, le=MOST_SHOWN)] = HISTORY,
        language: Language = "en",
    ) -> Response:
        async with reading:
            content = await run_in_threadpool(shown, search, language, limit)
        return Response(content, media_type="application/json")

    @app.get("/history.csv")
    async def export(search: _Search = "", language: Language = "en") -> Response:
        async with reading:
            content, name = await run_in_threadpool(exported, search, language)
        disposition = {"Content-Disposition": f'attachment; filename="{name}"'}
        return Response(content, media_type="text/csv; charset=utf-8", headers=disposition)


def _document(run: EndedRun) -> dict[str, object]:
    values = {key: short(value) if isinstance(value, str) else value for key, value in asdict(run).items()}
    return {**values, "outcome": run.outcome, "came_to": run.came_to}
