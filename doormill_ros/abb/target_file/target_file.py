"""The RAPID target file: one target a line, then the trailer that the thesis' program never reads.

Layout of a target line: `doormill_ros.abb.target_file.line`; of the trailer:
`doormill_ros.abb.target_file.trailer`. The thesis' program (figure 3.36) reads lines 1 to 14 and runs
on the file of a two-hinge door unchanged.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

from doormill_ros.abb.errors import (
    StaleRunError,
    TargetFileChecksumError,
    TargetFileCutShortError,
    TargetFileWriteError,
    TargetLineError,
    TargetProgramError,
    WrongDoorError,
)
from doormill_ros.abb.target_file.checksum import checksum
from doormill_ros.abb.target_file.line import TargetLine, format_lines, parse_lines
from doormill_ros.abb.target_file.trailer import (
    MARK,
    TOOL,
    Trailer,
    TrailerReader,
    format_trailer,
)
from doormill_ros.arrays import FloatArray
from doormill_ros.cell.rapid_limits import MAX_FEATURES, MAX_MOTIONS, MAX_POINTS, MAX_TARGETS
from doormill_ros.files import ReadBackError, write_atomically
from doormill_ros.toolpath.program import MillingProgram, Motion

#: More than the largest file that the counts allow; what is larger is not read line by line.
MAX_FILE_SIZE = 1_000_000
_STRANGE = re.compile(rb"[^\n\x20-\x7e]")
MAX_LINES = MAX_TARGETS + MAX_MOTIONS + 2 * MAX_FEATURES + MAX_POINTS + 100


@dataclass(frozen=True, eq=False)
class TargetFile:
    """A target file read back.

    Attributes:
        targets: The targets in the order of the file.
        door_id: Door the file was made for; empty in a file without trailer.
        run_id: The run's own name, used once; empty in a file without trailer.
        recipe_version: Version of the recipe; 0 in a file without trailer.
        motions: The motions in the order of execution, wrench zero; empty without trailer.
        points: Joint angles that MoveAbsJ passes, each of shape (6,) [rad].
        home: Where the program begins and ends, shape (6,) [rad]; None without trailer.
        escapes: Points of the way home from each feature.
        tool: T_flange_tool, shape (4, 4); None in a file that does not say it.
    """

    targets: tuple[TargetLine, ...]
    door_id: str
    run_id: str
    recipe_version: int
    motions: tuple[Motion, ...]
    points: tuple[FloatArray, ...] = ()
    home: FloatArray | None = None
    escapes: tuple[range, ...] = ()
    tool: FloatArray | None = None

    def check_for(self, door_id: str, seen_runs: tuple[str, ...] = ()) -> None:
        """Refuse a file for another door or of a run that was executed before.

        Raises:
            WrongDoorError: The file names another door.
            StaleRunError: The run id is among `seen_runs`.
        """
        if self.door_id != door_id:
            raise WrongDoorError(
                f"the target file is for door {self.door_id!r}, the door in the cell is {door_id!r}: "
                "generate the path for the door in the cell",
                found=self.door_id,
                allowed=door_id,
            )
        if self.run_id in seen_runs:
            raise StaleRunError(
                f"run {self.run_id!r} of the target file was executed before, allowed is a new run: "
                "generate the path again",
                run_id=self.run_id,
            )


def render_target_file(program: MillingProgram, run_id: str) -> bytes:
    """The bytes of the target file of a program.

    Args:
        program: Targets (the corrected poses are written) and motions.
        run_id: Name of the run, never used before; at most 75 characters of plain ASCII.

    Raises:
        TargetValueError: A target, name or count that the file cannot hold.
        TargetProgramError: A motion that does not fit the targets, or a way home that is missing.
    """
    targets = program.targets
    lines = format_lines(
        [t.T_base_tool_corrected for t in targets], [t.conf for t in targets], [t.name for t in targets]
    )
    if program.home is None:
        raise TargetProgramError(
            "the milling program has no home, allowed are joint angles that agree with the controller's: "
            "generate the path again"
        )
    trailer = Trailer(
        program.door_id,
        run_id,
        program.recipe_version,
        len(lines),
        program.home,
        program.points,
        program.escapes,
        program.motions,
        program.tool,
    )
    return _signed(lines + format_trailer(trailer))


def says_tool(data: bytes) -> bool:
    """Whether a file says its tool."""
    return f"\n{MARK}{TOOL} ".encode("ascii") in data


def without_tool(data: bytes) -> bytes:
    """A file as it was written before files said their tool."""
    lines = data.decode("ascii").splitlines()[:-1]
    return _signed([line for line in lines if not line.startswith(f"{MARK}{TOOL} ")])


def write_target_file(path: Path, data: bytes, make_folder: bool = False) -> None:
    """Replace a target file in one step; what was written is read back and survives a power cut.

    On a failure `path` keeps what it held.

    Args:
        path: File to replace or create.
        data: Bytes of the whole file.
        make_folder: Make its folder where it is missing.

    Raises:
        TargetFileWriteError: The content could not be written, reads back differently, or the
            rename failed.
    """
    try:
        if make_folder:
            path.parent.mkdir(parents=True, exist_ok=True)
        write_atomically(path, data, durable=True, verify=True)
    except ReadBackError as error:
        raise TargetFileWriteError(
            str(error), path=str(error.path), size=error.size, found=error.found
        ) from error
    except OSError as error:
        raise TargetFileWriteError(
            f"{path} could not be written ({error.strerror or error}); allowed is a writable folder with "
            f"{len(data)} free bytes: check the folder, its rights and the disk",
            path=str(path),
            size=len(data),
        ) from error


def read_target_file(data: bytes, *, trailer: bool = True) -> TargetFile:
    """Read and check a target file.

    Args:
        data: The bytes of the file.
        trailer: False for a file of target lines alone, as the thesis' generator wrote it.

    Raises:
        TargetFileCutShortError: The file is empty or ends early.
        TargetLineError: Names the line that is wrong, what was found and what is allowed.
        TargetFileChecksumError: Every line reads well, yet the file is not the one that was written.
    """
    lines = _split(data)
    count = next((i for i, line in enumerate(lines) if line.startswith(MARK)), len(lines))
    targets = parse_lines(lines[:count])
    if not trailer:
        if count != len(lines):
            raise TargetLineError(
                f"line {count + 1} of the target file begins with '{MARK}', allowed are targets only: "
                "read the file with its trailer",
                line=count + 1,
            )
        return TargetFile(targets, "", "", 0, ())
    reader = TrailerReader(lines[count:], first=count + 1)
    found, written = reader.read()
    if not reader.at_end:
        raise TargetLineError(
            f"line {reader.number + 1} of the target file follows the checksum, allowed is the end of the "
            "file: write the file anew",
            line=reader.number + 1,
        )
    computed = checksum(lines[:-1])
    if tuple(computed) != written:
        raise TargetFileChecksumError(
            f"the target file says checksum {list(written)}, its content gives {list(computed)}, "
            "allowed is the same: write the file anew",
            found=written,
            computed=tuple(computed),
        )
    if found.target_count != count:
        raise TargetLineError(
            f"the target file says {found.target_count} targets and holds {count}, allowed is the same "
            "number: write the file anew",
            line=count,
        )
    return TargetFile(
        targets,
        found.door_id,
        found.run_id,
        found.recipe_version,
        found.motions,
        found.points,
        found.home,
        found.escapes,
        found.tool,
    )


def check_handover(data: bytes, run_id: str, door_id: str) -> None:
    """Refuse what the robot program would refuse: the handshake's look into a file before it is announced.

    Args:
        data: The target file as read back from the controller.
        run_id: The run that was submitted.
        door_id: The door it was submitted for.

    Raises:
        AbbError: The file is cut short, changed, of another run or for another door.
    """
    target_file = read_target_file(data)
    target_file.check_for(door_id)
    if target_file.run_id != run_id:
        raise StaleRunError(
            f"the target file is of run {target_file.run_id!r}, submitted was run {run_id!r}: "
            "generate the path again",
            found=target_file.run_id,
            allowed=run_id,
        )


def _signed(lines: list[str]) -> bytes:
    """The file of these lines and their checksum."""
    a, b = checksum(lines)
    return _join([*lines, f"{MARK}sum [{a},{b}]"])


def _join(lines: list[str]) -> bytes:
    return "".join(line + "\n" for line in lines).encode("ascii")


def _split(data: bytes) -> list[str]:
    """The lines of a file, once it is text with a line feed after each line."""
    if not data:
        raise TargetFileCutShortError(
            "the target file is empty, allowed is at least one target: write it anew"
        )
    if len(data) > MAX_FILE_SIZE:
        raise TargetLineError(
            f"the target file has {len(data)} bytes, allowed are {MAX_FILE_SIZE}: this is another file",
            line=0,
        )
    strange = _STRANGE.search(data)
    if strange:
        number = data.count(b"\n", 0, strange.start()) + 1
        raise TargetLineError(
            f"line {number} of the target file holds byte 0x{strange[0][0]:02X}, allowed are printable ASCII "
            "and line feeds: write the file anew",
            line=number,
        )
    if not data.endswith(b"\n"):
        number = data.count(b"\n") + 1
        raise TargetFileCutShortError(
            f"line {number} of the target file has no line feed, allowed is one after each line: "
            "write the file anew",
            line=number,
        )
    lines = data[:-1].decode("ascii").split("\n")
    if len(lines) > MAX_LINES:
        raise TargetLineError(
            f"the target file has {len(lines)} lines, allowed are {MAX_LINES}; write the file anew", line=0
        )
    return lines
