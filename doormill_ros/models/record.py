"""The record of a store of models: versions, orders, and what stops milling (schema doormill/models/1)."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, replace
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
        versions = _read(document.get("versions"), lambda v: ModelVersion(**v))
        orders = _read(document.get("orders"), lambda o: ModelOrder(**o))
        stop = document.get("stop")
        record = cls(
            _whole(document.get("issued")),
            versions,
            orders,
            None if stop is None else MillingStop(**_entry(stop)),
        )
        numbers = [_whole(version.number) for version in versions]
        if numbers != sorted(set(numbers)) or any(number > record.issued for number in numbers):
            raise ValueError(f"its versions are {numbers}, allowed are rising numbers up to issued")
        for order in orders:
            if order.order not in (ACCEPT, REVERT) or _whole(order.version) not in (0, *numbers):
                raise ValueError(f"it has the order {order.order!r} of version {order.version!r}")
            _whole(order.before)
        return record


def _read(entries: Any, build: Callable[[Mapping[str, Any]], Entry]) -> tuple[Entry, ...]:
    if not isinstance(entries, list):
        raise ValueError("versions and orders have to be lists")
    return tuple(build(_entry(entry)) for entry in entries)


def _entry(entry: Any) -> Mapping[str, Any]:
    if not isinstance(entry, dict):
        raise ValueError(f"it has {type(entry).__name__} where a mapping belongs")
    return entry


def _whole(value: Any) -> int:
    if isinstance(value, bool) or not isinstance(value, int) or value < 0:
        raise ValueError(f"it has {value!r} where a number of a version belongs")
    return value
