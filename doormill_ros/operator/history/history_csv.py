"""Ended runs as a table for a spreadsheet."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Iterable
from datetime import UTC, datetime

from doormill_ros.operator.views.ended_run import EndedRun

COLUMNS = ("run_id", "door_id", "ended", "outcome", "error_code", "message", "measured")
# Also behind what divides cells where a spreadsheet's language divides them by semicolons, and the wide forms of the
# signs, which some spreadsheets take for the same.
_FORMULA = re.compile(r"^(?=[\t\r\n])|((?:^|[;\t\r\n])[\s\"]*)(?=[=+\-@\uff1d\uff0b\uff0d\uff20])")


def history_csv(runs: Iterable[EndedRun]) -> bytes:
    """The runs as RFC 4180 in UTF-8, a header first; times in UTC, ISO 8601; `measured` true or false.

    An apostrophe stands before what a spreadsheet would take for a formula.
    """
    table = io.StringIO(newline="")
    writer = csv.writer(table, lineterminator="\r\n")
    writer.writerow(COLUMNS)
    for run in runs:
        ended = datetime.fromtimestamp(run.ended, UTC).isoformat(timespec="milliseconds")
        texts = (harmless(run.run_id), harmless(run.door_id), ended, harmless(run.outcome))
        writer.writerow((*texts, run.error_code, harmless(run.message), str(run.measured).lower()))
    return table.getvalue().encode("utf-8", "replace")


def harmless(text: str) -> str:
    """A text that no spreadsheet calculates."""
    return _FORMULA.sub(lambda found: f"{found.group(1) or ''}'", text)
