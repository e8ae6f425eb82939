"""The source files and what they import."""

from __future__ import annotations

import ast
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PACKAGE = ROOT / "doormill_ros"
DATA = ROOT / "test" / "data"
SOURCES = sorted(PACKAGE.rglob("*.py"))
#: Functions that import the module which their first argument names.
LATE = ("import_module", "late_class", "late_rig")


def imports_of(path: Path) -> set[str]:
    """Full names of all modules a file imports, wherever it does so."""
    found: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found.update(alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path} uses a relative import"
            found.add(node.module)
        elif isinstance(node, ast.Call) and _name(node.func) in LATE and node.args:
            first = node.args[0]
            if isinstance(first, ast.Constant) and isinstance(first.value, str):
                found.add(first.value)  # an optional dependency, or one that takes long
    return found


def _name(function: ast.expr) -> str:
    """The last part of what is called."""
    return getattr(function, "attr", getattr(function, "id", ""))
