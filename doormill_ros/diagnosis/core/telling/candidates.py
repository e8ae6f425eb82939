"""The candidates with their held-out scores, as a table."""

from __future__ import annotations

from typing import Any

from doormill_ros.diagnosis.core.diagnosis import Diagnosis
from doormill_ros.diagnosis.core.fitting.fit import Fit
from doormill_ros.diagnosis.core.searching.beam import ENTRY
from doormill_ros.diagnosis.core.words.verdict import rmse
from doormill_ros.diagnosis.core.words.wording import Words, spoken
from doormill_ros.pages.charts import BLUE, GREEN, GREY, RED
from doormill_ros.pages.page import Bar, Block, Paragraphs, Table

ROWS = 12  #: models that are listed


def candidates_table(diagnosis: Diagnosis[Any, Any], words: Words) -> list[Block]:
    """The best models in the order of their scores; the model as it is stands last.

    Models with more members than the best are left out and counted: none of them gained enough,
    or it would be the best.
    """
    search, best = diagnosis.search, diagnosis.best
    fits = sorted(search.fits.values(), key=lambda found: (found is not best, search.total(found)))
    larger = [found for found in fits if len(found.members) > len(best.members)]
    listed = [found for found in fits if found not in larger][: ROWS - 1]
    if diagnosis.extended not in listed:
        listed[-1] = diagnosis.extended
    if diagnosis.baseline not in listed:
        listed.append(diagnosis.baseline)
    size = {id(f): rmse(f.held_out, diagnosis.kept, diagnosis.problem.components) for f in listed}
    longest = max(size.values())
    rows: list[list[str | Bar]] = []
    for found in listed:
        names = " + ".join(map(spoken, found.members)) or f"the {words.model} as it is"
        residual = size[id(found)]
        rows.append(
            [
                names,
                _remark(diagnosis, found),
                Bar(
                    diagnosis.problem.unit.spoken(residual),
                    residual / max(longest, 1e-30),
                    _colour(diagnosis, found),
                ),
                str(round(search.total(found) - search.total(best))),
            ]
        )
    note = (
        f"{len(fits)} models were fitted. The score is the squared error on {words.unseen} left out, in standard "
        f"deviations, plus a price for every fitted number; a cause has to gain {ENTRY:.0f}."
    )
    if larger:
        note += f" {len(larger)} models with more members than the first line gain less than that."
    head = ("Model", "", f"Held-out {words.held_out}", "Score behind the best")
    marked = next((i for i, found in enumerate(listed) if found is best), None)
    return [Table(head, rows, marked, "models"), Paragraphs([note])]


def _remark(diagnosis: Diagnosis[Any, Any], found: Fit[Any]) -> str:
    if found is diagnosis.extended and found.members:
        return "named"
    if not found.members:
        return "now"
    if not all(member.named for member in found.members):
        return "with a shape that is no cause"
    own = {finding.cause.key: finding for finding in diagnosis.findings}
    keys = {member.key for member in found.members}
    left, new = set(own) - keys, keys - set(own)
    if len(left) == 1 and len(new) == 1:
        rivals = {cause.key for cause in own[left.pop()].confusable}
        if new <= rivals:
            return "would do as well"
    return "best fit, not believed" if found is diagnosis.best else ""


def _colour(diagnosis: Diagnosis[Any, Any], found: Fit[Any]) -> str:
    if found is diagnosis.extended and found.members:
        return GREEN
    if not found.members:
        return RED
    return BLUE if all(member.named for member in found.members) else GREY
