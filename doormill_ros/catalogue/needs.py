"""Inspections that lie on the disk and need a bag, whether or not the catalogue knows of them."""

from __future__ import annotations

import os
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path

from doormill_ros.catalogue.errors import BadRetentionError, BadRunRecordError
from doormill_ros.cell.graph.node_names import MODEL_MONITOR
from doormill_ros.cell.output.inspection_files import DESCRIPTION
from doormill_ros.config import read_document
from doormill_ros.resources import resource, site_folder

NODES, PARAMETER, SHIPPED = "config/nodes.yaml", "inspections", "out/inspections"


@dataclass(frozen=True)
class Needs:
    """What inspections in some places need.

    Attributes:
        runs: Folder of an inspection by the run that it names.
        bags: Folder of an inspection by the bag that it names.
        unreadable: What could not be looked into; it may need anything that is near.
    """

    runs: dict[str, Path] = field(default_factory=dict)
    bags: dict[Path, Path] = field(default_factory=dict)
    unreadable: list[Path] = field(default_factory=list)

    def of(self, bag: Path, run_ids: Iterable[str]) -> str:
        """Why a bag with these runs is needed; empty where it is not."""
        found = self.bags.get(bag.resolve())
        for run_id in run_ids:
            found = found or self.runs.get(run_id)
        if found is not None:
            return f"the inspection {found} needs it"
        beside = bag.resolve().parent
        doubtful = next((path for path in self.unreadable if path.is_relative_to(beside)), None)
        return "" if doubtful is None else f"nobody knows what {doubtful} needs: it cannot be read"


def find_needs(places: Iterable[Path]) -> Needs:
    """The inspections below some places, at any depth and behind links.

    Args:
        places: Folders; one that is not there holds none.
    """
    needs, done = Needs(), set[str]()
    waiting = sorted({str(place.resolve()) for place in places if place.is_dir()})
    while waiting:
        for name, folders, files in os.walk(waiting.pop(0), onerror=lambda error: _doubt(needs, error)):
            if name in done:
                folders.clear()
                continue
            done.add(name)
            if DESCRIPTION in files:
                _take(needs, Path(name))
            links = (os.path.join(name, folder) for folder in folders)
            waiting += [os.path.realpath(link) for link in links if os.path.islink(link)]
    return needs


def _doubt(needs: Needs, error: OSError) -> None:
    needs.unreadable.append(Path(error.filename))


def _take(needs: Needs, folder: Path) -> None:
    try:
        document = read_document(folder / DESCRIPTION, BadRunRecordError)
    except BadRunRecordError:
        document = None
    run_id, bag = (
        (document.get("run_id"), document.get("bag")) if isinstance(document, dict) else (None, None)
    )
    if isinstance(run_id, str):
        needs.runs[run_id] = folder
    else:
        needs.unreadable.append(folder)
        needs.runs.setdefault(folder.name, folder)  # the monitor names its folders by the runs
    if isinstance(bag, str) and "\x00" not in bag:
        needs.bags[(folder / bag).resolve()] = folder


def monitor_folders() -> list[Path]:
    """Where /model_monitor of this site keeps inspections, by the parameters of the nodes; those that are there.

    A relative folder is looked for in the working directory and in the site's folder, where services run.

    Raises:
        BadRetentionError: The file of parameters cannot be read.
    """
    document = read_document(resource(NODES), BadRetentionError, "correct it, or name the folder")
    nodes = document if isinstance(document, dict) else {}
    named = [
        _parameter(node)
        for name, node in nodes.items()
        if str(name).rsplit("/", 1)[-1] in (MODEL_MONITOR, "**")
    ]
    folders = [name for name in named if name] or [SHIPPED]
    places = {base.absolute() / name for name in folders for base in (Path(), site_folder())}
    return sorted(place for place in places if place.is_dir())


def _parameter(node: object) -> str:
    parameters = node.get("ros__parameters") if isinstance(node, dict) else None
    value = parameters.get(PARAMETER) if isinstance(parameters, dict) else None
    return value if isinstance(value, str) else ""
