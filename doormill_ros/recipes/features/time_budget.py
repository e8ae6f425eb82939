"""The times that a cell is allowed for features, as the features name them."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class TimeBudget:
    """A time in config/toolpath.yaml to which the time of a kind of feature counts.

    Attributes:
        name: Its key there, under `cycle`.
        words: What all features of a door that count to it are together, `{count}` of them; empty where each is held
            against it by itself.
    """

    name: str
    words: str = ""
