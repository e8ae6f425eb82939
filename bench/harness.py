"""Time two callables in alternation in one process and write the comparison as one entry."""

from __future__ import annotations

import json
import statistics
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path

ALLOWED = "allowed"  # the peer of an entry that must not be above it


@dataclass(frozen=True)
class Entry:
    """One line of bench.json; `ratio` is peer over ours, larger is better."""

    name: str
    median: float
    unit: str
    peer: str
    peer_median: float
    ratio: float
    n: int


def entry(name: str, median: float, unit: str, peer: str, peer_median: float, n: int) -> Entry:
    """An entry with its ratio, from medians measured elsewhere."""
    return Entry(name, float(median), unit, peer, float(peer_median), float(peer_median) / float(median), n)


def limit(name: str, value: float, unit: str, allowed: float, n: int) -> Entry:
    """An entry that fails the bench when `value` is above what is allowed."""
    return entry(name, value, unit, ALLOWED, allowed, n)


def exceeded(item: Entry) -> bool:
    """Whether an entry made by `limit` is above what is allowed."""
    return item.peer == ALLOWED and not item.median <= item.peer_median


def compare(
    name: str, ours: Callable[[], object], peer_name: str, peer: Callable[[], object], n: int = 7
) -> Entry:
    """Run ours and the peer alternately `n` times after one warm-up each; medians in seconds."""
    times: dict[str, list[float]] = {"ours": [], "peer": []}
    ours()
    peer()
    for _ in range(n):
        for key, call in (("ours", ours), ("peer", peer)):
            start = time.perf_counter()
            call()
            times[key].append(time.perf_counter() - start)
    return entry(name, statistics.median(times["ours"]), "s", peer_name, statistics.median(times["peer"]), n)


def write(entries: list[Entry], path: Path) -> None:
    """Write bench.json."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps([asdict(e) for e in entries], indent=2) + "\n", encoding="utf-8")
