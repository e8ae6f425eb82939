"""What the fields of a recipe document may hold: quantities with unit and limits, texts, words of a list.

Inside everything is SI; `width` [m] is `width_mm` in the document. Numbers live on a grid of 1e-6 document units
(1 nm for lengths), so that a value survives any number of trips through every exchange format bit by bit.
"""

from __future__ import annotations

import dataclasses
import math
import re
import typing
from collections.abc import Callable
from datetime import UTC, datetime
from enum import Enum
from typing import Annotated, Any

from pydantic import GetCoreSchemaHandler
from pydantic_core import CoreSchema, PydanticCustomError, core_schema

from doormill_ros.recipes.errors import BadText, FieldError, NotAChoice, NotFinite, OutOfRange, WrongType
from doormill_ros.units import DEG, MM, RPM

Place = tuple[str | int, ...]  #: within a value: keys and numbers of entries
GRID_DECIMALS = 6
SCALES = {"mm": MM, "m": 1.0, "deg": DEG, "rpm": RPM, "mm_s": MM, "m_min": 1.0 / 60.0, "kg": 1.0}
SCALES |= {"n_nm": 1.0, "n_mm": 1.0 / MM}  #: newtons and newton metres; newtons a millimetre


def complaint(leaf: type[FieldError], text: str, inside: Place = (), **data: Any) -> PydanticCustomError:
    """What a validator raises; `reading.read_part` makes the leaf of it.

    Args:
        leaf: Class of the error.
        text: What was found and what is allowed.
        inside: Where within the validated value.
        data: The offending values by name.
    """
    return PydanticCustomError("leaf", "{text}", {"leaf": leaf, "text": text, "inside": inside, "data": data})


def number(value: Any, what: str = "a number", inside: Place = ()) -> float:
    """A finite number on the grid; raises `complaint`."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise complaint(WrongType, f"found {value!r}, allowed is {what}", inside, found=value)
    try:
        finite = math.isfinite(value)
    except OverflowError:  # an integer of some hundred digits
        finite = False
    if not finite:
        shown = value if isinstance(value, float) else f"an integer of {len(str(abs(value)))} digits"
        raise complaint(NotFinite, f"found {shown}, allowed is {what} that is finite", inside, found=shown)
    return round(float(value), GRID_DECIMALS) + 0.0


def schema(source: Any, read: Callable[[Any], Any], write: Callable[[Any], Any] | None = None) -> CoreSchema:
    """Pydantic's schema of a field: read and written by these functions, None allowed where its type says so."""
    serialization = core_schema.plain_serializer_function_ser_schema(write) if write else None
    plain = core_schema.no_info_plain_validator_function(read, serialization=serialization)
    if type(None) in typing.get_args(source):
        return core_schema.nullable_schema(plain)
    return plain


@dataclasses.dataclass(frozen=True)
class Quantity:
    """A number with a unit between two limits, both in the document's unit."""

    unit: str
    low: float
    high: float
    scale: float = dataclasses.field(init=False)  #: SI units in one of the document's

    def __post_init__(self) -> None:
        """Look the unit up once."""
        object.__setattr__(self, "scale", SCALES[self.unit])

    def key(self, name: str) -> str:
        """Name in the document: the attribute's with the unit behind it."""
        return f"{name}_{self.unit}"

    def read(self, value: Any, inside: Place = ()) -> float:
        """The value in SI of a document's; raises `complaint`, `inside` the value that is validated."""
        if type(value) is not float or not self.low <= value <= self.high:
            value = self._checked(value, inside)
        on_grid: float = round(value, GRID_DECIMALS) + 0.0
        return on_grid * self.scale

    def _checked(self, value: Any, inside: Place) -> float:
        found = number(value, inside=inside)
        if not self.low <= found <= self.high:
            unit = self.unit.replace("_", "/")
            raise complaint(
                OutOfRange,
                f"found {found:g} {unit}, allowed are {self.low:g} to {self.high:g} {unit}",
                inside,
                found=found,
                low=self.low,
                high=self.high,
            )
        return found

    def write(self, value: float) -> float:
        """The document's value of one in SI."""
        return round(value / self.scale, GRID_DECIMALS) + 0.0

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return schema(source, self.read, self.write)


@dataclasses.dataclass(frozen=True)
class Whole:
    """A whole number between two limits."""

    low: int
    high: int

    def read(self, value: Any) -> int:
        """The number; raises `complaint`."""
        found = number(value, "a whole number")
        if found != int(found):
            raise complaint(WrongType, f"found {value!r}, allowed is a whole number", found=value)
        if not self.low <= found <= self.high:
            raise complaint(
                OutOfRange, f"found {value}, allowed are {self.low} to {self.high}", found=value, low=self.low
            )
        return int(found)

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return schema(source, self.read)


@dataclasses.dataclass(frozen=True)
class TextPattern:
    """A text that matches a pattern from end to end."""

    pattern: re.Pattern[str]
    what: str

    def read(self, value: Any) -> str:
        """The text; raises `complaint`."""
        if not isinstance(value, str):
            raise complaint(WrongType, f"found {value!r}, allowed is text: {self.what}", found=value)
        if not self.pattern.fullmatch(value):
            raise complaint(BadText, f"found {value!r}, allowed is {self.what}", found=value)
        return value

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return schema(source, self.read)


NAME = TextPattern(
    re.compile(r"[A-Za-z0-9][A-Za-z0-9_.\-]{0,63}"), "1 to 64 letters, digits, '_', '-' or '.', no '.' first"
)
Name = Annotated[str, NAME]


class Choice(Enum):
    """Base of the enumerations of words or numbers that a document chooses from."""

    @classmethod
    def read(cls, value: Any) -> Choice:
        """The member; raises `complaint`."""
        member = cls._value2member_map_.get(value) if isinstance(value, str | int) else None
        if isinstance(member, cls) and type(value) is type(member.value):
            return member
        allowed = [member.value for member in cls]
        if isinstance(value, bool) or not isinstance(value, type(allowed[0])):
            raise complaint(WrongType, f"found {value!r}, allowed is one of {allowed}", found=value)
        raise complaint(NotAChoice, f"found {value!r}, allowed is one of {allowed}", found=value)

    @classmethod
    def __get_pydantic_core_schema__(cls, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return schema(source, cls.read, lambda member: member.value)


class Moment:
    """A moment in time, ISO 8601 with an offset in the document, UTC inside."""

    def read(self, value: Any) -> datetime:
        """The moment; raises `complaint`."""
        allowed = "allowed is a time such as 2026-01-31T12:00:00Z"
        if not isinstance(value, str | datetime):
            raise complaint(WrongType, f"found {value!r}, {allowed}")
        try:
            moment = value if isinstance(value, datetime) else datetime.fromisoformat(value)
        except ValueError:
            raise complaint(BadText, f"found {value!r}, {allowed}") from None
        if moment.tzinfo is None:
            raise complaint(
                BadText, f"found {value!r}, allowed is a time with its offset from UTC, such as Z"
            )
        return moment.astimezone(UTC)

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return schema(source, self.read, datetime.isoformat)
