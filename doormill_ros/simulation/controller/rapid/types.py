"""RAPID data types: what values look like here, their defaults, copies and comparisons.

A num is a float that float32 can hold, a string a str, a bool a bool; records and arrays are lists,
so that a reference to any piece of data is a list and an index into it. The static type of an
expression says which.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass
from typing import Any

STRING_LENGTH = 80  #: characters of a RAPID string

_FLOAT32 = struct.Struct("<f")

Value = Any  #: float, str, bool, list, or an opaque object of a non-value type


@dataclass(frozen=True)
class Type:
    """A data type.

    Attributes:
        name: As written in RAPID.
        kind: "num", "dnum", "string", "bool", "record", "opaque" or "any".
        components: Of a record, (name in lower case, type) in order.
    """

    name: str
    kind: str
    components: tuple[tuple[str, Type], ...] = ()

    def component(self, name: str) -> tuple[int, Type] | None:
        """Index and type of a component, or None."""
        for index, (known, kind) in enumerate(self.components):
            if known == name.lower():
                return index, kind
        return None


@dataclass(frozen=True)
class ArrayType:
    """An array; `dimensions` holds None where a parameter leaves the length open."""

    element: Type
    dimensions: tuple[int | None, ...]

    @property
    def name(self) -> str:
        """As written in RAPID."""
        lengths = ",".join("*" if d is None else str(d) for d in self.dimensions)
        return f"{self.element.name}{{{lengths}}}"


AnyType = Type | ArrayType

NUM = Type("num", "num")
DNUM = Type("dnum", "dnum")
STRING = Type("string", "string")
BOOL = Type("bool", "bool")
SWITCH = Type("switch", "switch")
IODEV = Type("iodev", "opaque")
CLOCK = Type("clock", "opaque")
SIGNALDI = Type("signaldi", "signal")
SIGNALDO = Type("signaldo", "signal")
SIGNALAO = Type("signalao", "signal")
SIGNALAI = Type("signalai", "signal")
SIGNALGI = Type("signalgi", "signal")
SIGNALGO = Type("signalgo", "signal")
#: Any value type, for predefined routines such as StrToVal.
ANY = Type("anytype", "any")
#: A condition that WaitUntil evaluates again and again.
CONDITION = Type("condition", "condition")


def _record(name: str, **components: Type) -> Type:
    return Type(name, "record", tuple(components.items()))


def _nums(name: str, components: str) -> Type:
    return _record(name, **dict.fromkeys(components.split(), NUM))


POS = _nums("pos", "x y z")
ORIENT = _nums("orient", "q1 q2 q3 q4")
POSE = _record("pose", trans=POS, rot=ORIENT)
CONFDATA = _nums("confdata", "cf1 cf4 cf6 cfx")
EXTJOINT = _nums("extjoint", "eax_a eax_b eax_c eax_d eax_e eax_f")
ROBJOINT = _nums("robjoint", "rax_1 rax_2 rax_3 rax_4 rax_5 rax_6")
ROBTARGET = _record("robtarget", trans=POS, rot=ORIENT, robconf=CONFDATA, extax=EXTJOINT)
JOINTTARGET = _record("jointtarget", robax=ROBJOINT, extax=EXTJOINT)
SPEEDDATA = _nums("speeddata", "v_tcp v_ori v_leax v_reax")
ZONEDATA = _record(
    "zonedata",
    finep=BOOL,
    pzone_tcp=NUM,
    pzone_ori=NUM,
    pzone_eax=NUM,
    zone_ori=NUM,
    zone_leax=NUM,
    zone_reax=NUM,
)
LOADDATA = _record("loaddata", mass=NUM, cog=POS, aom=ORIENT, ix=NUM, iy=NUM, iz=NUM)
TOOLDATA = _record("tooldata", robhold=BOOL, tframe=POSE, tload=LOADDATA)
LISTITEM = _record("listitem", image=STRING, text=STRING)
WOBJDATA = _record("wobjdata", robhold=BOOL, ufprog=BOOL, ufmec=STRING, uframe=POSE, oframe=POSE)

#: Every predefined type by lower-case name; byte, errnum, intnum and their kin are aliases of num.
PREDEFINED: dict[str, Type] = {
    t.name: t
    for t in (
        NUM, DNUM, STRING, BOOL, SWITCH, IODEV, CLOCK, SIGNALDI, SIGNALDO, SIGNALAO, SIGNALAI,
        SIGNALGI, SIGNALGO, ANY, CONDITION,
        POS, ORIENT, POSE, CONFDATA, EXTJOINT, ROBJOINT, ROBTARGET, JOINTTARGET, SPEEDDATA, ZONEDATA,
        LOADDATA, TOOLDATA, WOBJDATA, LISTITEM,
    )
} | dict.fromkeys(("byte", "errnum", "intnum", "buttondata", "btnres", "icondata", "symnum"), NUM)  # fmt: skip


def float32(value: float) -> float:
    """The float32 nearest to a number.

    Raises:
        OverflowError: Beyond the range of float32.
    """
    rounded: float = _FLOAT32.unpack(_FLOAT32.pack(value))[0]
    return rounded


def default(kind: AnyType) -> Value:
    """What data of a type holds when it is declared without a value."""
    if isinstance(kind, ArrayType):
        return _array(kind.element, list(kind.dimensions))
    match kind.kind:
        case "num" | "dnum":
            return 0.0
        case "string":
            return ""
        case "bool" | "switch":
            return False
        case "record":
            return [default(component) for _, component in kind.components]
    return None


def _array(element: Type, dimensions: list[int | None]) -> Value:
    item = _array(element, dimensions[1:]) if dimensions[1:] else default(element)
    return [copy(item) for _ in range(dimensions[0] or 0)]


def copy(value: Value) -> Value:
    """A copy that shares nothing; RAPID assigns by value."""
    if not isinstance(value, list):
        return value
    # Most lists are the innermost ones, of numbers alone: for those nothing is left to be done.
    if list in map(type, value):
        return [copy(item) for item in value]
    return value.copy()


def is_composite(kind: AnyType) -> bool:
    """True when values of the type are lists."""
    return isinstance(kind, ArrayType) or kind.kind == "record"


def is_value(kind: AnyType) -> bool:
    """True when data of the type may be assigned and compared."""
    element = kind.element if isinstance(kind, ArrayType) else kind
    return element.kind in ("num", "dnum", "string", "bool", "record")


def accepts(parameter: AnyType, argument: AnyType) -> bool:
    """Whether data of one type may be handed to a parameter of another."""
    if parameter is ANY:
        return isinstance(argument, ArrayType) or is_value(argument)
    if isinstance(parameter, ArrayType) and isinstance(argument, ArrayType):
        return parameter.element == argument.element and len(parameter.dimensions) == len(argument.dimensions)
    return parameter == argument


def format_number(value: float) -> str:
    """A num as ValToStr prints it: six significant digits."""
    if value == 0.0:
        return "0"
    text = f"{value:.6g}"
    if "e" not in text:
        return text
    mantissa, exponent = text.split("e")
    return f"{mantissa}E{exponent[0]}{int(exponent[1:]):02d}"


def format_value(value: Value) -> str:
    """Data as ValToStr writes it."""
    if isinstance(value, bool):
        return "TRUE" if value else "FALSE"
    if isinstance(value, str):
        return '"' + value.replace("\\", "\\\\").replace('"', '""') + '"'
    if isinstance(value, list):
        return "[" + ",".join(format_value(item) for item in value) + "]"
    return format_number(value)


def is_integer(value: float) -> bool:
    """True for a number without fraction."""
    return float(value).is_integer()
