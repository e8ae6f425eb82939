"""Event routines: which routine of a task runs on which event, from the system parameters, SYS.cfg.

The form, `CAB_EXEC_HOOKS:` with `-Routine`, `-Shelf` and `-Task`, is that of public backups and of programs that
read them (github.com, "BackupFindEventRoutines" in RobotWare backup checkers). That a routine which is missing,
a function, or has parameters is refused, and that an event takes twenty routines, is [?].
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path

from doormill_ros.abb.errors import AbbError
from doormill_ros.simulation.controller.configuration.cfg_lines import entries, lines_of
from doormill_ros.simulation.controller.rapid.errors import EventRoutinesError
from doormill_ros.simulation.controller.rapid.program import RapidProgram

#: Events by the names of their shelves, as they are called here.
EVENTS = {
    "POWER_ON": "POWERON", "POWERON": "POWERON", "START": "START", "STEP": "STEP", "RESTART": "RESTART",
    "STOP": "STOP", "QSTOP": "QSTOP", "RESET": "RESET",
}  # fmt: skip
_LARGEST = 20
_KEYS = {"Routine", "Shelf", "Task", "AllTask", "AllMotionTask", "SeqNo"}
_PAIR = re.compile(r'-(\w+)(?:\s+"([^"]*)"|\s+([^\s"-][^\s"]*))?')


def read_event_routines(path: Path, task: str = "T_ROB1") -> dict[str, tuple[str, ...]]:
    r"""Names of the routines of each event of a task, in the order in which they run.

    Args:
        path: SYS.cfg; a backslash at the end of a line continues it.
        task: The task.

    Raises:
        EventRoutinesError: No plain text, or an entry that cannot be; names byte or line.
    """
    section = ""
    found: dict[str, list[tuple[float, str]]] = {}
    lines = lines_of(path, EventRoutinesError)
    for start, entry in entries(lines):
        if re.fullmatch(r"[A-Z_0-9]+:", entry):
            section = entry[:-1]
        elif section == "CAB_EXEC_HOOKS":
            keys = {m[1]: m[2] if m[2] is not None else m[3] or "" for m in _PAIR.finditer(entry)}
            event, order, routine, of_task = _entry(path, start, keys)
            if of_task in (task, None):
                found.setdefault(event, []).append((order, routine))
    for event, routines in found.items():
        if len(routines) > _LARGEST:
            raise EventRoutinesError(
                f"{path}: {event} has {len(routines)} routines, allowed are {_LARGEST}: call some from others"
            )
    return {event: tuple(name for _, name in sorted(r, key=lambda i: i[0])) for event, r in found.items()}


def _entry(path: Path, line: int, keys: dict[str, str]) -> tuple[str, float, str, str | None]:
    """Event, order, routine and task (None for all) of one entry."""

    def refuse(found: str, allowed: str) -> AbbError:
        return EventRoutinesError(
            f"{path}, line {line}: {found}, allowed is {allowed}: correct it", line=line
        )

    unknown = sorted(set(keys) - _KEYS)
    if unknown:
        raise refuse(f"found -{unknown[0]}", ", ".join(sorted(_KEYS)))
    if not keys.get("Routine"):
        raise refuse("an entry without -Routine", '-Routine "name"')
    if keys.get("Shelf") not in EVENTS:
        raise refuse(f"-Shelf is {keys.get('Shelf')!r}", ", ".join(EVENTS))
    everywhere = "AllTask" in keys or "AllMotionTask" in keys
    if not everywhere and not keys.get("Task"):
        raise refuse("an entry without a task", '-Task "T_ROB1" or -AllTask')
    order = keys.get("SeqNo") or "0"
    if not order.isdigit():
        raise refuse(f"-SeqNo is {order!r}", "a whole number")
    return EVENTS[keys["Shelf"]], float(order), keys["Routine"], None if everywhere else keys["Task"]


def check_event_routines(routines: Mapping[str, tuple[str, ...]], program: RapidProgram) -> None:
    """Refuse event routines that the loaded modules do not have.

    Raises:
        EventRoutinesError: Names the event and the routine.
    """
    for event, names in routines.items():
        for name in names:
            if not program.has_procedure(name):
                raise EventRoutinesError(
                    f"event {event} calls {name}, allowed is a loaded procedure without parameters: load its "
                    "module or correct SYS.cfg",
                    event=event,
                    routine=name,
                )
