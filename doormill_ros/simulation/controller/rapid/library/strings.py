"""String functions; positions count from 1, and a search without success gives length + 1."""

from __future__ import annotations

from doormill_ros.simulation.controller.rapid.context import Context
from doormill_ros.simulation.controller.rapid.faults import RapidFault, RapidStop
from doormill_ros.simulation.controller.rapid.library.predefined import predefined
from doormill_ros.simulation.controller.rapid.literals import parse_literal
from doormill_ros.simulation.controller.rapid.operators import join
from doormill_ros.simulation.controller.rapid.types import (
    AnyType,
    Value,
    format_number,
    format_value,
    is_integer,
)


def position_in(text: str, position: float, what: str) -> int:
    """A position within a string; outside it the controller stops the program.

    Raises:
        RapidStop: The position is not within the string. No ERROR clause takes this.
    """
    if not is_integer(position) or not 1 <= position <= len(text):
        raise RapidStop(f"{what}: position {position:g} is outside the string, allowed is 1 to {len(text)}")
    return int(position)


@predefined("FUNC num StrLen(string Str)")
def str_len(_context: Context, text: str) -> float:
    """Number of characters."""
    return float(len(text))


@predefined("FUNC num StrFind(string Str, num ChPos, string Set \\switch NotInSet)")
def str_find(_context: Context, text: str, start: float, wanted: str, not_in_set: bool) -> float:
    """First position from `start` on whose character is (or is not) in the set."""
    first = position_in(text, start, "StrFind")
    for index in range(first - 1, len(text)):
        if (text[index] in wanted) != not_in_set:
            return float(index + 1)
    return float(len(text) + 1)


@predefined("FUNC num StrMatch(string Str, num ChPos, string Pattern)")
def str_match(_context: Context, text: str, start: float, pattern: str) -> float:
    """First position from `start` on where the pattern begins."""
    first = position_in(text, start, "StrMatch")
    found = text.find(pattern, first - 1)
    return float(found + 1 if found >= 0 else len(text) + 1)


@predefined("FUNC bool StrMemb(string Str, num ChPos, string Set)")
def str_memb(_context: Context, text: str, position: float, wanted: str) -> bool:
    """Whether the character at a position is in the set."""
    return text[position_in(text, position, "StrMemb") - 1] in wanted


@predefined("FUNC string StrPart(string Str, num ChPos, num Len)")
def str_part(_context: Context, text: str, start: float, length: float) -> str:
    """Part of a string, by first position and length."""
    first = position_in(text, start, "StrPart")
    if not is_integer(length) or not 0 <= length <= len(text) - first + 1:
        raise RapidStop(
            f"StrPart: length {length:g} from position {first} is outside the string, "
            f"allowed is 0 to {len(text) - first + 1}"
        )
    return text[first - 1 : first - 1 + int(length)]


@predefined("FUNC string StrMap(string Str, string FromMap, string ToMap)")
def str_map(_context: Context, text: str, source: str, target: str) -> str:
    """Characters replaced one by one."""
    if len(source) != len(target):
        raise RapidStop(
            f"StrMap: the maps have {len(source)} and {len(target)} characters, allowed is one length"
        )
    return "".join(target[source.rindex(c)] if c in source else c for c in text)


@predefined("FUNC bool StrToVal(string Str, INOUT anytype Val)")
def str_to_val(_context: Context, text: str, place: tuple[list[Value], int, AnyType]) -> bool:
    """Read a literal; the data keeps its value when the text is none of its type."""
    container, index, kind = place
    value = parse_literal(text, kind)
    if value is None:
        return False
    container[index] = value
    return True


@predefined("FUNC string ValToStr(anytype Val)")
def val_to_str(_context: Context, value: tuple[Value, AnyType]) -> str:
    """Data as a literal, numbers with six digits."""
    return join(format_value(value[0]), "")


@predefined("FUNC string NumToStr(num Val, num Dec \\switch Exp)")
def num_to_str(_context: Context, value: float, decimals: float, exponent: bool) -> str:
    """A number with fixed decimals."""
    if not is_integer(decimals) or not 0 <= decimals <= 6:
        raise RapidFault("ERR_ARGVALERR", f"NumToStr: {decimals:g} decimals, allowed are 0 to 6")
    text = f"{value:.{int(decimals)}{'E' if exponent else 'f'}}"
    return text[1:] if text.startswith("-") and not text.strip("-0.") else text


@predefined("FUNC byte StrToByte(string ConStr \\switch Hex | switch Okt | switch Bin | switch Char)")
def str_to_byte(
    _context: Context, text: str, hexadecimal: bool, octal: bool, binary: bool, character: bool
) -> float:
    """The byte that a text names, or the code of a character."""
    try:
        if character:
            value = ord(text) if len(text) == 1 else -1
        else:
            value = int(text, 16 if hexadecimal else 8 if octal else 2 if binary else 10)
    except ValueError:
        value = -1
    if not 0 <= value <= 255:
        raise RapidFault("ERR_ARGVALERR", f"StrToByte: {text!r} is no byte")
    return float(value)


@predefined("FUNC string ByteToStr(byte BitData \\switch Hex | switch Okt | switch Bin | switch Char)")
def byte_to_str(
    _context: Context, value: float, hexadecimal: bool, octal: bool, binary: bool, character: bool
) -> str:
    """A byte in digits or as a character."""
    if not is_integer(value) or not 0 <= value <= 255:
        raise RapidFault("ERR_ARGVALERR", f"ByteToStr: {value:g} is no byte, allowed is 0 to 255")
    number = int(value)
    if character:
        return chr(number)
    return (
        f"{number:02X}"
        if hexadecimal
        else f"{number:03o}"
        if octal
        else f"{number:08b}"
        if binary
        else f"{number}"
    )


@predefined("FUNC num Dim(anytype ArrPar, num DimNo)")
def dim(_context: Context, array: tuple[Value, AnyType], number: float) -> float:
    """Length of an array along one of its dimensions."""
    value = array[0]
    for _ in range(int(number) - 1):
        value = value[0] if isinstance(value, list) and value else None
    if not isinstance(value, list) or not is_integer(number) or number < 1:
        raise RapidStop(f"Dim: the array has no dimension {format_number(number)}")
    return float(len(value))
