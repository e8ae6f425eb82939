"""Where something without a name acts and what drives it, in the words of diagnosis.json."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from doormill_ros.robot_model.law.term import Term


@dataclass(frozen=True)
class LawPlace:
    """Where a term acts, what drives it, and what is off there."""

    where: str
    driver: str
    acts_on: str

    @property
    def key(self) -> tuple[str, str]:
        """What tells two effects apart."""
        return self.where, self.driver


#: Of any candidate of a kind of data.
Places = Callable[[Any], LawPlace]


def place_of(term: Term[Any]) -> LawPlace:
    """Of a term; two readings of one driver are one."""
    return LawPlace(term.where, term.driver.partition(" (")[0], term.acts_on)
