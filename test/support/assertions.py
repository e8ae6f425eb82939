"""Which tests are sure to assert something, read from their source.

A test whose only assertions stand in a loop passes when the loop runs zero times. A loop is sure to run when its
length stands in the source: a literal, an upper-case constant (one that the tests define: by its own value), a
range of constants, and what keeps the length of one of these. An assertion under an `if` counts when the other
branch has one too, and none counts behind an `if` that may leave before anything was asserted.
"""

from __future__ import annotations

import ast
import functools
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

Function = ast.FunctionDef | ast.AsyncFunctionDef
Judge = Callable[[Function, "Names"], bool]

#: Beginnings of the names of helpers that assert, numpy.testing's own among them.
ASSERTING = ("assert_", "check_", "expect_")
#: What of pytest fails by itself, or when its block does not do what it should.
PYTEST = {"raises", "warns", "deprecated_call", "fail"}
#: Calls that give as many elements as their first argument has, and methods that give as many as the object.
SAME_LENGTH = {"enumerate", "sorted", "reversed", "list", "tuple", "set"}
VIEWS = {"items", "keys", "values"}
#: Makers of arrays, and which of their arguments is the size.
SIZED = {"eye": 0, "linspace": 2, "uniform": 2, "normal": 2, "integers": 2}
#: Expressions whose parts are not evaluated where they stand, or not surely.
LATER = (ast.Lambda, ast.ListComp, ast.SetComp, ast.DictComp, ast.GeneratorExp, ast.IfExp, ast.BoolOp)


@dataclass(frozen=True)
class Names:
    """What the names in a function stand for."""

    functions: Mapping[str, Function]
    methods: Mapping[str, Function]  # of the classes of the same file
    values: Mapping[str, ast.expr]  # of names that are assigned in one place

    def without(self, name: str) -> Names:
        """The same names but for one, so that what leads back to itself ends."""
        kept = ({k: v for k, v in names.items() if k != name} for names in (self.functions, self.methods))
        return Names(*kept, {k: v for k, v in self.values.items() if k != name})

    def inside(self, function: Function) -> Names:
        """The names that hold in a function: its own before those around it."""
        nested = {n.name: n for n in ast.walk(function) if isinstance(n, Function) and n is not function}
        hidden = {argument.arg for argument in ast.walk(function.args) if isinstance(argument, ast.arg)}
        around = {k: v for k, v in self.values.items() if k not in hidden}
        own = replace(
            self, functions={**self.functions, **nested}, values={**around, **dict(_assigned_once(function))}
        )
        return own.without(function.name)


def collected(path: Path) -> list[Function]:
    """What pytest collects from a file, methods of test classes included."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    return [node for node in ast.walk(tree) if isinstance(node, Function) and node.name.startswith("test")]


@functools.cache
def names_of(path: Path, root: Path) -> Names:
    """The names of a test file, with what it imports from other files below the folder of the tests."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    functions: dict[str, Function] = {}
    methods: dict[str, Function] = {}
    values: dict[str, ast.expr] = {}
    for node in tree.body:
        if isinstance(node, Function):
            functions[node.name] = node
        elif isinstance(node, ast.ClassDef):
            methods |= {item.name: item for item in node.body if isinstance(item, Function)}
        elif isinstance(node, ast.ImportFrom) and node.module:
            source = root.joinpath(*node.module.split(".")).with_suffix(".py")
            theirs = names_of(source, root) if source.exists() else Names({}, {}, {})
            for alias in node.names:
                if alias.name in theirs.functions:
                    functions[alias.asname or alias.name] = theirs.functions[alias.name]
                elif alias.name in theirs.values:
                    values[alias.asname or alias.name] = theirs.values[alias.name]
    return Names(functions, methods, {**values, **dict(_assigned_once(tree))})


def asserts(function: Function, names: Names) -> bool:
    """True if the function asserts anything anywhere, be it in a loop or under a condition."""
    inside = names.inside(function)
    return any(
        isinstance(node, ast.Assert) or (isinstance(node, ast.expr) and _is_check(node, inside, asserts))
        for node in ast.walk(function)
    )


def surely_asserts(function: Function, names: Names) -> bool:
    """True if an assertion of the function is met however often its loops of unknown length run."""
    return _block(function.body, names.inside(function))


def _block(body: Sequence[ast.stmt], names: Names) -> bool:
    for statement in body:
        if _statement(statement, names):
            return True
        if _may_leave(statement, names):
            return False
    return False


def _statement(node: ast.stmt, names: Names) -> bool:
    match node:
        case ast.Assert():
            return True
        case ast.For() | ast.AsyncFor():
            return runs(node.iter, names) and _block(node.body, names)
        case ast.If():
            return _block(node.body, names) and _block(node.orelse, names)
        case ast.With() | ast.AsyncWith():
            heads = [item.context_expr for item in node.items]
            return any(_is_check(head, names, surely_asserts) for head in heads) or _block(node.body, names)
        case ast.Try():
            return _block(node.body, names) or _block(node.finalbody, names)
        case ast.Expr() | ast.Assign() | ast.AnnAssign() | ast.Return():
            return any(_is_check(part, names, surely_asserts) for part in _evaluated(node.value))
    return False


def _may_leave(node: ast.stmt, names: Names) -> bool:
    """True if the statement may leave its block although nothing was asserted in it."""
    match node:
        case ast.Return() | ast.Continue() | ast.Break():
            return True
        case ast.If():
            branches = [branch for branch in (node.body, node.orelse) if not _block(branch, names)]
            return any(_may_leave(statement, names) for branch in branches for statement in branch)
        case ast.With() | ast.AsyncWith() | ast.Try():
            return any(_may_leave(statement, names) for statement in node.body)
    return False


def _evaluated(node: ast.AST | None) -> Iterator[ast.AST]:
    """An expression and its parts, as far as they are surely evaluated."""
    if node is not None and not isinstance(node, LATER):
        yield node
        for child in ast.iter_child_nodes(node):
            yield from _evaluated(child)


def _is_check(node: ast.AST, names: Names, judge: Judge) -> bool:
    """True if the expression calls something that asserts, by its source or by its name."""
    match node:
        case ast.Call(func=ast.Attribute(value=ast.Name(id="pytest"), attr=name)):
            return name in PYTEST
        case ast.Call(func=ast.Name(id=name)) if name in names.functions:
            return judge(names.functions[name], names.without(name))
        case ast.Call(func=ast.Attribute(attr=name)) if name in names.methods:
            return judge(names.methods[name], names.without(name))
        case ast.Call(func=ast.Name(id=name) | ast.Attribute(attr=name)):
            return name.lstrip("_").startswith(ASSERTING)
    return False


def runs(node: ast.expr, names: Names) -> bool:
    """True if a loop over the expression runs at least once, whatever the code under test gives."""
    match node:
        case ast.Tuple() | ast.List() | ast.Set():
            return any(not isinstance(e, ast.Starred) or runs(e.value, names) for e in node.elts)
        case ast.Dict():
            return any(key is not None for key in node.keys)
        case ast.ListComp():
            return all(runs(part.iter, names) and not part.ifs for part in node.generators)
        case ast.Constant(value=str(text)):
            return bool(text)
        case ast.Name(id=name) if name in names.values:
            return runs(names.values[name], names.without(name))
        case ast.Name(id=name) | ast.Attribute(attr=name):
            return name.isupper()
        case ast.Call(func=ast.Name(id="range")):
            return _range_runs(node.args)
        case ast.Call(func=ast.Name(id="zip")):
            strict = any(keyword.arg == "strict" for keyword in node.keywords)
            return (any if strict else all)(runs(argument, names) for argument in node.args)
        case ast.Call(func=ast.Name(id="product") | ast.Attribute(attr="product")):
            return all(runs(argument, names) for argument in node.args)
        case ast.Call(func=ast.Name(id=name), args=[first, *_]) if name in SAME_LENGTH:
            return runs(first, names)
        case ast.Call(func=ast.Attribute(value=value, attr=name)) if name in VIEWS:
            return runs(value, names)
        case ast.Call(func=ast.Attribute(attr=name)) if name in SIZED:
            sizes = [*node.args[SIZED[name] :], *(k.value for k in node.keywords if k.arg in ("size", "num"))]
            return bool(sizes) and _has_rows(sizes[0])
    return False


def _has_rows(size: ast.expr) -> bool:
    """True for the size of an array with at least one row."""
    match size:
        case ast.Constant(value=int(rows)) | ast.Tuple(elts=[ast.Constant(value=int(rows)), *_]):
            return rows > 0
    return False


def _range_runs(arguments: Sequence[ast.expr]) -> bool:
    """True for a range of constants that is not empty; an upper-case name ends any range behind its start."""
    match arguments:
        case [*_, ast.Name(id=name)]:
            return name.isupper() and len(arguments) < 3
        case [*numbers] if all(isinstance(n, ast.Constant) and isinstance(n.value, int) for n in numbers):
            return len(range(*(n.value for n in numbers))) > 0
    return False


def _assigned_once(scope: ast.AST) -> Iterator[tuple[str, ast.expr]]:
    """Names that are assigned in one place of the scope only, each with the expression."""
    places: dict[str, list[ast.expr]] = {}
    stored: list[str] = []
    for node in ast.walk(scope):
        match node:
            case ast.Assign(targets=[ast.Name(id=name)], value=value):
                places.setdefault(name, []).append(value)
            case ast.AnnAssign(target=ast.Name(id=name), value=ast.expr() as value):
                places.setdefault(name, []).append(value)
            case ast.Name(id=name, ctx=ast.Store()):
                stored.append(name)
    yield from ((name, values[0]) for name, values in places.items() if stored.count(name) == 1)
