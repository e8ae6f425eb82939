"""Orders from the operator's page: who may give them, and what carries them out."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Annotated, Any, Protocol, TypeVar

from fastapi import Depends, FastAPI, HTTPException, Query, Request
from fastapi.concurrency import run_in_threadpool
from pydantic import BaseModel, Field

from doormill_ros.errors import DoormillError
from doormill_ros.operator.audit import AuditLog
from doormill_ros.operator.order_texts import Printable
from doormill_ros.operator.token import Keys, Role
from doormill_ros.operator.tries import Tries

Value = TypeVar("Value")

LONGEST_ID = 100  # characters
LONGEST_REASON = 500  # characters
SHOWN_ENTRIES = 500


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


class Doorkeeper:
    """Lets in who has a token of the role that an order needs.

    Args:
        keys: The tokens.
        tries: Wrong tokens so far.
    """

    def __init__(self, keys: Keys, tries: Tries) -> None:
        self._keys = keys
        self._tries = tries

    def needs(self, role: Role) -> Any:
        """A dependency; refuses with 401 who has no token, 403 whose token is for less, 429 who guesses."""

        async def allowed(request: Request) -> None:
            address = request.client.host if request.client else ""
            wait = math.ceil(self._tries.wait(address))
            if wait > 0:
                raise HTTPException(
                    429,
                    f"too many wrong tokens came from {address}; wait {wait} s, then try again with the right one",
                    {"Retry-After": str(wait)},
                )
            header = request.headers.get("authorization")
            found = self._keys.holder(header)
            if found is None:
                if header:  # without one nothing was guessed
                    self._tries.failed(address)
                raise HTTPException(
                    401,
                    "the token is missing or wrong; it was printed when the cell was started",
                    {"WWW-Authenticate": "Bearer"},
                )
            request.state.holder = found
            if found.role < role:
                raise HTTPException(
                    403,
                    f"this token allows to {found.role.word}, the order needs the token of the {role.word}",
                )

        return Depends(allowed)


def serve_orders(app: FastAPI, control: Control, doorkeeper: Doorkeeper, audit: AuditLog | None) -> None:
    """Add the orders to the application.

    Args:
        app: The application.
        control: Carries them out.
        doorkeeper: Knows who may give which.
        audit: Where they are written down; a run that cannot be written down is not started.
    """
    operate, engineer = doorkeeper.needs(Role.OPERATE), doorkeeper.needs(Role.ENGINEER)

    async def answer(action: Callable[..., Value], *arguments: Any) -> Value:
        try:
            return await run_in_threadpool(action, *arguments)
        except DoormillError as error:
            raise HTTPException(409, error.message, {"Error-Code": str(error.code)}) from error

    # The token is looked at before the body is.
    @app.get("/control", dependencies=[operate])
    async def check() -> dict[str, str]:
        return {"message": "the token is right"}

    @app.post("/control/mill", dependencies=[operate], status_code=202)
    async def mill(wanted: MillRequest, request: Request) -> dict[str, str]:
        request.state.door_id = wanted.door_id
        if audit is not None:
            await answer(audit.require)
        return {"message": await answer(control.mill, wanted.door_id)}

    # Carried out even where it cannot be written down: it makes nothing move.
    @app.post("/control/cancel", dependencies=[operate], status_code=202)
    async def cancel() -> dict[str, str]:
        return {"message": await answer(control.cancel)}

    async def change_model(
        action: Callable[[int, str, str], str], wanted: ModelOrderRequest
    ) -> dict[str, str]:
        if audit is not None:
            await answer(audit.require)
        return {"message": await answer(action, wanted.version, wanted.who, wanted.why)}

    @app.post("/control/accept", dependencies=[engineer])
    async def accept(wanted: ModelOrderRequest) -> dict[str, str]:
        return await change_model(control.accept, wanted)

    @app.post("/control/revert", dependencies=[engineer])
    async def revert(wanted: ModelOrderRequest) -> dict[str, str]:
        return await change_model(control.revert, wanted)

    @app.get("/control/audit", dependencies=[engineer])
    async def entries() -> list[dict[str, Any]]:
        return [] if audit is None else await run_in_threadpool(audit.last, SHOWN_ENTRIES)

    # To be offered before the token is typed; the page shows door ids to everybody anyway.
    @app.get("/doors")
    async def doors(prefix: Annotated[Printable, Query(max_length=LONGEST_ID)] = "") -> list[str]:
        return await answer(control.doors, prefix)
