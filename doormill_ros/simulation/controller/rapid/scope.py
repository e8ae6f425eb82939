"""Names of a RAPID program and what they stand for."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

from doormill_ros.simulation.controller.rapid import syntax as s
from doormill_ros.simulation.controller.rapid.errors import RapidProgramError
from doormill_ros.simulation.controller.rapid.types import AnyType, ArrayType, Type, Value

#: The arguments and local data of one call; slot 0 is the first parameter.
Frame = list[Any]
#: Compiled code that works on a frame.
Run = Callable[[Frame], Any]
#: Where a piece of data is: a list and an index into it.
Reference = tuple[list[Any], int]
#: Compiled code that finds a piece of data.
Refer = Callable[[Frame], Reference]


class _Absent:
    """Stands in a slot whose optional argument was not given."""

    def __repr__(self) -> str:
        return "ABSENT"


ABSENT = _Absent()


@dataclass(frozen=True, eq=False)
class Symbol:
    """One name of data.

    Attributes:
        name: As declared.
        type: Its data type.
        storage: "VAR", "PERS", "CONST", "IN" (parameter), "INOUT", "LOOP" or "SIGNAL".
    """

    name: str
    type: AnyType
    storage: str


@dataclass(frozen=True, eq=False)
class GlobalSymbol(Symbol):
    """Data that lives as long as the program; `store` is a list of one that holds it."""

    store: list[Value]


@dataclass(frozen=True, eq=False)
class LocalSymbol(Symbol):
    """Data that lives in the frame of one call.

    Attributes:
        slot: Index into the frame.
        by_reference: The slot holds a `Reference`.
        optional: The slot may hold ABSENT.
    """

    slot: int
    by_reference: bool = False
    optional: bool = False


@dataclass(frozen=True)
class ParameterInfo:
    """A parameter with its type resolved."""

    name: str
    type: AnyType
    mode: str
    optional: bool
    alternatives: tuple[str, ...]


@dataclass(eq=False)
class RoutineInfo:
    """A routine that can be called; `run` takes the argument slots and gives the result."""

    name: str
    type: AnyType | None
    parameters: tuple[ParameterInfo, ...]
    run: Callable[[Frame], Value]
    predefined: bool = False
    trap: bool = False


class Names:
    """A dictionary of names that ignores the case of letters, and asks an outer one next."""

    def __init__(self, outer: Names | None = None) -> None:
        """Start empty inside `outer`."""
        self._outer = outer
        self._items: dict[str, Any] = {}

    def find(self, name: str) -> Any | None:
        """What the name stands for here or further out, or None."""
        found = self._items.get(name.lower())
        if found is None and self._outer is not None:
            return self._outer.find(name)
        return found

    def has_here(self, name: str) -> bool:
        """True when the name is declared in this very scope."""
        return name.lower() in self._items

    def add(self, name: str, item: Any) -> None:
        """Declare a name."""
        self._items[name.lower()] = item

    def __iter__(self) -> Iterator[tuple[str, Any]]:
        """Names in lower case and what they stand for, of this scope alone."""
        return iter(self._items.items())


def program_error(file: str, line: int, problem: str, **data: Any) -> RapidProgramError:
    """An error that keeps a module from being loaded."""
    return RapidProgramError(f"{file}, line {line}: {problem}", file=file, line=line, **data)


def resolve_type(types: Names, name: str, file: str, line: int) -> Type:
    """The type of a name."""
    found = types.find(name)
    if not isinstance(found, Type):
        raise program_error(
            file,
            line,
            f"data type {name!r} is not known: declare a RECORD or correct the name",
            name=name,
        )
    return found


def describe_parameters(routine: s.Routine, types: Names, file: str) -> tuple[ParameterInfo, ...]:
    """Parameters of a routine with their types."""
    infos = []
    for p in routine.parameters:
        element = resolve_type(types, p.type_name, file, p.line)
        kind = ArrayType(element, (None,) * p.open_dimensions) if p.open_dimensions else element
        infos.append(ParameterInfo(p.name, kind, p.mode, p.optional, p.alternatives))
    return tuple(infos)
