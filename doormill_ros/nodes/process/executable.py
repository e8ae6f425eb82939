"""Starts the executables of nodes without the collector's rounds: what is loaded stays.

While modules are loaded it would go over tens of thousands of objects time and again, a twentieth of a start.
"""

from __future__ import annotations

import gc
import importlib
from collections.abc import Callable
from functools import partial


def __getattr__(name: str) -> Callable[[], int]:
    """What runs the executable of that name."""
    if name.startswith("_"):
        raise AttributeError(f"{__name__} has no {name}")
    return partial(run, name)


def run(name: str) -> int:
    """Load a module of `doormill_ros.nodes` and run it; returns its exit status."""
    gc.disable()
    module = importlib.import_module(f"doormill_ros.nodes.{name}")
    # What loading left behind is little; to look for it takes longer than what it did.
    gc.freeze()
    gc.enable()
    status: int = module.main()
    return status
