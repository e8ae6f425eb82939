"""The syntax tree of a RAPID module; every node knows its line."""

from __future__ import annotations

from dataclasses import dataclass, field


@dataclass(frozen=True)
class Node:
    """Anything with a place in a file."""

    line: int


# Expressions


@dataclass(frozen=True)
class Number(Node):
    """A numeric literal."""

    value: float


@dataclass(frozen=True)
class Text(Node):
    """A string literal, decoded."""

    value: str


@dataclass(frozen=True)
class Truth(Node):
    """TRUE or FALSE."""

    value: bool


@dataclass(frozen=True)
class Aggregate(Node):
    """A record or array written out, `[a, b]`."""

    items: tuple[Expression, ...]


@dataclass(frozen=True)
class Part(Node):
    """A component of a record, with its indices when it is an array."""

    name: str
    indices: tuple[Expression, ...]


@dataclass(frozen=True)
class Variable(Node):
    """Data by name: `name{indices}.part{indices}...`."""

    name: str
    indices: tuple[Expression, ...]
    parts: tuple[Part, ...]


@dataclass(frozen=True)
class Unary(Node):
    """`-`, `+` or `NOT`."""

    operator: str
    operand: Expression


@dataclass(frozen=True)
class Binary(Node):
    """Two operands and what is between them."""

    operator: str
    left: Expression
    right: Expression


@dataclass(frozen=True)
class Argument(Node):
    r"""One argument of a call.

    Attributes:
        name: Name of an optional argument, empty for a positional one.
        value: Its expression, None for a switch.
        forwarded: Name of the caller's optional parameter in `\Name?parameter`, else empty.
    """

    name: str
    value: Expression | None
    forwarded: str = ""


@dataclass(frozen=True)
class Function(Node):
    """A function call."""

    name: str
    arguments: tuple[Argument, ...]


Expression = Number | Text | Truth | Aggregate | Variable | Unary | Binary | Function

# Statements


@dataclass(frozen=True)
class Assign(Node):
    """`target := value;`."""

    target: Variable
    value: Expression


@dataclass(frozen=True)
class Call(Node):
    """A procedure or instruction."""

    name: str
    arguments: tuple[Argument, ...]


@dataclass(frozen=True)
class If(Node):
    """Branches in order; `otherwise` is empty without ELSE."""

    branches: tuple[tuple[Expression, Block], ...]
    otherwise: Block


@dataclass(frozen=True)
class For(Node):
    """`FOR name FROM first TO last STEP step`; the loop variable is local and read-only."""

    name: str
    first: Expression
    last: Expression
    step: Expression | None
    body: Block


@dataclass(frozen=True)
class While(Node):
    """`WHILE condition DO`."""

    condition: Expression
    body: Block


@dataclass(frozen=True)
class Test(Node):
    """`TEST value CASE ... DEFAULT`."""

    value: Expression
    cases: tuple[tuple[tuple[Expression, ...], Block], ...]
    default: Block


@dataclass(frozen=True)
class Return(Node):
    """`RETURN value;`."""

    value: Expression | None


@dataclass(frozen=True)
class Raise(Node):
    """`RAISE number;`; without a number it passes the present error on."""

    value: Expression | None


@dataclass(frozen=True)
class Retry(Node):
    """`RETRY;`."""


@dataclass(frozen=True)
class TryNext(Node):
    """`TRYNEXT;`."""


@dataclass(frozen=True)
class Exit(Node):
    """`EXIT;`."""


@dataclass(frozen=True)
class Connect(Node):
    """`CONNECT interrupt WITH trap;`."""

    interrupt: Variable
    trap: str


Statement = Assign | Call | If | For | While | Test | Return | Raise | Retry | TryNext | Exit | Connect
Block = tuple[Statement, ...]

# Declarations


@dataclass(frozen=True)
class Record(Node):
    """`RECORD name`: components as (type name, component name)."""

    name: str
    components: tuple[tuple[str, str], ...]


@dataclass(frozen=True)
class Alias(Node):
    """`ALIAS type name`."""

    type_name: str
    name: str


@dataclass(frozen=True)
class Data(Node):
    """A declaration of data; `storage` is VAR, PERS or CONST."""

    storage: str
    type_name: str
    name: str
    dimensions: tuple[Expression, ...]
    initial: Expression | None
    local: bool = False


@dataclass(frozen=True)
class Parameter(Node):
    """A parameter; `mode` is IN, VAR, PERS or INOUT; `open_dimensions` counts the `*`."""

    name: str
    type_name: str
    mode: str
    optional: bool
    open_dimensions: int
    alternatives: tuple[str, ...] = ()


@dataclass(frozen=True)
class Routine(Node):
    """A procedure, a function when `type_name` is not empty, or a trap; `handler` is None without ERROR."""

    name: str
    type_name: str
    parameters: tuple[Parameter, ...]
    data: tuple[Data, ...] = ()
    body: Block = ()
    handler: Block | None = None
    local: bool = False
    trap: bool = False


@dataclass(frozen=True)
class Module(Node):
    """One module file."""

    name: str
    attributes: tuple[str, ...]
    file: str
    types: tuple[Record | Alias, ...] = field(default=())
    data: tuple[Data, ...] = ()
    routines: tuple[Routine, ...] = ()
