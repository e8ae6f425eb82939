"""What docs/diagnosis-ur10.md prints, as Markdown: from diagnosis.json, and from the runs with everything redone."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

UM, MRAD = 1e6, 1e3
#: Orders of a periodic error that are listed: the largest, and beyond so many waves a turn those from a size on [rad].
LARGEST, LINES, LINE = 4, 100.0, 1e-5
#: Narrowest range of angles that is told as never visited [bins].
GAP = 3


@dataclass
class Redone:
    """Diagnoses with everything redone without a part of the rows, and what they left of that part.

    Attributes:
        named: Cause and place of what each of them named, one set a diagnosis.
        errors: Position error of each series' rows that count, shape (n, 3) [m].
    """

    named: list[set[tuple[str, str]]] = field(default_factory=list)
    errors: dict[str, np.ndarray] = field(default_factory=dict)

    def again(self, key: tuple[str, str]) -> int:
        """How many of them named a cause."""
        return sum(key in names for names in self.named)


def rms(errors: Iterable[np.ndarray]) -> float:
    """Root mean square of the length of errors, shape (n, 3) each."""
    return float(np.sqrt(np.mean(np.sum(np.concatenate([*errors]) ** 2, axis=1))))


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table."""
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def verdict(document: Mapping[str, Any]) -> str:
    """Verdict and error before and after."""
    before, after, gain = document["baseline"], document["extended"], document["gain"]
    low, high = gain["ci95"]
    return (
        f"> `{document['verdict']}`: on blocks left out {UM * before['holdout_rmse']:.0f} -> "
        f"{UM * after['holdout_rmse']:.0f} um, rotation {UM * before['rotation_rmse']:.0f} -> "
        f"{UM * after['rotation_rmse']:.0f} urad; the tracker's noise is {UM * document['noise_floor']:.0f} um. "
        f"Share of the error left over: {gain['holdout_rmse_ratio']:.3f} (95 %: {low:.3f} to {high:.3f})."
    )


def errors(document: Mapping[str, Any], blocks: Redone, series: Redone, plain: Redone) -> str:
    """Root mean square of every series, fitted and left out."""
    head = [
        "series",
        "nominal",
        "fitted rows",
        "blocks left out",
        "the same, everything redone",
        "series left out",
        "the same, everything redone",
        "link geometry and sag alone",
    ]
    parts = [(one["set"], one["baseline"], one["extended"]) for one in document["sets"]]
    parts.append(("all", document["baseline"], document["extended"]))
    rows = []
    for name, before, after in parts:
        names = [one["set"] for one in document["sets"]] if name == "all" else [name]
        redone = [rms(kind.errors[one] for one in names) for kind in (blocks, series, plain)]
        told = [before["holdout_rmse"], after["train_rmse"], after["holdout_rmse"], redone[0]]
        told += [after["series_out_rmse"], *redone[1:]]
        rows.append([name, *(f"{UM * one:.0f}" for one in told)])
    listed = document["outliers_by_set"].items()
    gross = "; ".join(f"`{name}` {', '.join(map(str, bad))}" for name, bad in listed)
    return f"{table(head, rows)}\n\nGross errors, in no figure: rows {gross or 'none'}."


def causes(document: Mapping[str, Any], blocks: Redone, series: Redone) -> str:
    """Established causes, what the error is without them, and how many of the repeated diagnoses name them."""
    head = ["cause", "where", "size", "error without it", "named again"]
    rows, known = [], set()
    for one in document["causes"]:
        if one["cause"] == "gross_error":
            continue
        key = one["cause"], one["where"]
        known.add(key)
        again = f"{blocks.again(key)} of {len(blocks.named)}, {series.again(key)} of {len(series.named)}"
        rows.append([*key, size(one), f"{UM * one['holdout_rmse_without']:.0f}", again])
    others = sorted(set().union(*blocks.named, *series.named) - known)
    some = "; ".join(
        f"{name} {where} {blocks.again((name, where))} of {len(blocks.named)}, "
        f"{series.again((name, where))} of {len(series.named)}"
        for name, where in others
    )
    return f"{table(head, rows)}\n\nNamed in some of the repeated runs only: {some or 'none'}."


def size(cause: Mapping[str, Any]) -> str:
    """What a cause amounts to."""
    parameters = cause["parameters"]
    if cause["cause"] == "joint_periodic_error":
        waves = {int(name.removeprefix("order_")): one["value"] for name, one in parameters.items()}
        return _waves(waves)
    if cause["cause"] == "link_geometry":
        return ", ".join(
            f"{name} {round(MRAD * one['value'], 2) + 0.0:.2f} {'mrad' if one['unit'] == 'rad' else 'mm'}"
            for name, one in parameters.items()
        )
    return ", ".join(f"{name} {_amount(one)}" for name, one in parameters.items())


def _amount(one: Mapping[str, Any]) -> str:
    small = one["unit"].startswith(("rad", "m"))
    factor, unit = (UM, f"u{one['unit']}") if small else (1.0, one["unit"])
    return ", ".join(
        f"{_digits(factor * value)} ± {_digits(factor * std)} {unit}"
        for value, std in zip(np.atleast_1d(one["value"]), np.atleast_1d(one["std"]), strict=True)
    )


def _digits(value: float) -> str:
    return f"{value:.{0 if abs(value) >= 100.0 else 1}f}"


def _waves(waves: Mapping[int, float]) -> str:
    whole = np.sqrt(0.5 * sum(one**2 for one in waves.values()))
    first = sorted(waves, key=lambda order: -waves[order])[:LARGEST]
    lines = sorted(order for order, one in waves.items() if order > LINES and one >= LINE)
    text = f"{UM * whole:.0f} urad rms; largest: " + ", ".join(_wave(waves, order) for order in first)
    return text + ("; lines: " + ", ".join(_wave(waves, order) for order in lines) if lines else "")


def _wave(waves: Mapping[int, float], order: int) -> str:
    return f"order {order} {UM * waves[order]:.0f}"


def refused(document: Mapping[str, Any]) -> str:
    """Causes that help somewhere and are not named."""
    entries = document["only_within_one_series"] + [
        one for one in document["rejected"] if "does not help" not in one["why"]
    ]
    names = ", ".join(one["set"] for one in document["sets"])
    return table(
        ["cause", "where", f"gain on blocks ({names})", "gain on series left out", "why it is not named"],
        (
            [
                one["cause"],
                one["where"],
                ", ".join(f"{gain:.0f}" for gain in one["gain_by_series"]),
                ", ".join(f"{gain:.0f}" for gain in one["gain_with_series_left_out"]),
                one["why"],
            ]
            for one in entries
        ),
    )


def certainty(document: Mapping[str, Any]) -> str:
    """What was expected of rows that no fit had seen, and what came."""
    return table(
        ["left out", "series", "expected", "came", "inside intervals of 95 %"],
        (
            [
                part.removesuffix("_left_out"),
                one["set"],
                f"{UM * one['expected_rmse']:.0f}",
                f"{UM * one['rmse']:.0f}",
                f"{100.0 * one['within_95']:.0f} %",
            ]
            for part, entries in document["certainty"].items()
            for one in entries
        ),
    )


def unvisited(document: Mapping[str, Any], outside: Mapping[str, Mapping[str, float]], bins: int) -> str:
    """Angles that no series visited, and rows of each where none of the others was."""
    rows = []
    for one in document["coverage"]:
        joint = f"joint {one['joint']}"
        alone = ", ".join(
            f"{name} {100.0 * shares[joint]:.0f} %"
            for name, shares in outside.items()
            if shares[joint] > 5e-3
        )
        rows.append([joint, ", ".join(_gaps(one["ranges"], bins)) or "none", alone or "none"])
    return table(["", "never visited [deg]", "rows where no other series was"], rows)


def _gaps(ranges: Sequence[Sequence[float]], bins: int) -> list[str]:
    unit = 2.0 * np.pi / bins
    seen = np.zeros(bins, dtype=bool)
    for low, high in ranges:
        seen[round((low + np.pi) / unit) : round((high + np.pi) / unit)] = True
    edges = np.flatnonzero(np.diff(np.concatenate([[True], seen, [True]]).astype(int))).reshape(-1, 2)
    return [
        f"{low * 360 / bins - 180:.0f} to {high * 360 / bins - 180:.0f}"
        for low, high in edges
        if high - low >= GAP
    ]


def warming(blocks: Redone, first: int) -> str:
    """Mean error of the first rows of every series, left out with their block, and of the others."""
    return table(
        ["series", f"first {first} rows", "the others"],
        (
            [name, *(f"{UM * np.linalg.norm(part.mean(axis=0)):.0f}" for part in (one[:first], one[first:]))]
            for name, one in blocks.errors.items()
        ),
    )
