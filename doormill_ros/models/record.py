"""The record of a store of models: versions, orders, and what stops milling (schema doormill/models/1)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields, replace
from typing import Any, TypeVar

SCHEMA = "doormill/models/1"
ACCEPT, REVERT = "accept", "revert"
Entry = TypeVar("Entry")


@dataclass(frozen=True)
class ModelVersion:
    """A model that was proposed once.

    Attributes:
        number: Given to no other model; from 1 on.
        made: When it was proposed, ISO 8601.
        source: What proposed it.
        sha256: Of its file.
    """

    number: int
    made: str
    source: str
    sha256: str


@dataclass(frozen=True)
class ModelOrder:
    """What changed the model in use.

    Attributes:
        order: ACCEPT or REVERT.
        version: In use from then on; 0 for the model that the path generator was started with.
        before: In use until then.
        at: When, ISO 8601.
        who, why: Given with the order.
    """

    order: str
    version: int
    before: int
    at: str
    who: str
    why: str


@dataclass(frozen=True)
class MillingStop:
    """Why no door is milled.

    Attributes:
        version: In use when milling was stopped; with another one the reason is gone.
        message: What was found, what is allowed, what to do.
    """

    version: int
    message: str


@dataclass(frozen=True)
class StoreRecord:
    """Everything that a store knows.

    Attributes:
        issued: The highest number that a version ever had.
        versions: That can be put in use, in order: those that once were, and the latest proposal.
        orders: In order.
        stop: What stops milling, if anything does.
    """

    issued: int = 0
    versions: tuple[ModelVersion, ...] = ()
    orders: tuple[ModelOrder, ...] = ()
    stop: MillingStop | None = None

    @property
    def in_use(self) -> int:
        """The version in use, 0 for the model that the path generator was started with."""
        return self.orders[-1].version if self.orders else 0

    @property
    def proposed(self) -> int:
        """The version that was proposed last and never in use; 0 where there is none."""
        newest = self.versions[-1].number if self.versions else 0
        return 0 if newest in self.accepted else newest

    @property
    def accepted(self) -> frozenset[int]:
        """Versions that were in use at some time."""
        return frozenset(order.version for order in self.orders if order.version)

    def before(self, version: int) -> int:
        """What was in use until a version was accepted last."""
        found = [o.before for o in self.orders if o.order == ACCEPT and o.version == version]
        return found[-1] if found else 0

    def version(self, number: int) -> ModelVersion | None:
        """The version of a number, None where there is none."""
        return next((one for one in self.versions if one.number == number), None)

    def with_proposal(self, version: ModelVersion) -> StoreRecord:
        """A version more; the proposal before, if nobody took it, is outdated."""
        kept = tuple(one for one in self.versions if one.number in self.accepted)
        return replace(self, issued=version.number, versions=(*kept, version))

    def without_proposal(self) -> StoreRecord:
        """Nothing is proposed."""
        return replace(self, versions=tuple(v for v in self.versions if v.number in self.accepted))

    def with_order(self, order: ModelOrder) -> StoreRecord:
        """Another version is in use; what stopped milling was about the one before."""
        return replace(self, orders=(*self.orders, order), stop=None)

    def document(self) -> dict[str, Any]:
        """JSON-able content of the store's file."""
        return {"schema": SCHEMA, **asdict(self)}

    @classmethod
    def from_document(cls, document: Any) -> StoreRecord:
        """Read back.

        Raises:
            ValueError: It is no record of this schema.
        """
        if not isinstance(document, dict) or document.get("schema") != SCHEMA:
            raise ValueError(f"its schema is not {SCHEMA}")
        versions = _entries(document, "versions", ModelVersion)
        orders = _entries(document, "orders", ModelOrder)
        stop = document.get("stop")
        record = cls(
            _whole(document.get("issued"), "issued"),
            versions,
            orders,
            None if stop is None else _entry(stop, "stop", MillingStop),
        )
        numbers = [version.number for version in versions]
        if numbers != sorted(set(numbers)) or any(number > record.issued for number in numbers):
            raise ValueError(f"its versions are {numbers}, allowed are rising numbers up to issued")
        for i, order in enumerate(orders):
            if order.order not in (ACCEPT, REVERT) or order.version not in (0, *numbers):
                raise ValueError(f"orders.{i} is {order.order!r:.80} of version {order.version!r:.40}")
        return record


def _entries(document: Mapping[str, Any], key: str, kind: type[Entry]) -> tuple[Entry, ...]:
    entries = document.get(key)
    if not isinstance(entries, list):
        raise ValueError(f"{key} is {entries!r:.80}, allowed is a list")
    return tuple(_entry(entry, f"{key}.{i}", kind) for i, entry in enumerate(entries))


def _entry(entry: Any, place: str, kind: type[Entry]) -> Entry:
    """A part of the record: its keys are the attributes, whole numbers or texts."""
    kinds = {field.name: field.type for field in fields(kind)}  # type: ignore[arg-type]  # all are dataclasses
    if not isinstance(entry, dict) or set(entry) != set(kinds):
        raise ValueError(f"{place} is {entry!r:.80}, allowed is a mapping of {', '.join(kinds)}")
    for name, value in entry.items():
        if kinds[name] == "int":
            _whole(value, f"{place}.{name}")
        elif not isinstance(value, str):
            raise ValueError(f"{place}.{name} is {value!r:.80}, allowed is text")
    return kind(**entry)


def _whole(value: Any, place: str) -> int:
    if isinstance(value, bool) or not isinstance(value, int) or value < 0:
        raise ValueError(f"{place} is {value!r:.80}, allowed is a whole number from 0 up")
    return value
