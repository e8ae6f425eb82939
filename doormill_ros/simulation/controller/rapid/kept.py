"""Syntax trees of what ships with the project, kept among the user's caches.

Parsing it takes a third of a simulator's start. Trees are kept beside the hash of the texts and of the code that reads
texts, and are taken for no other. They are read by a reader that makes nothing but syntax trees, whoever wrote the
file, and are parsed again where there is none, where it is damaged or where nothing can be written.
"""

from __future__ import annotations

import functools
import hashlib
import io
import pickle
import sys
from collections.abc import Callable
from contextlib import suppress
from importlib.metadata import version
from pathlib import Path
from typing import Any

from doormill_ros.files import write_atomically
from doormill_ros.resources import cache_folder
from doormill_ros.simulation.controller.rapid import syntax as s

MODULES, HEADS = "modules", "heads"  #: names of the files
_DIGEST = hashlib.sha256().digest_size  # bytes


@functools.lru_cache(maxsize=4)
def shipped_modules(texts: tuple[tuple[str, str], ...]) -> tuple[s.Module, ...]:
    """Modules by what messages call them and their texts; see `parse_module` for what it raises."""

    def parse() -> tuple[s.Module, ...]:
        from doormill_ros.simulation.controller.rapid.parser import parse_module  # late: it builds the parser

        return tuple(parse_module(text, file) for file, text in texts)

    return kept(MODULES, texts, parse)


@functools.lru_cache(maxsize=4)
def shipped_heads(texts: tuple[str, ...]) -> tuple[s.Routine, ...]:
    """Routines without bodies by their heads; see `parse_signature`."""

    def parse() -> tuple[s.Routine, ...]:
        from doormill_ros.simulation.controller.rapid.parser import parse_signature  # late, as above

        return tuple(map(parse_signature, texts))

    return kept(HEADS, texts, parse)


def kept(name: str, texts: tuple[Any, ...], parse: Callable[[], tuple[Any, ...]]) -> tuple[Any, ...]:
    """The trees of some texts, one for each, out of the file of a name, or as they are parsed now and kept there."""
    key = _key(texts)
    try:
        path = cache_folder() / "rapid" / name
    except RuntimeError:  # nobody's home
        return parse()
    found = _read(path, key)
    if found is not None and len(found) == len(texts):
        return found
    trees = parse()
    content = pickle.dumps(trees)
    # Another process may do the same: whoever comes last has written the whole file, and the same trees.
    with suppress(OSError):
        path.parent.mkdir(parents=True, exist_ok=True)
        write_atomically(path, key + hashlib.sha256(content).digest() + content)
    return trees


def _key(texts: tuple[Any, ...]) -> bytes:
    """Hash of the texts and of all that makes trees of them."""
    digest = hashlib.sha256(repr((sys.version, version("lark"), texts)).encode())
    folder = Path(__file__).parent
    for path in sorted([*folder.glob("*.py"), *folder.glob("*.lark")]):
        digest.update(hashlib.sha256(path.read_bytes()).digest())
    return digest.digest()


def _read(path: Path, key: bytes) -> tuple[Any, ...] | None:
    """What was kept under a key; None where it was not, or is not whole."""
    try:
        data = path.read_bytes()
    except OSError:
        return None
    content = data[2 * _DIGEST :]
    if data[: 2 * _DIGEST] != key + hashlib.sha256(content).digest():
        return None
    try:
        trees = _Reader(io.BytesIO(content)).load()
    except Exception:  # a file that somebody else made may raise anything
        return None
    return trees if isinstance(trees, tuple) and all(isinstance(tree, s.Node) for tree in trees) else None


class _Reader(pickle.Unpickler):
    """Makes syntax trees and nothing else."""

    def find_class(self, module: str, name: str) -> type[s.Node]:
        """A class of syntax trees.

        Raises:
            UnpicklingError: Another one is asked for.
        """
        kind = getattr(s, name, None) if module == s.__name__ else None
        if not isinstance(kind, type) or not issubclass(kind, s.Node):
            raise pickle.UnpicklingError(f"{module}.{name} is no syntax tree")
        return kind
