"""Benches, scripts and the making of bags still find what they import; `make` names files that are there."""

from __future__ import annotations

import ast
import importlib
import re
from pathlib import Path

import pytest

from support.source_tree import ROOT

OWN = ("doormill_ros.", "support.", "bags.", "scripts.")
FILES = sorted(path for folder in ("bench", "bags", "scripts") for path in (ROOT / folder).glob("*.py"))


def own_names(path: Path) -> list[tuple[str, str]]:
    """Module and name of everything a file takes from this repository."""
    return [
        (node.module, alias.name)
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.ImportFrom) and f"{node.module}.".startswith(OWN)
        for alias in node.names
    ]


def missing(names: list[tuple[str, str]]) -> list[str]:
    found = []
    for module, name in names:
        try:
            if not hasattr(importlib.import_module(module), name):
                importlib.import_module(f"{module}.{name}")
        except ImportError:
            found.append(f"{module}.{name}")
    return found


def test_the_files_take_much_from_the_repository() -> None:
    assert sum(len(own_names(path)) for path in FILES) > 100
    bad = [("doormill_ros.units", "FURLONG"), ("doormill_ros.nowhere", "x"), ("doormill_ros", "units")]
    assert missing(bad) == ["doormill_ros.units.FURLONG", "doormill_ros.nowhere.x"]


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.name)
def test_what_a_file_takes_is_there(path: Path) -> None:
    assert missing(own_names(path)) == []


def test_make_names_files_that_are_there() -> None:
    named = re.findall(r"(?:bench|scripts|requirements)/[\w.-]+", (ROOT / "Makefile").read_text("utf-8"))
    assert len(named) >= 6
    assert [name for name in named if name.count(".") and not (ROOT / name).is_file()] == ["bench/bench.json"]
