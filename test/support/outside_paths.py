"""Find paths in a file that lead out of the repository."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path, PurePosixPath

#: Levels below the root that the names of `support.source_tree` stand at.
KNOWN = {"ROOT": 0, "PACKAGE": 1, "DATA": 2}
_UP = re.compile(r"(?<![\w.])\.\.(?:/\.\.)*(?=/|[\"'`\s)]|$)")
_UP_STRING = re.compile(r"(?<![\w.])\.\./|/\.\.(?![\w.])")
_LINK = re.compile(r"\]\(([^)\s]+)\)")
_PLACE = re.compile(r"(?<![\w.}/:-])(?:~|/(?:home|root|mnt|media|srv|work|opt|usr|var|tmp|Users))/[\w./*-]*")


def leading_out(root: Path, path: Path) -> list[str]:
    """What in a file leads out of the repository.

    Args:
        root: Of the repository.
        path: A text file in it.

    Returns:
        A sentence each: `..` above the root, `parents` above the root, places of one machine.
    """
    below = path.relative_to(root).parts
    text = re.sub(r"\A#!.*", "", path.read_text(encoding="utf-8"))
    if path.suffix == ".py":
        found = list(dict.fromkeys(_of_python(ast.parse(text), len(below))))
        return [leak for leak in found if not _is_beside(root, path, leak)]
    found = []
    links = _LINK.findall(text) if path.suffix == ".md" else []
    for link in links:
        if _lowest(link, len(below) - 1) < 0:
            found.append(f"link {link}")
    # A command in a document is typed at the root; a script starts from its own folder.
    allowed = 0 if path.suffix == ".md" else len(below) - 1
    for up in _UP.findall(_LINK.sub("", text)):
        if up.count("..") > allowed:
            found.append(f"path {up}")
    return found + [f"place {place}" for place in _PLACE.findall(text)]


def _is_beside(root: Path, path: Path, leak: str) -> bool:
    """Whether a string names a file of the repository as seen from the file it stands in."""
    match = re.fullmatch(r"string '((?:\.\./)+[\w/.-]{1,200})'", leak)
    named = (path.parent / match[1]).resolve() if match else root.parent
    return named.is_relative_to(root) and named.is_file()


def _of_python(tree: ast.Module, depth: int) -> Iterator[str]:
    names = dict(KNOWN)
    for node in ast.walk(tree):
        if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name):
            level = _level(node.value, names, depth)
            if level is not None:
                names[node.targets[0].id] = level
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and isinstance(node.value, str):
            if _UP_STRING.search(node.value):
                yield f"string {node.value!r}"
            yield from (f"place {place}" for place in _PLACE.findall(node.value))
        elif isinstance(node, ast.expr):
            level = _level(node, names, depth)
            if (level is not None and level < 0) or _joins_up(node):
                yield f"{ast.unparse(node)}"
            if _called(node) in ("home", "expanduser", "expandvars"):
                yield f"{ast.unparse(node)}"


def _level(node: ast.expr, names: dict[str, int], depth: int) -> int | None:
    """How far below the root a path expression points, negative above it, -99 unknown; None: no such expression."""
    if isinstance(node, ast.Name):
        return depth if node.id == "__file__" else names.get(node.id)
    if isinstance(node, ast.Attribute):
        if node.attr == "rootpath":
            return 0
        level = _level(node.value, names, depth)
        return level - 1 if level is not None and node.attr == "parent" else None
    if isinstance(node, ast.Subscript) and getattr(node.value, "attr", "") == "parents":
        level = _level(node.value.value, names, depth)  # type: ignore[attr-defined]  # an Attribute has it
        if level is None:
            return None
        index = node.slice.value if isinstance(node.slice, ast.Constant) else None
        return level - index - 1 if isinstance(index, int) else -99
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Div):
        level = _level(node.left, names, depth)
        if level is None or not isinstance(node.right, ast.Constant):
            return None
        return _lowest(str(node.right.value), level)
    if isinstance(node, ast.Call):
        if _called(node) in ("resolve", "absolute") and isinstance(node.func, ast.Attribute):
            return _level(node.func.value, names, depth)
        if _called(node) == "Path" and len(node.args) == 1:
            return _level(node.args[0], names, depth)
    return None


def _joins_up(node: ast.expr) -> bool:
    """Whether `..` is joined to some path."""
    joined = [node.right] if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Div) else []
    if _called(node) in ("joinpath", "join"):
        joined += node.args  # type: ignore[attr-defined]  # a Call has them
    return any(isinstance(item, ast.Constant) and item.value == ".." for item in joined)


def _lowest(relative: str, level: int) -> int:
    """Level that a relative path ends at, or the first one above the root."""
    for part in PurePosixPath(relative.split("#")[0]).parts:
        level += -1 if part == ".." else 0 if part == "." else 1
        if level < 0:
            return level
    return level


def _called(node: ast.expr) -> str:
    function = node.func if isinstance(node, ast.Call) else None
    return getattr(function, "attr", getattr(function, "id", ""))
