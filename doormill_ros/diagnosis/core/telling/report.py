"""report.html: one page that shows why a diagnosis should be believed, for every kind of data.

What every kind has stands in one order; between it stands what a kind shows itself: `evidence` after the causes,
`candidates` below their heading, `next_blocks` below the sentence on what to measure, `closing` at the end.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from doormill_ros.diagnosis.core.telling.account import Account, NamedCause
from doormill_ros.diagnosis.core.words.margin import margins_table
from doormill_ros.diagnosis.core.words.verdict import CONSISTENT, EXPLAINED, UNEXPLAINED
from doormill_ros.diagnosis.core.words.wording import spoken, verdict_sentence, with_deviation
from doormill_ros.pages.page import Block, Page, PageSection, Paragraphs, Table, Tiles, render
from doormill_ros.robot_model.candidate import Cause

_PARAMETERS = 6  #: that are listed of one cause, the largest first where there are more
_NUMBERS = 12  #: that are listed of one parameter


def render_report(account: Account) -> str:
    """The page as HTML text without any outside resource."""
    sections = [PageSection("", [_tiles(account), Paragraphs(account.remarks, note=True)])]
    if account.causes:
        sections.append(PageSection("Causes", _causes(account)))
    sections += [
        *account.evidence,
        *([PageSection("Candidates", account.candidates)] if account.candidates else []),
        PageSection("What cannot be told apart", _confusable(account)),
        PageSection("What to measure next", [Paragraphs([account.next_measurement]), *account.next_blocks]),
    ]
    if account.margins:
        sections.append(PageSection("How close the decisions were", [margins_table(account.margins)]))
    if account.outliers:
        listed = ", ".join(map(str, account.outliers))
        rows = account.words.rows.capitalize()
        sentence = f"{rows} {listed} are gross errors; they steer no fit and count in no figure."
        sections.append(PageSection("Gross errors", [Paragraphs([sentence])]))
    if account.checks:
        sections.append(PageSection("Sets that were only predicted", [_checks(account)]))
    sections += [*account.closing, PageSection("How this was found", [Paragraphs([account.words.method])])]
    lead = verdict_sentence(account.verdict, account.words)
    return render(Page(_headline(account), sections, lead))


def _headline(account: Account) -> str:
    """The verdict in one line."""
    model, called = account.words.model, account.words.noise
    before, after, floor = (
        account.unit.spoken(value)
        for value in (account.baseline["holdout_rmse"], account.extended["holdout_rmse"], account.noise_floor)
    )
    against = "" if account.unit.relative else f" against {floor} of {called}"
    if account.verdict == CONSISTENT:
        noise = "" if account.unit.relative else f", the {called} is {floor}"
        return f"Consistent: the {model} is off by {before}{noise}"
    if account.verdict == UNEXPLAINED:
        return f"Unexplained: the {model} is off by {before}{against}"
    word = "Explained" if account.verdict == EXPLAINED else "Partly explained"
    noise = "" if account.unit.relative else f", {called} {floor}"
    return f"{word}: {account.headline} ({before} down to {after}{noise})"


def _tiles(account: Account) -> Tiles:
    low, high = account.ratio_ci
    unit, words = account.unit, account.words
    entries = [
        (unit.spoken(account.baseline["holdout_rmse"]), f"{words.model} now"),
        (str(account.rows), f"{words.rows}, {len(account.outliers)} of them gross errors"),
        *account.tiles,
    ]
    if not unit.relative:
        entries[1:1] = [(unit.spoken(account.noise_floor), words.noise_alone)]
    if account.causes:
        entries[1:1] = [
            (unit.spoken(account.extended["holdout_rmse"]), f"extended model on unseen {words.unseen}"),
            (
                f"{100 * account.ratio:.0f} %",
                f"of the {words.residual} left (95 %: {100 * low:.0f} to {100 * high:.0f} %)",
            ),
        ]
    return Tiles(entries)


def _causes(account: Account) -> list[Block]:
    rows = []
    for cause in account.causes:
        entries = list(cause.parameters.items())
        if len(entries) > _PARAMETERS:
            entries = sorted(entries, key=lambda item: -float(np.abs(item[1]["value"]).max()))[:_PARAMETERS]
        for name, entry in entries:
            rows.append(
                [cause.words, name.replace("_", " "), _figure(entry), account.unit.spoken(cause.without)]
            )
        if len(cause.parameters) > len(entries):
            rows.append([cause.words, f"{len(cause.parameters) - len(entries)} smaller ones", "", ""])
    head = (
        "Cause", "Parameter", "Value ± standard deviation", f"Held-out {account.words.held_out} without the cause",
    )  # fmt: skip
    return [
        Table(head, rows),
        Paragraphs(["The true value lies within two standard deviations 95 times of 100."]),
    ]


def _figure(entry: Any) -> str:
    values, stds = (np.atleast_1d(entry[key]).tolist()[:_NUMBERS] for key in ("value", "std"))
    if entry["unit"] == "-":  # a count: row numbers and the like
        return ", ".join(f"{value:g}" for value in values)
    return with_deviation(values, stds, entry["unit"])


def _confusable(account: Account) -> list[Block]:
    rows = [
        [named.words, _double(named, double.cause), _apart(double.behind, double.tied)]
        for named in account.causes
        for double in named.doubles
    ]
    if not account.causes:
        return [Paragraphs(["No cause is named, so there is none that another could be taken for."])]
    if not rows:
        return [Paragraphs(["Every established cause is told apart from all others by these data."])]
    return [Table(("Named", "Would do as well", "What the data say for the first"), rows)]


def _double(named: NamedCause, other: Cause) -> str:
    same = (named.cause, named.where) == other.key
    return f"the same, {other.variant}" if same and other.variant else spoken(other)


def _apart(behind: float | None, tied: bool) -> str:
    if tied:
        return "nothing: the two are tied"
    return "little: their effects overlap" if behind is None else f"{behind:.1f} of score"


def _checks(account: Account) -> Table:
    rows = [
        [
            str(one["set"]),
            str(one["rows"]),
            account.unit.spoken(one["baseline"]["rmse"]),
            account.unit.spoken(one["extended"]["rmse"]),
        ]
        for one in account.checks
    ]
    return Table(("Set", account.words.rows.capitalize(), "Now", "Extended"), rows)
