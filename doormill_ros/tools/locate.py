"""locate: find a door in pictures or in readings of another sensor.

`locate --door standard_door PICTURE ...` prints pose, standard deviations, residual and quality of each picture, or
its refusal with the code. Several files are taken for the same door in the same place: how far their poses lie apart
is held against the stated covariance. `--sensor NAME` asks another sensor, see docs/sensors.md for its files.
"""

from __future__ import annotations

import argparse
import json
import math
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from doormill_ros.arrays import FloatArray
from doormill_ros.cell.places.layout import load_layout
from doormill_ros.errors import DoormillError
from doormill_ros.files import write_atomically
from doormill_ros.frames import BASE_FRAME
from doormill_ros.interrupts import interruptible
from doormill_ros.localization.camera import load_camera
from doormill_ros.localization.errors import LocalizationError
from doormill_ros.localization.overlay import draw_overlay, draw_refusal
from doormill_ros.localization.pictures.picture_file import read_picture, write_picture
from doormill_ros.localization.repeatability import Repeatability
from doormill_ros.localization.sensors.located import (
    LocatedDoor,
    compare_located,
    locate_in_picture,
    locate_with_sensor,
)
from doormill_ros.localization.sensors.readings import Reading, read_readings
from doormill_ros.localization.sensors.registry import SENSORS
from doormill_ros.localization.settings import load_settings
from doormill_ros.recipes.documents import load_recipe
from doormill_ros.recipes.door import DoorSize
from doormill_ros.resources import resource
from doormill_ros.tools.command_line import written_over
from doormill_ros.tools.one_line_parser import OneLineParser
from doormill_ros.units import m_to_mm, mm_to_m, rad_to_deg

SCHEMA = "doormill/located-doors/1"
Located = list[tuple[Reading, LocatedDoor | LocalizationError]]


def parse(argv: list[str] | None) -> argparse.Namespace:
    """The command line; leaves with status 2 when it is wrong."""
    top = OneLineParser(
        prog="locate", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    top.add_argument("files", metavar="FILE", nargs="+", type=Path, help="picture, or YAML with readings")
    door = top.add_mutually_exclusive_group(required=True)
    door.add_argument("--door", metavar="DOOR", help="id in the recipe database, or a recipe file")
    door.add_argument(
        "--size", nargs=3, type=_length, metavar=("WIDTH", "HEIGHT", "THICKNESS"), help="of the door [mm]"
    )
    top.add_argument("--camera", metavar="FILE", type=Path, help="camera file; default is config/camera.yaml")
    top.add_argument("--sensor", choices=sorted(SENSORS), help="default is the cell's own localizer")
    top.add_argument(
        "--config", metavar="FILE", type=Path, help="of the sensor; default is config/sensors/NAME.yaml"
    )
    top.add_argument("--json", metavar="OUT", type=Path, help="file for the same in SI units")
    top.add_argument(
        "--overlay",
        metavar="OUT.png",
        type=Path,
        help="draw what was found or why not; numbered with several pictures",
    )
    arguments = top.parse_args(argv)
    if arguments.sensor is None and arguments.config is not None:
        top.error("--config was given without --sensor; name the sensor that it is of")
    if arguments.sensor is not None and (arguments.camera is not None or arguments.overlay is not None):
        top.error("--camera and --overlay are for the cell's own localizer; leave them or --sensor out")
    if arguments.overlay is not None and not arguments.overlay.name:
        top.error(f"--overlay {arguments.overlay} is a folder, allowed is the name of a picture; give one")
    overlays = [] if arguments.overlay is None else _overlays(arguments.overlay, len(arguments.files))
    door_file = [Path(arguments.door)] if arguments.door is not None and Path(arguments.door).suffix else []
    wrong = written_over(
        [path for path in (arguments.json, *overlays) if path is not None],
        [
            path
            for path in (*arguments.files, arguments.camera, arguments.config, *door_file)
            if path is not None
        ],
    )
    if wrong:
        top.error(wrong)
    return arguments


def _overlays(out: Path, count: int) -> list[Path]:
    """Where the drawings of `count` pictures go."""
    return [out] if count == 1 else [out.with_stem(f"{out.stem}-{i + 1}") for i in range(count)]


def _length(text: str) -> float:
    try:
        length = mm_to_m(float(text))
    except ValueError:
        length = math.nan
    if not 0.0 < length < math.inf:
        raise argparse.ArgumentTypeError(f"{text!r} given, allowed is a length [mm] above 0")
    return length


@interruptible
def main(argv: list[str] | None = None) -> int:
    """Run the tool.

    Returns:
        0, refusals included; 2 with one line on stderr when something given cannot be used.
    """
    try:
        arguments = parse(argv)
    except SystemExit as stop:  # --help, or a wrong command line
        return int(stop.code or 0)
    try:
        door = _door(arguments)
        located = _locate(arguments, door)
        compared = _compare(located)
        if arguments.json is not None:
            text = json.dumps(_document(arguments.sensor, door, located, compared), indent=2, allow_nan=False)
            write_atomically(arguments.json, text + "\n")
        _draw(arguments.overlay, located)
    except (DoormillError, OSError) as error:
        print(f"locate: {' '.join(str(error).split())}", file=sys.stderr)
        return 2
    size = " x ".join(f"{m_to_mm(v):g}" for v in (door.width, door.height, door.thickness))
    print(f"door of {size} mm, offset of T_base_door from its nominal place in {BASE_FRAME}")
    print("\n".join(line for entry in located for line in _lines(*entry)))
    if compared is not None:
        print("\n".join(_repeatability_lines(*compared)))
    return 0


def _door(arguments: argparse.Namespace) -> DoorSize:
    if arguments.size is not None:
        width, height, thickness = arguments.size
        return DoorSize(height=height, width=width, thickness=thickness)
    if Path(arguments.door).suffix:
        return load_recipe(arguments.door).size
    from doormill_ros.recipes.store.database import RecipeDatabase  # takes a while, and only this asks for it

    with RecipeDatabase() as database:
        database.add_shipped()
        return database.get(arguments.door).size


def _locate(arguments: argparse.Namespace, door: DoorSize) -> Located:
    layout = load_layout()
    locate: Callable[[Reading], LocatedDoor]
    if arguments.sensor is None:
        camera_file = arguments.camera or resource("config/camera.yaml")
        camera, settings = load_camera(camera_file), load_settings(camera_file)
        readings = [Reading(path.name, read_picture(path)) for path in arguments.files]

        def locate(reading: Reading) -> LocatedDoor:
            return locate_in_picture(np.asarray(reading.value), camera, layout, door, settings)
    else:
        sensor = SENSORS[arguments.sensor](arguments.config, layout)
        readings = [reading for path in arguments.files for reading in read_readings(path, sensor.takes)]

        def locate(reading: Reading) -> LocatedDoor:
            return locate_with_sensor(sensor, reading, layout, door)

    located: Located = []
    for reading in readings:
        try:
            located.append((reading, locate(reading)))
        except LocalizationError as refusal:
            located.append((reading, refusal))
    return located


def _compare(located: Located) -> tuple[tuple[str, ...], Repeatability] | None:
    """Spread of all that were found; None of a single one."""
    doors = [door for _, door in located if isinstance(door, LocatedDoor)]
    return compare_located(doors) if len(doors) > 1 else None


def _lines(reading: Reading, door: LocatedDoor | LocalizationError) -> list[str]:
    if isinstance(door, LocalizationError):
        return [f"{reading.name}: refused, {door.code} {type(door).__name__}: {door.message}"]
    told = []
    for name, value, deviation in zip(door.freedoms, door.offset, door.deviations, strict=True):
        (shown, off), unit = _shown(name, np.array([value, deviation]))
        blind = ", not measured: as the clamp holds it" if name in door.blind else ""
        told.append(f"{name:<10} {shown:+9.4f} +- {off:.4f} {unit}{blind}")
    more = [
        f"residual {m_to_mm(value):.4f} mm" if name == "residual" else f"{name.replace('_', ' ')} {value:.4g}"
        for name, value in door.facts.items()
        if name != "seconds"  # for programs: not the same twice
    ]
    return [f"{reading.name}:", *(f"  {line}" for line in told), f"  {', '.join(more)}"]


def _repeatability_lines(names: tuple[str, ...], found: Repeatability) -> list[str]:
    told = []
    for name, spread, stated in zip(names, found.spread, found.stated, strict=True):
        (shown, expected), unit = _shown(name, np.array([spread, stated]))
        told.append(f"{name} {shown:.4f} {unit} (stated {expected:.4f})")
    verdict = "no more" if found.allowed else "MORE"
    return [
        f"repeatability of {found.count}: {', '.join(told)}",
        f"the spread is {verdict} than the stated covariance allows: chi-square {found.chi_square:.1f} with "
        f"{found.freedom} degrees of freedom, probability {found.probability:.2g}",
    ]


def _shown(name: str, values: FloatArray) -> tuple[FloatArray, str]:
    """Values [m, rad] of a degree of freedom in the unit that people read."""
    return (rad_to_deg(values), "deg") if name.startswith("rotation") else (m_to_mm(values), "mm")


def _document(
    sensor: str | None,
    door: DoorSize,
    located: Located,
    compared: tuple[tuple[str, ...], Repeatability] | None,
) -> dict[str, Any]:
    """The same for programs, in m and rad."""
    document: dict[str, Any] = {
        "schema": SCHEMA,
        "frame": BASE_FRAME,
        "door": {"height": door.height, "width": door.width, "thickness": door.thickness},
        "sensor": sensor or "localizer",
        "readings": [_entry(*entry) for entry in located],
    }
    if compared is not None:
        names, found = compared
        document["repeatability"] = {
            "count": found.count,
            "spread": _named(names, found.spread),
            "stated": _named(names, found.stated),
            "chi_square": found.chi_square,
            "degrees_of_freedom": found.freedom,
            "probability": found.probability,
            "allowed": found.allowed,
        }
    return document


def _entry(reading: Reading, door: LocatedDoor | LocalizationError) -> dict[str, Any]:
    if isinstance(door, LocalizationError):
        return {
            "reading": reading.name,
            "accepted": False,
            "error_code": door.code,
            "error": type(door).__name__,
            "reason": door.message,
        }
    return {
        "reading": reading.name,
        "accepted": True,
        "T_base_door": door.T_base_door.tolist(),
        "offset": _named(door.freedoms, door.offset),
        "deviation": _named(door.freedoms, door.deviations),
        "covariance": door.covariance.tolist(),
        "blind": [name.replace(" ", "_") for name in door.blind],
        **door.facts,
    }


def _named(names: tuple[str, ...], values: FloatArray) -> dict[str, float]:
    return {name.replace(" ", "_"): float(value) for name, value in zip(names, values, strict=True)}


def _draw(out: Path | None, located: Located) -> None:
    if out is None:
        return
    for path, (reading, door) in zip(_overlays(out, len(located)), located, strict=True):
        picture = np.asarray(reading.value)
        if isinstance(door, LocalizationError):
            drawn = draw_refusal(picture, door)
        elif door.localization is not None:
            drawn = draw_overlay(picture, door.localization)
        else:
            continue
        write_picture(drawn, path)


if __name__ == "__main__":
    sys.exit(main())
