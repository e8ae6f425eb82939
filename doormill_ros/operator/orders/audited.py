"""Writes every order into the audit log before it is answered, whoever answers it."""

from __future__ import annotations

import json
from collections.abc import Callable
from datetime import UTC, datetime

from starlette.types import ASGIApp, Message, Receive, Scope, Send

from doormill_ros.operator.access.order_paths import is_order
from doormill_ros.operator.access.token import Holder, Role
from doormill_ros.operator.errors import AuditError
from doormill_ros.operator.orders.audit import AuditEntry, AuditLog


class Audited:
    """Stands before everything that may refuse an order.

    What lets an order in leaves `holder` in the request's state, what carries it out `door_id`.

    Args:
        app: What answers.
        audit: The log.
        complain: Told in a sentence that the log cannot be written, with an empty one that it can be.
    """

    def __init__(self, app: ASGIApp, audit: AuditLog, complain: Callable[[str], None]) -> None:
        self._app = app
        self._audit = audit
        self._complain = complain

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass the request on and keep the answer until it is written down."""
        if not is_order(scope):
            await self._app(scope, receive, send)
            return
        scope["state"] = {}
        answer: list[Message] = []

        async def keep(message: Message) -> None:
            answer.append(message)

        try:
            await self._app(scope, receive, keep)
        finally:
            self._write(scope, answer)
        for message in answer:
            await send(message)

    def _write(self, scope: Scope, answer: list[Message]) -> None:
        holder: Holder | None = scope["state"].get("holder")
        # Without an answer the order ended in an error that nobody foresaw.
        status = answer[0]["status"] if answer else 500
        entry = AuditEntry(
            time=datetime.now(UTC).isoformat(timespec="milliseconds"),
            role=(holder.role if holder else Role.LOOK).word,
            who=holder.name if holder else "",
            address=scope["client"][0] if scope.get("client") else "",
            order=f"{scope['method']} {scope['path']}",
            door_id=scope["state"].get("door_id", ""),
            outcome="accepted" if status < 400 else "refused",
            status=status,
            message=_sentence(b"".join(message.get("body", b"") for message in answer)),
        )
        try:
            self._audit.write(entry, holder is not None)
        except AuditError as error:
            self._complain(error.message)
        else:
            self._complain("")


def _sentence(body: bytes) -> str:
    try:
        document = json.loads(body)
    except ValueError:
        return body.decode(errors="replace")
    if not isinstance(document, dict):
        return ""
    detail = document.get("message") or document.get("detail") or ""
    if isinstance(detail, list):  # of a body that is no order
        return "; ".join(str(item.get("msg", "")) for item in detail)
    return str(detail)
