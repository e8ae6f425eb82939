"""Whoever passes an array is told its shape: by the function, by one that it overrides, or by one that it names."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from support.source_tree import PACKAGE, SOURCES

ARRAYS = {"FloatArray", "Float32Array", "IntArray", "BoolArray", "ByteArray", "NDArray"}
#: "shape", or a tuple of sizes such as (n, 3), (6,) or (..., 4, 4).
SHAPE = re.compile(r"\bshapes?\b|\((?:\.\.\.|[\w +*/]+), ?(?:[\w +*/]+(?:, ?[\w +*/]+)*)?\)")


@dataclass(frozen=True)
class Function:
    """A public function or method whose signature has an array."""

    where: str
    owner: str
    name: str
    docstring: str


def has_array(function: ast.FunctionDef) -> bool:
    """Whether a parameter or the result is an array."""
    arguments = [*function.args.posonlyargs, *function.args.args, *function.args.kwonlyargs]
    annotations = [a.annotation for a in arguments if a.annotation] + [r for r in [function.returns] if r]
    return any(isinstance(n, ast.Name) and n.id in ARRAYS for a in annotations for n in ast.walk(a))


def functions_of(tree: ast.Module, where: str) -> Iterator[Function]:
    """Public functions and methods of public classes with arrays in them."""
    for node in tree.body:
        owner, body = (node.name, node.body) if isinstance(node, ast.ClassDef) else ("", [node])
        if owner.startswith("_"):
            continue
        for item in body:
            if isinstance(item, ast.FunctionDef) and not item.name.startswith("_") and has_array(item):
                yield Function(f"{where}:{item.lineno}", owner, item.name, ast.get_docstring(item) or "")


def bases_of(trees: dict[str, ast.Module]) -> dict[str, set[str]]:
    """Names of the classes that a class is made from, by its own name."""
    found: dict[str, set[str]] = {}
    for tree in trees.values():
        for node in ast.walk(tree):
            if isinstance(node, ast.ClassDef):
                names = {b.id for b in node.bases if isinstance(b, ast.Name)}
                generic = [b.value for b in node.bases if isinstance(b, ast.Subscript)]
                names |= {b.id for b in generic if isinstance(b, ast.Name)}
                found.setdefault(node.name, set()).update(names)
    return found


def silent(trees: dict[str, ast.Module]) -> list[str]:
    """Functions with arrays that nothing tells the shape of."""
    functions = [f for where, tree in trees.items() for f in functions_of(tree, where)]
    told = {(f.owner, f.name) for f in functions if SHAPE.search(f.docstring)}
    bases = bases_of(trees)

    def inherits(owner: str, name: str) -> bool:
        return any(
            (base, name) in told or inherits(base, name) for base in bases.get(owner, ()) if base != owner
        )

    def refers(docstring: str) -> bool:
        names = [word.rpartition(".")[::2] for word in re.findall(r"`([\w.]+)`", docstring)]
        return any(name == f[1] and owner in ("", f[0]) for owner, name in names for f in told)

    return [
        f"{f.where} {f.owner}.{f.name}".replace(" .", " ")
        for f in functions
        if not (SHAPE.search(f.docstring) or inherits(f.owner, f.name) or refers(f.docstring))
    ]


def test_the_scan_sees_what_is_missing() -> None:
    text = '''
class Base:
    def load(self, q: FloatArray) -> float:
        """Of joint angles, shape (n, 6) [rad]."""

class Leaf(Base):
    def load(self, q: FloatArray) -> float:
        """As a spring."""

    def twist(self) -> FloatArray:
        """Of the tool (small)."""

def place(T: FloatArray) -> None:
    """Put it at T, (4, 4)."""
'''
    assert silent({"example.py": ast.parse(text)}) == ["example.py:10 Leaf.twist"]


def test_every_public_function_with_arrays_tells_their_shapes() -> None:
    trees = {
        str(Path(path).relative_to(PACKAGE)): ast.parse(path.read_text(encoding="utf-8")) for path in SOURCES
    }
    assert sum(1 for where, tree in trees.items() for _ in functions_of(tree, where)) > 300
    assert silent(trees) == []
