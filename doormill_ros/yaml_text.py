"""The plain value of a YAML text, or what is wrong with the text, and the text of a plain value."""

from __future__ import annotations

import contextlib
from typing import Any

import yaml


class NotYaml(ValueError):
    """A text that is no YAML document.

    Attributes:
        where: Line and column, empty where the parser does not say; begins with a blank.
        problem: What the parser says, one line.
    """

    def __init__(self, problem: str, mark: yaml.Mark | None = None) -> None:
        self.where = f" line {mark.line + 1}, column {mark.column + 1}" if mark else ""
        self.problem = " ".join(problem.split())
        super().__init__(f"not YAML{self.where}: {self.problem}")


class DuplicateKey(NotYaml):
    """A key that a mapping has twice.

    Attributes:
        key: The key.
        line: Line of the second one, from 1.
    """

    def __init__(self, key: str, mark: yaml.Mark) -> None:
        super().__init__(f"the key {key!r} is given twice", mark)
        self.key = key
        self.line = mark.line + 1


#: Writing has no way to end the process; in C it takes a tenth of the time.
_Dumper = getattr(yaml, "CSafeDumper", yaml.SafeDumper)


#: What the library and Python raise for a wrong text; of the latter's errors those that a value behind a tag ends in.
_WRONG_VALUE = (ValueError, ArithmeticError, LookupError, TypeError, AttributeError)
_WRONG = (yaml.YAMLError, *_WRONG_VALUE)


#: Values by which aliases may lengthen a document: lists of aliases to lists of aliases grow beyond any memory.
MOST_REPEATED = 20_000


class _Rules:
    """Refuses a key that is given twice and aliases that multiply, and leaves times as text."""

    anchors: dict[Any, yaml.Node]

    def compose_document(self) -> Any:
        """The nodes of a document, as the library composes them; NotYaml where its aliases multiply."""
        self.get_event()  # type: ignore[attr-defined]
        node = self.compose_node(None, None)  # type: ignore[attr-defined]
        self.get_event()  # type: ignore[attr-defined]
        named, self.anchors = self.anchors, {}
        if named and node is not None:
            _check_aliases(node)
        return node

    def construct_object(self, node: yaml.Node, deep: bool = False) -> Any:
        """The value of a node; a wrong one behind a tag, such as !!int x, ends in whatever Python says to it."""
        try:
            return super().construct_object(node, deep)  # type: ignore[misc]
        except NotYaml:
            raise
        except _WRONG_VALUE as error:
            raise NotYaml(str(error), node.start_mark) from error


def _check_aliases(root: yaml.Node) -> None:
    """Raise NotYaml where a node holds itself, or all of them are too many once each alias is written out."""
    sizes: dict[yaml.Node, int] = {}
    inside: set[yaml.Node] = set()

    def size(node: yaml.Node) -> int:
        if node in sizes:
            return sizes[node]
        if node in inside:
            raise NotYaml(
                "an alias stands inside what it names, allowed is a list or mapping that ends",
                node.start_mark,
            )
        inside.add(node)
        parts = node.value if isinstance(node, yaml.CollectionNode) else ()
        children = (one for part in parts for one in (part if isinstance(part, tuple) else (part,)))
        sizes[node] = 1 + sum(size(child) for child in children)
        inside.discard(node)
        return sizes[node]

    repeated = size(root) - len(sizes)
    if repeated > MOST_REPEATED:
        raise NotYaml(
            f"its aliases repeat more than the allowed {MOST_REPEATED} values: write out what is meant",
            root.start_mark,
        )


class _Loader(_Rules, yaml.SafeLoader):
    """All in Python: the words of its errors are those that are told."""


def _mapping(loader: Any, node: yaml.MappingNode) -> dict[Any, Any]:
    seen = set()
    for key, _ in node.value:
        if not isinstance(key, yaml.ScalarNode):
            raise yaml.constructor.ConstructorError(
                None, None, "a field name must be plain text", key.start_mark
            )
        if key.value in seen:
            raise DuplicateKey(str(key.value), key.start_mark)
        seen.add(key.value)
    return dict(loader.construct_mapping(node, deep=True))


def _ruled(loader: Any) -> Any:
    loader.add_constructor(yaml.resolver.BaseResolver.DEFAULT_MAPPING_TAG, _mapping)
    loader.add_constructor("tag:yaml.org,2002:timestamp", lambda loader, node: node.value)
    return loader


_ruled(_Loader)
if hasattr(yaml, "CSafeLoader"):

    class _FastLoader(_Rules, yaml.composer.Composer, yaml.CSafeLoader):
        """Words by the parser in C, which takes a fifth of the time; nodes in Python.

        The composer in C ends the process where lists are nested deeply.
        """

        def __init__(self, text: str) -> None:
            """Of a whole text."""
            yaml.CSafeLoader.__init__(self, text)
            yaml.composer.Composer.__init__(self)

    _fast: Any = _ruled(_FastLoader)
else:
    _fast = None


def parse(text: str) -> Any:
    """The plain value of a YAML text: dict, list, str, int, float, bool and None.

    Raises:
        NotYaml: It is none, or names Python objects.
        DuplicateKey: A mapping has a key twice.
    """
    if _fast is not None:
        # Whatever is wrong is told below, in the same words on every machine.
        with contextlib.suppress(RecursionError, *_WRONG):
            return yaml.load(text, Loader=_fast)
    try:
        return yaml.load(text, Loader=_Loader)
    except NotYaml:
        raise
    except yaml.MarkedYAMLError as error:
        raise NotYaml(str(error.problem), error.problem_mark) from error
    except RecursionError as error:
        raise NotYaml("nested too deeply") from error
    except _WRONG as error:
        raise NotYaml(str(error)) from error


def text_of(document: Any, **layout: Any) -> str:
    """The YAML text of plain values, keys in their order.

    Args:
        document: Mappings, lists, numbers and strings.
        layout: Of `yaml.dump`, such as the width of a line.
    """
    return str(yaml.dump(document, Dumper=_Dumper, sort_keys=False, **layout))
