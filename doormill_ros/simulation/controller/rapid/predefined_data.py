"""Predefined data of RAPID: speeds, zones, the base tool and work object, error numbers."""

from __future__ import annotations

from doormill_ros.simulation.controller.rapid.context import Context
from doormill_ros.simulation.controller.rapid.faults import ERROR_NUMBERS
from doormill_ros.simulation.controller.rapid.scope import GlobalSymbol, Names
from doormill_ros.simulation.controller.rapid.types import (
    LOADDATA,
    NUM,
    SIGNALAI,
    SIGNALAO,
    SIGNALDI,
    SIGNALDO,
    SIGNALGI,
    SIGNALGO,
    SPEEDDATA,
    STRING,
    TOOLDATA,
    WOBJDATA,
    ZONEDATA,
    AnyType,
    Value,
    float32,
)

#: What ReadStr gives when nothing is left to read.
END_OF_FILE = "EOF"
#: v_tcp of the predefined speeds [mm/s]; orientation and external axes are the same for all.
SPEEDS = (
    *(5, 10, 20, 30, 40, 50, 60, 80, 100, 150, 200, 300, 400, 500, 600, 800),
    *(1000, 1500, 2000, 2500, 3000, 4000, 5000, 6000, 7000),
)
_SPEED_REST = [500.0, 5000.0, 1000.0]
#: pzone_tcp, pzone_ori, pzone_eax, zone_ori, zone_leax, zone_reax of the predefined zones [mm, deg].
ZONES = {
    "z0": (0.3, 0.3, 0.3, 0.03, 0.3, 0.03),
    "z1": (1, 1, 1, 0.1, 1, 0.1),
    "z5": (5, 8, 8, 0.8, 8, 0.8),
    "z10": (10, 15, 15, 1.5, 15, 1.5),
    "z15": (15, 23, 23, 2.3, 23, 2.3),
    "z20": (20, 30, 30, 3, 30, 3),
    "z30": (30, 45, 45, 4.5, 45, 4.5),
    "z40": (40, 60, 60, 6, 60, 6),
    "z50": (50, 75, 75, 7.5, 75, 7.5),
    "z60": (60, 90, 90, 9, 90, 9),
    "z80": (80, 120, 120, 12, 120, 12),
    "z100": (100, 150, 150, 15, 150, 15),
    "z150": (150, 225, 225, 23, 225, 23),
    "z200": (200, 300, 300, 30, 300, 30),
}
#: What triggers an interrupt of a signal.
SIGNAL_LEVELS = {"low": 0.0, "high": 1.0, "edge": 2.0}
#: Numbers that programs know by name [?].
NUMBERS = {
    **SIGNAL_LEVELS,
    **dict(zip(("btnNone", "btnOK", "btnAbrtRtryIgn", "btnOKCancel"), (-1.0, 0.0, 1.0, 2.0), strict=True)),
    **dict(zip(("btnRetryCancel", "btnYesNo", "btnYesNoCancel"), (3.0, 4.0, 5.0), strict=True)),
    **dict(zip(("resUnkwn", "resOK", "resAbort", "resRetry"), (0.0, 1.0, 2.0, 3.0), strict=True)),
    **dict(zip(("resIgnore", "resCancel", "resYes", "resNo"), (4.0, 5.0, 6.0, 7.0), strict=True)),
    **dict(zip(("iconNone", "iconInfo", "iconWarning", "iconError"), (0.0, 1.0, 2.0, 3.0), strict=True)),
    **dict(zip(("OP_UNDEF", "OP_AUTO", "OP_MAN_PROG", "OP_MAN_TEST"), (0.0, 1.0, 2.0, 3.0), strict=True)),
    **dict(zip(("RUN_UNDEF", "RUN_CONT_CYCLE", "RUN_INSTR_FWD"), (0.0, 1.0, 2.0), strict=True)),
}
_UNIT = [1.0, 0.0, 0.0, 0.0]
_FRAME = [[0.0, 0.0, 0.0], _UNIT]
_LOAD0 = [0.001, [0.0, 0.0, 0.001], _UNIT, 0.0, 0.0, 0.0]
_SIGNAL_TYPES = {kind.name: kind for kind in (SIGNALDI, SIGNALDO, SIGNALAI, SIGNALAO, SIGNALGI, SIGNALGO)}


def install_data(context: Context, names: Names) -> None:
    """Declare the predefined data and the configured signals."""

    def add(name: str, kind: AnyType, storage: str, value: Value) -> None:
        names.add(name, GlobalSymbol(name, kind, storage, [_rounded(value)]))

    for speed in SPEEDS:
        add(f"v{speed}", SPEEDDATA, "CONST", [float(speed), *_SPEED_REST])
    add("vmax", SPEEDDATA, "CONST", [float(SPEEDS[-1]), *_SPEED_REST])
    for name, values in ZONES.items():
        add(name, ZONEDATA, "CONST", [False, *(float(v) for v in values)])
    add("fine", ZONEDATA, "CONST", [True, *[0.0] * 6])
    add("load0", LOADDATA, "PERS", _LOAD0)
    add("tool0", TOOLDATA, "PERS", [True, _FRAME, _LOAD0])
    add("wobj0", WOBJDATA, "PERS", [False, True, "", _FRAME, _FRAME])
    add("EOF", STRING, "CONST", END_OF_FILE)
    add("stEmpty", STRING, "CONST", "")
    add("pi", NUM, "CONST", 3.141592653589793)
    add("STR_DIGIT", STRING, "CONST", "0123456789")
    names.add("ERRNO", GlobalSymbol("ERRNO", NUM, "CONST", context.errno))
    names.add("INTNO", GlobalSymbol("INTNO", NUM, "CONST", context.interrupts.intno))
    for name, value in NUMBERS.items():
        add(name, NUM, "CONST", value)
    for name, number in ERROR_NUMBERS.items():
        add(name, NUM, "CONST", float(number))
    for name, kind in context.machine.signal_kinds().items():
        names.add(name, GlobalSymbol(name, _SIGNAL_TYPES[kind], "SIGNAL", [name]))


def _rounded(value: Value) -> Value:
    """A fresh copy with every number as float32 holds it."""
    if isinstance(value, list):
        return [_rounded(item) for item in value]
    return float32(value) if isinstance(value, float) else value
