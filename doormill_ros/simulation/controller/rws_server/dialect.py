"""Paths, verbs and answers of one version of the web services, as a table."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass

from doormill_ros.simulation.controller.rws_server.operations import Form, Operations
from doormill_ros.simulation.controller.rws_server.reply import (
    CODE_BAD_REQUEST,
    CODE_NOT_FOUND,
    Item,
    RefusalError,
)


@dataclass(frozen=True)
class RwsCall:
    """One request, taken apart.

    Attributes:
        method: HTTP verb.
        path: Decoded path without its leading "/".
        query: Query fields.
        form: Fields of the body.
        body: The raw body.
    """

    method: str
    path: str
    query: Form
    form: Form
    body: bytes


@dataclass(frozen=True)
class RwsAnswer:
    """Status with a list of items, or raw bytes for a file."""

    status: int
    items: tuple[Item, ...] = ()
    raw: bytes | None = None


Handler = Callable[[Operations, RwsCall, str], RwsAnswer]
Action = Callable[[Operations, RwsCall, str], None]


@dataclass(frozen=True)
class Route:
    """A verb, a pattern of paths (with at most one group) and, in 1.0, the action in the query."""

    method: str
    pattern: str
    handler: Handler
    action: str | None = None


def dispatch(routes: tuple[Route, ...], operations: Operations, call: RwsCall) -> RwsAnswer:
    """Find the route and run it.

    Raises:
        RefusalError: 404 no such path, 405 not with this verb, or what the operation refuses.
    """
    known_path = False
    for route in routes:
        match = re.fullmatch(route.pattern, call.path)
        if match is None:
            continue
        known_path = True
        if route.method != call.method or (route.action or "") != call.query.get("action", ""):
            continue
        return route.handler(operations, call, match.group(1) if match.groups() else "")
    if known_path:
        raise RefusalError(405, CODE_BAD_REQUEST, f"{call.method} is not allowed on /{call.path}")
    raise RefusalError(404, CODE_NOT_FOUND, f"no resource /{call.path}")


def _ok(*items: Item) -> RwsAnswer:
    return RwsAnswer(200, tuple(items))


def _done(action: Action) -> Handler:
    """A handler that acts and answers without content."""

    def handle(operations: Operations, call: RwsCall, path: str) -> RwsAnswer:
        action(operations, call, path)
        return RwsAnswer(204)

    return handle


def _get_file(operations: Operations, _: RwsCall, path: str) -> RwsAnswer:
    if operations.path(path).is_dir():
        return _ok(*operations.list_folder(path))
    return RwsAnswer(200, raw=operations.read_file(path))


def _put_file(operations: Operations, call: RwsCall, path: str) -> RwsAnswer:
    return RwsAnswer(201 if operations.write_file(path, call.body) else 200)


def _make_folder(operations: Operations, call: RwsCall, path: str) -> RwsAnswer:
    operations.make_folder(path, call.form.get("fs-newname", ""))
    return RwsAnswer(201)


def _read_symbol(operations: Operations, _: RwsCall, path: str) -> RwsAnswer:
    return _ok(operations.symbol(path))


def _symbol_writer(implicit: bool) -> Handler:
    def write(operations: Operations, call: RwsCall, path: str) -> None:
        implied = implicit and call.query.get("mastership") == "implicit"
        operations.write_symbol(path, call.form, implied)

    return _done(write)


def _execute(action: str) -> Handler:
    return _done(lambda operations, _, __: operations.control_execution(action))


def _panel(what: str) -> Handler:
    return lambda operations, _, __: _ok(operations.panel(what))


def _mastership(action: str) -> Handler:
    return _done(lambda operations, _, __: operations.mastership(action))


def _signal(operations: Operations, _: RwsCall, path: str) -> RwsAnswer:
    return _ok(operations.signal_item(operations.signal(path)))


def _ramdisk(*_: object) -> RwsAnswer:
    return _ok(Item("ctrl-env", "RAMDISK", "", {"_value": "/hd0a/temp", "value": "/hd0a/temp"}))


_SIGNALS = "rw/iosystem/signals"
_EXECUTION = "rw/rapid/execution"

_WRITE_SIGNAL = _done(lambda operations, call, path: operations.write_signal(path, call.form))
_MOTORS = _done(lambda operations, call, _: operations.set_motors(call.form))
_DELETE = _done(lambda operations, _, path: operations.delete(path))

_BOTH = (
    Route("GET", _SIGNALS, lambda operations, _, __: _ok(*operations.list_signals())),
    Route("GET", f"{_SIGNALS}/(.+)", _signal),
    Route("GET", _EXECUTION, lambda operations, _, __: _ok(operations.execution())),
    Route("GET", "rw/rapid/tasks", lambda operations, _, __: _ok(*operations.tasks())),
    Route("GET", "rw/panel/opmode", _panel("opmode")),
    Route("GET", "rw/elog/0/?", lambda *_: _ok()),
    Route("GET", "ctrl/\\$?RAMDISK", _ramdisk),
)

#: `$` is literal, actions stand in the query.
RWS1_ROUTES = (
    *_BOTH,
    Route("POST", f"{_SIGNALS}/(.+)", _WRITE_SIGNAL, "set"),
    Route("GET", r"fileservice/\$(?:home|HOME)/?(.*)", _get_file),
    Route("PUT", r"fileservice/\$(?:home|HOME)/(.+)", _put_file),
    Route("DELETE", r"fileservice/\$(?:home|HOME)/(.+)", _DELETE),
    Route("POST", r"fileservice/\$(?:home|HOME)/?(.*)", _make_folder),
    Route("POST", _EXECUTION, _execute("start"), "start"),
    Route("POST", _EXECUTION, _execute("stop"), "stop"),
    Route("POST", _EXECUTION, _execute("resetpp"), "resetpp"),
    Route("GET", "rw/rapid/symbol/data/RAPID/(.+)", _read_symbol),
    Route("POST", "rw/rapid/symbol/data/RAPID/(.+)", _symbol_writer(implicit=False), "set"),
    Route("GET", "rw/panel/ctrlstate", _panel("ctrlstate")),
    Route("POST", "rw/panel/ctrlstate", _MOTORS, "setctrlstate"),
    Route("POST", "rw/mastership(?:/rapid)?", _mastership("request"), "request"),
    Route("POST", "rw/mastership(?:/rapid)?", _mastership("release"), "release"),
)

#: No `$`, actions are part of the path.
RWS2_ROUTES = (
    *_BOTH,
    Route("POST", f"{_SIGNALS}/(.+)/set-value", _WRITE_SIGNAL),
    Route("GET", r"fileservice/HOME/?(.*)", _get_file),
    Route("PUT", r"fileservice/HOME/(.+)", _put_file),
    Route("DELETE", r"fileservice/HOME/(.+)", _DELETE),
    Route("POST", r"fileservice/HOME/?(.*?)/?create", _make_folder),
    Route("POST", f"{_EXECUTION}/start", _execute("start")),
    Route("POST", f"{_EXECUTION}/stop", _execute("stop")),
    Route("POST", f"{_EXECUTION}/resetpp", _execute("resetpp")),
    Route("GET", "rw/rapid/symbol/RAPID/(.+)/data", _read_symbol),
    Route("POST", "rw/rapid/symbol/RAPID/(.+)/data", _symbol_writer(implicit=True)),
    Route("GET", "rw/panel/ctrl-state", _panel("ctrl-state")),
    Route("POST", "rw/panel/ctrl-state", _MOTORS),
    Route("POST", "rw/mastership(?:/edit)?/request", _mastership("request")),
    Route("POST", "rw/mastership(?:/edit)?/release", _mastership("release")),
)
