"""Orders from the operator's page: who may give them, and what carries them out."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from typing import Annotated, Any, Protocol, TypeVar

from anyio import CapacityLimiter, to_thread
from fastapi import FastAPI, HTTPException, Query, Request
from pydantic import BaseModel, Field

from doormill_ros.errors import DoormillError
from doormill_ros.operator.access.order_paths import ORDERS
from doormill_ros.operator.access.token import Role
from doormill_ros.operator.orders.audit import AuditLog
from doormill_ros.operator.orders.order_texts import Printable

Value = TypeVar("Value")

LONGEST_ID = 100  # characters
LONGEST_REASON = 500  # characters
SHOWN_ENTRIES = 500
ORDERS_AT_ONCE = 16
DOORS_AT_ONCE = 4  # searches; each may wait for a database that is silent


class Control(Protocol):
    """What the page may do to the cell; each answers with a sentence for the operator."""

    def mill(self, door_id: str) -> str:
        """Start milling a door.

        Raises:
            DoormillError: It cannot be started.
        """

    def cancel(self) -> str:
        """End the run in hand.

        Raises:
            DoormillError: There is nobody to end it.
        """

    def accept(self, version: int, who: str, why: str) -> str:
        """Put a model in use.

        Raises:
            DoormillError: It cannot be, or nobody answers.
        """

    def revert(self, version: int, who: str, why: str) -> str:
        """Take the model in use back.

        Raises:
            DoormillError: It cannot be, or nobody answers.
        """

    def doors(self, prefix: str) -> list[str]:
        """Some of the doors whose id starts so.

        Raises:
            DoormillError: The recipe database does not answer.
        """


class MillRequest(BaseModel):
    """Body of a request to mill a door."""

    door_id: Printable = Field(min_length=1, max_length=LONGEST_ID)


class ModelOrderRequest(BaseModel):
    """Body of an order about a version of the model."""

    version: int = Field(ge=1, lt=2**32)
    who: Printable = Field(min_length=1, max_length=LONGEST_ID)
    why: Printable = Field(min_length=1, max_length=LONGEST_REASON)


#: The role that each order needs.
ROLES = {
    ORDERS: Role.OPERATE,
    f"{ORDERS}/mill": Role.OPERATE,
    f"{ORDERS}/cancel": Role.OPERATE,
    f"{ORDERS}/accept": Role.ENGINEER,
    f"{ORDERS}/revert": Role.ENGINEER,
    f"{ORDERS}/audit": Role.ENGINEER,
}


def serve_orders(app: FastAPI, control: Control, audit: AuditLog | None) -> None:
    """Add the orders to the application; who may give them is asked by `Doorkeeper`, before.

    Args:
        app: The application.
        control: Carries them out.
        audit: Where they are written down; a run that cannot be written down is not started.
    """
    # Threads of their own: whatever else the page waits for, an order finds one.
    orders, searches = CapacityLimiter(ORDERS_AT_ONCE), CapacityLimiter(DOORS_AT_ONCE)
    searching = asyncio.Semaphore(DOORS_AT_ONCE)

    async def answer(
        action: Callable[..., Value], *arguments: Any, threads: CapacityLimiter = orders
    ) -> Value:
        try:
            return await to_thread.run_sync(action, *arguments, limiter=threads)
        except DoormillError as error:
            raise HTTPException(409, error.message, {"Error-Code": str(error.code)}) from error

    @app.get(ORDERS)
    async def check() -> dict[str, str]:
        return {"message": "the token is right"}

    @app.post(f"{ORDERS}/mill", status_code=202)
    async def mill(wanted: MillRequest, request: Request) -> dict[str, str]:
        request.state.door_id = wanted.door_id
        if audit is not None:
            await answer(audit.require)
        return {"message": await answer(control.mill, wanted.door_id)}

    # Carried out even where it cannot be written down: it makes nothing move.
    @app.post(f"{ORDERS}/cancel", status_code=202)
    async def cancel() -> dict[str, str]:
        return {"message": await answer(control.cancel)}

    async def change_model(
        action: Callable[[int, str, str], str], wanted: ModelOrderRequest
    ) -> dict[str, str]:
        if audit is not None:
            await answer(audit.require)
        return {"message": await answer(action, wanted.version, wanted.who, wanted.why)}

    @app.post(f"{ORDERS}/accept")
    async def accept(wanted: ModelOrderRequest) -> dict[str, str]:
        return await change_model(control.accept, wanted)

    @app.post(f"{ORDERS}/revert")
    async def revert(wanted: ModelOrderRequest) -> dict[str, str]:
        return await change_model(control.revert, wanted)

    @app.get(f"{ORDERS}/audit")
    async def entries() -> list[dict[str, Any]]:
        return [] if audit is None else await answer(audit.last, SHOWN_ENTRIES)

    # To be offered before the token is typed; the page shows door ids to everybody anyway.
    @app.get("/doors")
    async def doors(prefix: Annotated[Printable, Query(max_length=LONGEST_ID)] = "") -> list[str]:
        if searching.locked():
            raise HTTPException(
                503, "the recipe database is asked by others; type on, or type the whole id of the door"
            )
        async with searching:
            return await answer(control.doors, prefix, threads=searches)
