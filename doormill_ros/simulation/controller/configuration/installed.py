"""What is installed on a controller before it is switched on: modules, signals, event routines."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from doormill_ros.resources import resource
from doormill_ros.simulation.controller.configuration.event_routines import read_event_routines
from doormill_ros.simulation.controller.configuration.io_configuration import (
    IoConfiguration,
    read_io_configuration,
)
from doormill_ros.simulation.controller.operation.configuration import SystemOutputs, read_system_outputs
from doormill_ros.simulation.controller.rapid.kept import shipped_modules
from doormill_ros.simulation.controller.rapid.syntax import Module

#: What the project ships for the controller.
OWN_MODULES = tuple(
    f"rapid/Door{name}.mod"
    for name in ("Text", "Cell", "Stop", "Back", "Tool", "Link", "Path", "Line", "File", "Mill")
)
IO_CONFIGURATION = "rapid/EIO.cfg"
SYSTEM_PARAMETERS = "rapid/SYS.cfg"


@dataclass(frozen=True)
class Installed:
    """Modules and system parameters.

    Attributes:
        modules: Syntax trees of the modules.
        signals: The I/O configuration.
        outputs: What the system itself writes.
        event_routines: Names of the routines of each event, in the order in which they run.
    """

    modules: tuple[Module, ...]
    signals: IoConfiguration
    outputs: SystemOutputs
    event_routines: Mapping[str, tuple[str, ...]]


def read_installed(
    modules: Sequence[str | Path] | None = None,
    io_configuration: Path | None = None,
    system_parameters: Path | None = None,
) -> Installed:
    """Read modules and system parameters.

    Args:
        modules: Module files; None for the project's own.
        io_configuration: EIO.cfg; None for the project's own.
        system_parameters: SYS.cfg with the event routines; None for that of the project's own modules, and for no
            event routines with others.

    Raises:
        AbbError: What the modules or the configurations do wrong, with file and line.
    """
    if system_parameters is None and modules is None:
        system_parameters = resource(SYSTEM_PARAMETERS)
    eio = io_configuration or resource(IO_CONFIGURATION)
    return Installed(
        shipped_modules(_texts(map(resource, OWN_MODULES))) if modules is None else _parsed(_texts(modules)),
        read_io_configuration(eio),
        read_system_outputs(eio),
        {} if system_parameters is None else read_event_routines(system_parameters),
    )


def _texts(paths: Iterable[str | Path]) -> tuple[tuple[str, str], ...]:
    """What messages call the modules and their texts; controllers write ISO 8859-1."""
    return tuple((path.name, path.read_bytes().decode("latin-1")) for path in map(Path, paths))


def _parsed(texts: tuple[tuple[str, str], ...]) -> tuple[Module, ...]:
    """Modules of somebody's own."""
    from doormill_ros.simulation.controller.rapid.parser import (
        parse_module,  # late: those that ship are kept parsed
    )

    return tuple(parse_module(text, file) for file, text in texts)
