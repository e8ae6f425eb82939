"""Every kind of feature by the name that recipes give it; a new kind is one file beside this and one line here."""

from __future__ import annotations

from collections.abc import Iterator
from importlib import import_module

from doormill_ros.recipes.features.base import Feature
from doormill_ros.recipes.features.time_budget import TimeBudget

MODULES = (
    "hinge_pocket",
    "lock_case",
    "face_plate",
    "handle_hole",
)


def _kinds(name: str) -> Iterator[type[Feature]]:
    """The features that a module defines, in its order; those without a kind are bases of others."""
    module = import_module(f"doormill_ros.recipes.features.{name}")
    own = [
        content for content in vars(module).values() if getattr(content, "__module__", "") == module.__name__
    ]
    for content in own:
        if isinstance(content, type) and issubclass(content, Feature) and "kind" in vars(content):
            yield content


FEATURES: dict[str, type[Feature]] = {kind.kind: kind for name in MODULES for kind in _kinds(name)}


def time_budgets() -> tuple[TimeBudget, ...]:
    """What features count to, each once."""
    return tuple(dict.fromkeys(kind.budget for kind in FEATURES.values() if kind.budget is not None))
