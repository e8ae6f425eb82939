"""Where aravis comes from: GObject introspection, of the environment or of the system."""

from __future__ import annotations

import importlib
import sys
from importlib.machinery import PathFinder
from importlib.util import module_from_spec
from types import ModuleType
from typing import Any, NamedTuple

from doormill_ros.localization.gige.errors import AravisMissing

VERSION = "0.8"
#: Of Debian and Ubuntu. A virtual environment does not look there.
SYSTEM = "/usr/lib/python3/dist-packages"


class Aravis(NamedTuple):
    """The library's namespace, and the class of the errors that its calls raise."""

    names: Any
    error: type[Exception]


def load_aravis(system: str = SYSTEM) -> Aravis:
    """Load the library.

    Args:
        system: Folder with the system's `gi`, taken where the environment has none.

    Raises:
        AravisMissing: There is no `gi` for this Python, or no aravis for that.
    """
    try:
        _gi(system).require_version("Aravis", VERSION)
        names, glib = (importlib.import_module(f"gi.repository.{name}") for name in ("Aravis", "GLib"))
    except (ImportError, ValueError) as error:
        version = f"{sys.version_info.major}.{sys.version_info.minor}"
        raise AravisMissing(
            f"aravis cannot be loaded ({error}), needed are gi for Python {version} and aravis {VERSION}; install "
            f"libaravis-{VERSION}-0, gir1.2-aravis-{VERSION} and python3-gi, or PyGObject by pip in place of the last"
        ) from error
    return Aravis(names, glib.Error)


def _gi(system: str) -> ModuleType:
    """The package `gi`; of the system's packages this one alone is let in."""
    if "gi" in sys.modules:
        return sys.modules["gi"]
    spec = PathFinder.find_spec("gi") or PathFinder.find_spec("gi", [system])
    if spec is None or spec.loader is None:
        raise ImportError(f"there is no gi on Python's path or in {system}")
    sys.modules["gi"] = package = module_from_spec(spec)
    try:
        spec.loader.exec_module(package)
    except ImportError:
        for name in [n for n in sys.modules if n == "gi" or n.startswith("gi.")]:
            del sys.modules[name]
        raise
    return package
