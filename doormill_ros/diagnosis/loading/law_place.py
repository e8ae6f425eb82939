"""Where a cause of a loading test would act that is a part of a law without a name."""

from __future__ import annotations

from doormill_ros.diagnosis.law.place import LawPlace
from doormill_ros.diagnosis.law.place import place_of as of_term
from doormill_ros.robot_model.elastic.causes.cause import ElasticCause
from doormill_ros.robot_model.elastic.law.term import LawTerm


def place_of(term: ElasticCause) -> LawPlace:
    """Of a term, or of a cause that is not believed."""
    if isinstance(term, LawTerm):
        return of_term(term)
    where = f"{term.acts_in} {term.where}" if term.places is None else term.acts_in or term.where
    return LawPlace(where, term.driver, term.name.replace("_", " "))
