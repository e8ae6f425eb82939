"""Paths, verbs and answers of one version of the web services, as a table."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from starlette.routing import Match, Route

from doormill_ros.simulation.controller.rws_server.files import RAMDISK_PATH
from doormill_ros.simulation.controller.rws_server.operations import Form, Operations
from doormill_ros.simulation.controller.rws_server.reply import (
    CODE_INVALID,
    CODE_NO_RESOURCE,
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
        owner: The session it came in.
        newest_first: The event log is asked for in the order that only media type 2.1 has.
    """

    method: str
    path: str
    query: Form
    form: Form
    body: bytes
    owner: str
    newest_first: bool = False

    @property
    def implicit(self) -> bool:
        """Whether mastership is to be taken for this request alone."""
        return self.query.get("mastership") == "implicit"


@dataclass(frozen=True)
class RwsAnswer:
    """Status with a list of items, or raw bytes for a file."""

    status: int
    items: tuple[Item, ...] = ()
    raw: bytes | None = None


Handler = Callable[[Operations, RwsCall, str], RwsAnswer]
Action = Callable[[Operations, RwsCall, str], None]


class RwsRoute(Route):
    """A verb, a path (with at most one part to be filled in) and, in 1.0, the action in the query."""

    def __init__(self, method: str, path: str, handler: Handler, action: str = "") -> None:
        """Take "/files/{path:path}" as Starlette does."""
        super().__init__(path, handler)
        self.methods = {method}
        self.handler, self.action = handler, action


def dispatch(routes: tuple[RwsRoute, ...], operations: Operations, call: RwsCall) -> RwsAnswer:
    """Find the route and run it.

    Raises:
        RefusalError: 404 no such path, 405 not with this verb, or what the operation refuses.
    """
    scope = {"type": "http", "method": call.method, "path": f"/{call.path}"}
    known_path = False
    for route in routes:
        match, found = route.matches(scope)
        filled_in = [str(value) for value in found.get("path_params", {}).values()]
        if match is Match.NONE or "" in filled_in:
            continue
        known_path = True
        if match is Match.FULL and route.action == call.query.get("action", ""):
            return route.handler(operations, call, "".join(filled_in))
    if known_path:
        raise RefusalError(405, CODE_INVALID, f"{call.method} is not allowed on /{call.path}")
    raise RefusalError(404, CODE_NO_RESOURCE, f"no resource /{call.path}")


def _ok(*items: Item) -> RwsAnswer:
    return RwsAnswer(200, tuple(items))


def _show(reader: Callable[[Operations], Item]) -> Handler:
    return lambda operations, _, __: _ok(reader(operations))


def _list(reader: Callable[[Operations], list[Item]]) -> Handler:
    return lambda operations, _, __: _ok(*reader(operations))


def _done(action: Action, status: int = 204) -> Handler:
    """A handler that acts and answers without content."""

    def handle(operations: Operations, call: RwsCall, path: str) -> RwsAnswer:
        action(operations, call, path)
        return RwsAnswer(status)

    return handle


def _get_file(operations: Operations, _: RwsCall, path: str) -> RwsAnswer:
    path = path.removesuffix("/")
    if operations.files.is_folder(path):
        return _ok(*operations.files.entries(path))
    return RwsAnswer(200, raw=operations.files.read(path))


def _put_file(operations: Operations, call: RwsCall, path: str) -> RwsAnswer:
    operations.rights.require_station(call.owner)
    return RwsAnswer(201 if operations.files.write(path, call.body) else 200)


def _delete_file(operations: Operations, call: RwsCall, path: str) -> None:
    operations.rights.require_station(call.owner)
    operations.files.delete(path)


def _make_folder(operations: Operations, call: RwsCall, path: str) -> None:
    operations.rights.require_station(call.owner)
    operations.files.make_folder(path.removesuffix("/"), call.form.get("fs-newname", ""))


def _log(operations: Operations, call: RwsCall, _: str) -> RwsAnswer:
    newest_first = operations.version == 1 or (call.newest_first and call.query.get("order") == "lifo")
    return _ok(*operations.event_log(newest_first))


def _panel(what: str) -> Handler:
    return lambda operations, _, __: _ok(operations.panel(what))


def _take(operations: Operations, call: RwsCall, domain: str) -> None:
    operations.rights.request(domain or "", call.owner)


def _give(operations: Operations, call: RwsCall, domain: str) -> None:
    operations.rights.release(domain or "", call.owner)


_SIGNALS = "/rw/iosystem/signals"
_EXECUTION = "/rw/rapid/execution"
_UNIT = "/rw/motionsystem/mechunits/ROB_1"
_STATION = "/rw/controlstation"

_WRITE_SIGNAL = _done(lambda o, call, path: o.write_signal(path, call.form, call.owner))
_MOTORS = _done(lambda o, call, _: o.set_motors(call.form, call.owner))
_DELETE = _done(_delete_file)
_MAKE_FOLDER = _done(_make_folder, 201)
_SPEED = _done(lambda o, call, _: o.set_speed_ratio(call.form, call.owner))
_START = _done(lambda o, call, _: o.start(call.owner, call.implicit))
_STOP = _done(lambda o, call, _: o.stop(call.form, call.owner))
_RESET = _done(lambda o, call, _: o.reset_pointer(call.owner, call.implicit))
_WRITE_SYMBOL = _done(lambda o, call, path: o.write_symbol(path, call.form, call.owner, call.implicit))
_CREATE_QUEUE = _done(lambda o, call, _: o.queues.create(call.form), 201)
_SEND = _done(lambda o, call, name: o.queues.send(name, call.form))
_CANCEL = _done(lambda o, call, _: o.rights.cancel(call.owner))


def _read_symbol(operations: Operations, _: RwsCall, path: str) -> RwsAnswer:
    return _ok(operations.symbol(path))


def _symbol_properties(operations: Operations, _: RwsCall, path: str) -> RwsAnswer:
    return _ok(operations.symbol_properties(path))


def _activate(active: bool) -> Handler:
    return _done(lambda o, call, task: o.activate(task or call.form.get("task", ""), active, call.owner))


def _ramdisk(*_: object) -> RwsAnswer:
    return _ok(Item("ctrl-env", "RAMDISK", "", {"_value": RAMDISK_PATH, "value": RAMDISK_PATH}))


_BOTH = (
    RwsRoute("GET", _SIGNALS, _list(Operations.list_signals)),
    RwsRoute("GET", f"{_SIGNALS}/{{path:path}}", lambda o, _, path: _ok(o.signal_item(o.signal(path)))),
    RwsRoute("GET", _EXECUTION, _show(Operations.execution)),
    RwsRoute("GET", "/rw/rapid/tasks", _list(Operations.tasks)),
    RwsRoute("GET", "/rw/rapid/tasks/T_ROB1/modules", _list(Operations.modules)),
    RwsRoute("GET", "/rw/rapid/tasks/T_ROB1/modules/{name}", lambda o, _, name: _ok(o.module(name))),
    RwsRoute("GET", "/rw/panel/opmode", _panel("opmode")),
    RwsRoute("GET", "/rw/panel/speedratio", _panel("speedratio")),
    RwsRoute("POST", "/rw/panel/speedratio", _SPEED, "setspeedratio"),
    RwsRoute("GET", "/rw/system", _show(Operations.system)),
    RwsRoute("GET", "/rw/elog/0", _log),
    RwsRoute("GET", "/rw/elog/0/{number:int}", lambda o, _, number: _ok(o.event_log_entry(int(number)))),
    RwsRoute("GET", f"{_UNIT}/jointtarget", _show(Operations.joint_target)),
    RwsRoute("GET", f"{_UNIT}/robtarget", lambda o, call, _: _ok(o.robot_target(call.query))),
    RwsRoute("GET", "/ctrl/RAMDISK", _ramdisk),
    RwsRoute("GET", "/ctrl/$RAMDISK", _ramdisk),
    RwsRoute("GET", "/users/rmmp", lambda o, call, _: _ok(o.rights.privilege(call.owner))),
    RwsRoute("GET", "/users/rmmp/poll", lambda o, call, _: _ok(o.rights.poll(call.owner))),
    RwsRoute(
        "POST",
        "/users/rmmp",
        _done(lambda o, call, _: o.rights.ask(call.owner, call.form.get("privilege", "")), 202),
    ),
    RwsRoute("GET", "/fileservice/{path:path}", _get_file),
    RwsRoute("PUT", "/fileservice/{path:path}", _put_file),
    RwsRoute("DELETE", "/fileservice/{path:path}", _DELETE),
)

#: `$` is literal, actions stand in the query.
RWS1_ROUTES = (
    *_BOTH,
    RwsRoute("POST", f"{_SIGNALS}/{{path:path}}", _WRITE_SIGNAL, "set"),
    RwsRoute("POST", "/fileservice/{path:path}", _MAKE_FOLDER),
    RwsRoute("POST", "/fileservice/{path:path}", _MAKE_FOLDER, "create"),
    RwsRoute("POST", _EXECUTION, _START, "start"),
    RwsRoute("POST", _EXECUTION, _STOP, "stop"),
    RwsRoute("POST", _EXECUTION, _RESET, "resetpp"),
    RwsRoute("POST", "/rw/rapid/tasks/{name}", _activate(True), "activate"),
    RwsRoute("POST", "/rw/rapid/tasks/{name}", _activate(False), "deactivate"),
    RwsRoute("POST", "/rw/rapid/symbols", _list(Operations.list_symbols), "search-symbols"),
    RwsRoute("GET", "/rw/rapid/symbol/data/RAPID/{path:path}", _read_symbol),
    RwsRoute("GET", "/rw/rapid/symbol/properties/RAPID/{path:path}", _symbol_properties),
    RwsRoute("POST", "/rw/rapid/symbol/data/RAPID/{path:path}", _WRITE_SYMBOL, "set"),
    RwsRoute("GET", "/rw/panel/ctrlstate", _panel("ctrlstate")),
    RwsRoute("POST", "/rw/panel/ctrlstate", _MOTORS, "setctrlstate"),
    RwsRoute("POST", "/rw/mastership", _done(_take), "request"),
    RwsRoute("POST", "/rw/mastership/{domain}", _done(_take), "request"),
    RwsRoute("POST", "/rw/mastership", _done(_give), "release"),
    RwsRoute("POST", "/rw/mastership/{domain}", _done(_give), "release"),
    RwsRoute("POST", "/users/rmmp", _CANCEL, "cancel"),
    RwsRoute("POST", "/rw/dipc", _CREATE_QUEUE, "dipc-create"),
    RwsRoute("POST", "/rw/dipc/{name}", _SEND, "dipc-send"),
    RwsRoute("GET", "/rw/dipc/{name}", lambda o, _, name: _ok(*o.queues.read(name)), "dipc-read"),
    RwsRoute("DELETE", "/rw/dipc/{name}", _done(lambda o, _, name: o.queues.delete(name))),
)

#: No `$`, actions are part of the path.
RWS2_ROUTES = (
    *_BOTH,
    RwsRoute("POST", f"{_SIGNALS}/{{path:path}}/set-value", _WRITE_SIGNAL),
    RwsRoute("POST", "/fileservice/{path:path}/create", _MAKE_FOLDER),
    RwsRoute("POST", f"{_EXECUTION}/start", _START),
    RwsRoute("POST", f"{_EXECUTION}/stop", _STOP),
    RwsRoute("POST", f"{_EXECUTION}/resetpp", _RESET),
    RwsRoute("POST", "/rw/rapid/tasks/activate", _activate(True)),
    RwsRoute("POST", "/rw/rapid/tasks/deactivate", _activate(False)),
    RwsRoute("POST", "/rw/rapid/symbols/search", _list(Operations.list_symbols)),
    RwsRoute("GET", "/rw/rapid/symbol/RAPID/{path:path}/data", _read_symbol),
    RwsRoute("GET", "/rw/rapid/symbol/RAPID/{path:path}/properties", _symbol_properties),
    RwsRoute("POST", "/rw/rapid/symbol/RAPID/{path:path}/data", _WRITE_SYMBOL),
    RwsRoute("GET", "/rw/panel/ctrl-state", _panel("ctrlstate")),
    RwsRoute("POST", "/rw/panel/ctrl-state", _MOTORS),
    RwsRoute("POST", "/rw/mastership/request", _done(_take)),
    RwsRoute("POST", "/rw/mastership/{domain}/request", _done(_take)),
    RwsRoute("POST", "/rw/mastership/release", _done(_give)),
    RwsRoute("POST", "/rw/mastership/{domain}/release", _done(_give)),
    RwsRoute("POST", "/users/rmmp/cancel", _CANCEL),
    RwsRoute(
        "POST",
        f"{_STATION}/register/remote",
        _done(lambda o, call, _: o.rights.control_stations().register(call.owner, call.form)),
    ),
    RwsRoute(
        "POST",
        f"{_STATION}/writeaccess/request",
        _done(lambda o, call, _: o.rights.control_stations().request(call.owner)),
    ),
    RwsRoute(
        "POST",
        f"{_STATION}/writeaccess/release",
        _done(lambda o, call, _: o.rights.control_stations().release(call.owner)),
    ),
    RwsRoute(
        "GET", f"{_STATION}/writeaccess/status", lambda o, _, __: _ok(o.rights.control_stations().status())
    ),
)
