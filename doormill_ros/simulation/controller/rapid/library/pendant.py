"""The pendant, the event log, clocks and ending a program."""

from __future__ import annotations

from doormill_ros.simulation.controller.rapid.context import Context
from doormill_ros.simulation.controller.rapid.faults import RapidFault, RapidStop
from doormill_ros.simulation.controller.rapid.library.predefined import predefined
from doormill_ros.simulation.controller.rapid.operators import num
from doormill_ros.simulation.controller.rapid.scope import Reference
from doormill_ros.simulation.controller.rapid.types import Value, format_value

#: Characters of a title in the event log.
TITLE = 46
#: Numbers of the events that programs write [?].
USER_EVENTS = {"error": 80001, "warning": 80002, "information": 80003}


@predefined("PROC TPWrite(string String \\num Num | bool Bool | pos Pos | orient Orient | dnum Dnum)")
def tp_write(
    context: Context,
    text: str,
    number: float | None,
    truth: bool | None,
    pos: Value | None,
    orient: Value | None,
    dnum: float | None,
) -> None:
    """Show a line on the pendant."""
    extra = next((value for value in (number, truth, pos, orient, dnum) if value is not None), None)
    context.machine.pendant(text if extra is None else text + format_value(extra))


@predefined("PROC TPErase()")
def tp_erase(_context: Context) -> None:
    """Clear the pendant; its lines are kept for the record."""


@predefined(
    "PROC ErrWrite(\\switch W | switch I, string Header, string Reason "
    "\\string RL2 \\string RL3 \\string RL4)"
)
def err_write(
    context: Context,
    warning: bool,
    information: bool,
    header: str,
    reason: str,
    second: str | None,
    third: str | None,
    fourth: str | None,
) -> None:
    """Write to the event log, and show it."""
    if len(header) > TITLE:
        raise RapidFault(
            "ERR_STRTOOLNG", f"ErrWrite: {len(header)} characters in the header, allowed are {TITLE}"
        )
    kind = "warning" if warning else "information" if information else "error"
    lines = [line for line in (reason, second, third, fourth) if line is not None]
    context.machine.log(kind, header, " ".join(lines), USER_EVENTS[kind])


@predefined("PROC SkipWarn()")
def skip_warn(context: Context) -> None:
    """In an ERROR clause: leave the warning of the error that it takes out of the event log."""
    context.warning = ""


@predefined("FUNC symnum OpMode()")
def op_mode(context: Context) -> float:
    """Operating mode, one of OP_AUTO, OP_MAN_PROG (reduced speed) and OP_MAN_TEST (full speed)."""
    return {"AUTO": 1.0, "MANR": 2.0, "MANF": 3.0}.get(context.machine.operating_mode(), 0.0)


@predefined("FUNC symnum RunMode(\\switch Main)")
def run_mode(_context: Context, _main: bool) -> float:
    """Only continuous execution is simulated: RUN_CONT_CYCLE."""
    return 1.0


@predefined("PROC BookErrNo(VAR errnum ErrorName)")
def book_err_no(context: Context, place: Reference) -> None:
    """Give an error of the program's own a number; only one that is still -1 may be booked."""
    if place[0][place[1]] != -1.0:
        raise RapidStop("BookErrNo: the error number is booked already, allowed is one that is -1")
    context.booked_errors += 1
    place[0][place[1]] = float(context.booked_errors)


@predefined("PROC Stop(\\switch NoRegain | switch AllMoveTasks)")
def stop(context: Context, _no_regain: bool, _all: bool) -> None:
    """Stop when the motions so far are done; a start goes on behind it."""
    context.machine.wait_in_position()
    context.machine.stop_program("Stop")


@predefined("PROC Break()")
def break_(context: Context) -> None:
    """Stop at once, on the path; a start goes on behind it."""
    context.machine.stop_program("Break")


@predefined("PROC ExitCycle()")
def exit_cycle(context: Context) -> None:
    """End this cycle: the robot stops, its paths are forgotten, and main begins anew (3HAC050917-001, ExitCycle)."""
    context.machine.forget_paths()
    raise RapidStop("the program ended its cycle", by_program=True)


@predefined("PROC ClkReset(VAR clock Clock)")
def clk_reset(_context: Context, place: Reference) -> None:
    """Set a clock to zero."""
    place[0][place[1]] = (0.0, None)


@predefined("PROC ClkStart(VAR clock Clock)")
def clk_start(context: Context, place: Reference) -> None:
    """Start a clock."""
    total, since = place[0][place[1]] or (0.0, None)
    place[0][place[1]] = (total, context.machine.now() if since is None else since)


@predefined("PROC ClkStop(VAR clock Clock)")
def clk_stop(context: Context, place: Reference) -> None:
    """Stop a clock."""
    total, since = place[0][place[1]] or (0.0, None)
    place[0][place[1]] = (total + (context.machine.now() - since if since is not None else 0.0), None)


@predefined("FUNC num ClkRead(VAR clock Clock)")
def clk_read(context: Context, place: Reference) -> float:
    """Seconds on a clock."""
    total, since = place[0][place[1]] or (0.0, None)
    return num(total + (context.machine.now() - since if since is not None else 0.0))
