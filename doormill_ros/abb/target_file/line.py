"""One robot target as a line of text, `x;y;z;q1;q2;q3;q4;cf1;cf4;cf6;cfx;`, and back.

Millimetres and a unit quaternion, w first, live in this file only; outside it is SI. A RAPID
string holds 80 characters. `ReadStr` is documented to stop at 80 characters or at the line
feed, whichever comes first; where both come together the line feed may be left for the next
call, which would shift every later target by one. The writer therefore stays one below.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from doormill_ros.abb.errors import AbbError, TargetLineError, TargetValueError
from doormill_ros.arrays import FloatArray, IntArray
from doormill_ros.frames import are_transforms, check_transform, from_wxyz, quaternion_wxyz
from doormill_ros.robot.configuration import ConfData
from doormill_ros.units import m_to_mm, mm_to_m

RAPID_STRING = 80  #: characters that a RAPID string holds
LINE_BUDGET = RAPID_STRING - 1  #: characters that the writer uses at most
SEPARATOR = ";"
FIELDS = ("x", "y", "z", "q1", "q2", "q3", "q4", "cf1", "cf4", "cf6", "cfx")

#: Decimals of millimetres and of the quaternion, most useful first. A micrometre of position
#: weighs more than a microradian about the tool centre point, so the quaternion gives way first.
#: Below (3, 6) nothing is needed: that fits every target within REACH.
DECIMALS = ((4, 7), (4, 6), (3, 6))
FLOAT32_DIGITS = 24  #: binary digits of a RAPID num
REACH = 10.0  #: coordinates from here on are out of reach of any robot of this kind [m]
#: Largest |q.q - 1| that RAPID takes as a unit quaternion without a word.
NORM_TOLERANCE = 1e-5
#: Turns of the axes that the robots of this class reach, in quarters.
CONF_RANGE = {"cf1": (-4, 3), "cf4": (-4, 3), "cf6": (-4, 3), "cfx": (0, 7)}

_DECIMAL_TEXT = r"-?[0-9]{1,4}(?:\.[0-9]{1,8})?"
_DECIMAL, _INTEGER = re.compile(_DECIMAL_TEXT), re.compile(r"-?[0-9]")
#: The numbers of a line, each with its decimals in front.
_NUMBERS = f"%.*f{SEPARATOR}" * 7
#: The minus sign that they put before what is rounded to zero.
_BELOW_ZERO = re.compile(rf"-0(?=(?:\.0+)?{SEPARATOR})")
#: A q1 from here on is not rounded to zero, by whichever decimals.
SMALLEST_FIRST = 10.0 ** -DECIMALS[-1][1]


def _texts(low: int, high: int) -> str:
    """Every text of an integer from low to high."""
    texts = (f"{sign}{digit}" for sign in ("", "-") for digit in range(10))
    return "|".join(text for text in texts if low <= int(text) <= high)


#: A whole line.
_LINE = re.compile(
    f"({_DECIMAL_TEXT}){SEPARATOR}" * 7
    + "".join(f"({_texts(*limits)}){SEPARATOR}" for limits in CONF_RANGE.values())
)


@dataclass(frozen=True, eq=False)
class TargetLine:
    """What one line says.

    Attributes:
        T_base_tool: Pose of the tool, shape (4, 4).
        conf: Robot configuration.
        position_mm: x, y, z as written, shape (3,) [mm].
        quaternion: q1..q4 as written, w first, shape (4,).
        position_resolution: Half of the last decimal of x, y, z, shape (3,) [m].
        quaternion_resolution: Half of the last decimal of q1..q4.
    """

    T_base_tool: FloatArray
    conf: ConfData
    position_mm: FloatArray
    quaternion: FloatArray
    position_resolution: FloatArray
    quaternion_resolution: float


def format_lines(
    T_base_tool: Sequence[FloatArray], confs: Sequence[ConfData], names: Sequence[str]
) -> list[str]:
    """The lines of many targets, without their line feeds.

    Args:
        T_base_tool: Poses of the tool as the robot shall be told them, each of shape (4, 4).
        confs: Robot configuration of each pose.
        names: What each target is called, for messages.

    Raises:
        TargetValueError: Not a pose, out of any robot's reach, or a configuration that no robot of
            this class has.
    """
    labels = [f"target {name!r}" if name else "target" for name in names]
    poses = _checked(T_base_tool, labels)
    if not len(poses):
        return []
    numbers = np.hstack([m_to_mm(poses[:, :3, 3]), quaternion_wxyz(poses)])
    decimals = np.stack([_decimals_of(numbers[:, :3], first) for first, _ in DECIMALS], axis=1)
    rows = zip(numbers.tolist(), decimals.tolist(), confs, labels, strict=True)
    return [
        _format_target(values, choices, _format_conf(conf, label), label)
        for values, choices, conf, label in rows
    ]


def _checked(T_base_tool: Sequence[FloatArray], labels: Sequence[str]) -> FloatArray:
    """The poses, once they are poses and within reach; shape (n, 4, 4)."""
    for index, label in enumerate(labels):
        try:
            # All at once where all are good, as almost always; one by one to name the one that is not.
            if index == 0 and are_transforms(T_base_tool):
                break
            check_transform(T_base_tool[index], label)
        except ValueError as error:
            raise TargetValueError(
                f"{error}: build the pose with doormill_ros.frames", target=label
            ) from error
    poses = np.array(T_base_tool, dtype=float)
    if not len(poses):
        return poses
    far = np.flatnonzero(np.abs(poses[:, :3, 3]).max(axis=1) >= REACH)
    if far.size:
        index = int(far[0])
        position = poses[index, :3, 3].tolist()
        raise TargetValueError(
            f"{labels[index]} is at {[round(p, 3) for p in position]} m, allowed is less than {REACH:g} m "
            "along each axis: check the units",
            target=labels[index],
            position=position,
        )
    return poses


def _decimals_of(millimetres: FloatArray, most: int) -> IntArray:
    """Decimals, so many at most, that float32 can tell apart at a coordinate's size; the shape of the coordinates."""
    spacing = np.ldexp(1.0, np.frexp(millimetres)[1] - FLOAT32_DIGITS)
    decimals = np.full(millimetres.shape, most)
    while (over := (decimals > 0) & (10.0**-decimals < spacing)).any():
        decimals[over] -= 1
    return decimals


def _format_target(numbers: list[float], choices: list[list[int]], conf: str, label: str) -> str:
    """One line, with the first choice of decimals that fits.

    Args:
        numbers: x, y, z [mm] and q1..q4.
        choices: For each of `DECIMALS` those of x, y, z.
        conf: Texts of cf1, cf4, cf6, cfx.
        label: What the target is called.
    """
    x, y, z, *quaternion = numbers
    for (a, b, c), (_, d) in zip(choices, DECIMALS, strict=True):
        q1, q2, q3, q4 = quaternion if quaternion[0] >= SMALLEST_FIRST else _of_positive_first(quaternion, d)
        line = _NUMBERS % (a, x, b, y, c, z, d, q1, d, q2, d, q3, d, q4) + conf
        if "-0" in line:
            line = _BELOW_ZERO.sub("0", line)
        if len(line) <= LINE_BUDGET:
            return line
    if len(line) <= RAPID_STRING:
        return line
    raise TargetValueError(
        f"{label} needs {len(line)} characters, allowed are {RAPID_STRING}: {line}", target=label, line=line
    )


def parse_lines(lines: Sequence[str], first: int = 1) -> tuple[TargetLine, ...]:
    """Read target lines back.

    Args:
        lines: The lines without their line feeds.
        first: Number in the file of the first one, from 1, for messages.

    Raises:
        TargetLineError: Names line, field, what was found and what is allowed.
    """
    if not lines:
        return ()
    texts = [_fields(line, number) for number, line in enumerate(lines, start=first)]
    values = np.array([list(map(float, row)) for row in texts])
    _check_quaternions(values[:, 3:7], lines, first)
    decimals = np.array([[len(text.partition(".")[2]) for text in row[:7]] for row in texts])
    position_mm, quaternion = values[:, :3], values[:, 3:7]
    poses = from_wxyz(mm_to_m(position_mm), quaternion)
    half = 0.5 * 10.0 ** -decimals.astype(float)
    position_resolution = mm_to_m(half[:, :3])
    columns = zip(
        poses,
        values[:, 7:].astype(int).tolist(),
        position_mm,
        quaternion,
        position_resolution,
        half[:, 3:].max(axis=1).tolist(),
        strict=True,
    )
    return tuple(TargetLine(pose, ConfData(*conf), *rest) for pose, conf, *rest in columns)


def _fields(line: str, number: int) -> Sequence[str]:
    """The texts of the eleven fields, each of them a number that may stand there."""
    match = _LINE.fullmatch(line) if len(line) <= RAPID_STRING else None
    return match.groups() if match else _fields_one_by_one(line, number)


def _fields_one_by_one(line: str, number: int) -> Sequence[str]:
    """The same in ten times the time, which finds out what is wrong."""
    if len(line) > RAPID_STRING:
        raise _error(number, f"has {len(line)} characters", f"at most {RAPID_STRING}, a RAPID string", line)
    parts = line.split(SEPARATOR)
    if len(parts) != len(FIELDS) + 1 or parts[-1]:
        raise _error(
            number,
            f"has {line.count(SEPARATOR)} separators in {line!r}",
            f"{len(FIELDS)} numbers with a '{SEPARATOR}' after each",
            line,
        )
    parts.pop()
    for field, text in zip(FIELDS[:7], parts[:7], strict=True):
        if not _DECIMAL.fullmatch(text):
            raise _error(number, f"has {field} = {text!r}", "a decimal number such as -1234.567", text)
    for (field, (low, high)), text in zip(CONF_RANGE.items(), parts[7:], strict=True):
        if not _INTEGER.fullmatch(text):
            raise _error(number, f"has {field} = {text!r}", "an integer", text)
        if not low <= int(text) <= high:
            raise _error(number, f"has {field} = {text}", f"{low} to {high}", line)
    return parts


def _check_quaternions(quaternions: FloatArray, lines: Sequence[str], first: int) -> None:
    """Raise for the first one that is not unit; shape (n, 4)."""
    squares = np.sum(quaternions**2, axis=1)
    wrong = np.flatnonzero(np.abs(squares - 1.0) > NORM_TOLERANCE)
    if wrong.size:
        index = int(wrong[0])
        raise _error(
            first + index,
            f"has a quaternion whose squares sum to {squares[index]:.7f}",
            f"1 within {NORM_TOLERANCE:g}",
            lines[index],
        )


def _of_positive_first(quaternion: list[float], decimals: int) -> list[float]:
    """The rounded quaternion whose first component that is not zero is positive."""
    rounded = [round(value, decimals) for value in quaternion]
    if next(value for value in rounded if value != 0.0) < 0.0:
        rounded = [-value for value in rounded]
    return rounded


def _format_conf(conf: ConfData, label: str) -> str:
    """cf1, cf4, cf6, cfx with the separators behind them."""
    values = (conf.cf1, conf.cf4, conf.cf6, conf.cfx)
    for (field, (low, high)), value in zip(CONF_RANGE.items(), values, strict=True):
        if not isinstance(value, int | np.integer) or not low <= value <= high:
            raise TargetValueError(
                f"{label} has {field} = {value!r}, allowed is an integer from {low} to {high}: "
                "choose another branch of the inverse kinematics",
                field=field,
                value=value,
            )
    return f"{conf.cf1:d};{conf.cf4:d};{conf.cf6:d};{conf.cfx:d};"


def _error(number: int, found: str, allowed: str, line: str) -> AbbError:
    return TargetLineError(
        f"line {number} of the target file {found}, allowed is {allowed}: write the file anew",
        line=number,
        text=line,
    )
